"""The study, from simulated trials to its tables and figures; each include is one stage, in the order of the data."""

from snakemake.utils import min_version

min_version("9.0")

# A config given on the command line replaces the study's, rather than being merged into it.
if not config:

    configfile: "config/config.yaml"


# On a node of a cluster, Snakemake is started in the output folder.
if workflow.is_main_process:

    workdir: "results"


report: "workflow/report/study.rst"


include: "workflow/rules/common.smk"
include: "workflow/rules/functions.smk"
include: "workflow/rules/presentation_functions.smk"
include: "workflow/rules/data_collection.smk"
include: "workflow/rules/features.smk"
include: "workflow/rules/model.smk"
include: "workflow/rules/evaluation.smk"
include: "workflow/rules/tasks.smk"
include: "workflow/rules/presentation.smk"


rule all:
    default_target: True
    input:
        "report.html",
        "scores.csv",
        "claims.csv",
        expand("tables/{file}", file=files_of_tables(TABLES)),
        list(figure_files()),
        list(rating_keys()),
        "diagnostics.html",
        expand("diagnostics/{chains}.html", chains=diagnosed()),
