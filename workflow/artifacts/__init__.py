"""Artifacts: what they are, what made them, and where they are kept; nothing about running jobs."""
