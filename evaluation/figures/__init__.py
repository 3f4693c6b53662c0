"""Every figure of a study. No other stage, and nothing else in this one, imports matplotlib."""
