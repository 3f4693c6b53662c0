"""HTML pages: the report, the claims, the form for people who rate clips."""
