"""What ties the stages together: the config, the plan of a study, and its Snakemake rules."""
