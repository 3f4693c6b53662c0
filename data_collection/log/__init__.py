"""Logs: the table of topics, MCAP files, their checks, and what a trial holds."""
