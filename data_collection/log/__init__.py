"""Logs: the table of channels, MCAP files, their checks, and what a trial holds."""
