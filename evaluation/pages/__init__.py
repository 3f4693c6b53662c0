"""HTML pages: the report, the claims, the lights and the chains."""
