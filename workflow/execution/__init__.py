"""Running a study: what is kept, what is made, and jobs on this machine or a cluster."""
