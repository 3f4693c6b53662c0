"""Artifacts: what they are, what made them, and where they are kept. Knows nothing of how jobs are run."""
