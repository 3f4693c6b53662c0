"""Running a plan: one run in a folder, jobs on the cores or a cluster, what is kept and what is made."""
