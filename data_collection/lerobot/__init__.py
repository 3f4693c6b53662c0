"""Export of logs to a LeRobot v3.0 dataset, written with pyarrow alone."""
