"""From logs to feature tables: what the robot sees, feels and hears, as numbers the model can learn from."""
