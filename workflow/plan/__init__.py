"""The plan of a study: its config, read, checked and completed. Knows nothing of what has been made."""
