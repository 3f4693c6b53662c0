"""What the fits are worth: measures, tables and figures."""
