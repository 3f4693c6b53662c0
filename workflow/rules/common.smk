"""The checked plan of the study, and what every rule needs of it. `experiment` in a path is a data set of one."""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(workflow.basedir))

from snakemake.exceptions import WorkflowError

from workflow.plan.config import ConfigError, copied_from
from workflow.artifacts.provenance import lock_hash, rule_code
from data_collection.processor import pin
from data_collection.log.numbering import file_of_trial
from features.table_parts import parts_of
from workflow.plan.loading import plan
from evaluation.data_sets import FIT_PATH
from workflow.plan.conditions import CHAIN_PATH
from workflow.plan.experiment import TASKS
from workflow.plan.study import feature_files
from workflow.plan.config_types import WORDLESS

SETS = ("train", "generation", "description")

# Jobs are processes that start from here, be it as forks of one or by themselves.
pin()

CONFIG_FILE = copied_from(Path((workflow.overwrite_configfiles or workflow.configfiles)[0]))

try:
    study = plan(config, CONFIG_FILE)
except ConfigError as error:
    raise WorkflowError(str(error))


def settings(wildcards):
    """The settings of the experiment that a path names."""
    return study.experiments[wildcards.experiment].settings


def sources(*kinds):
    """A pattern of the experiments whose data come from one of these sources, for wildcard constraints."""
    names = [re.escape(name) for name, experiment in study.experiments.items() if experiment.source in kinds]
    return "|".join(names) or "(?!)"


def tracked(script, *modules):
    """The hash of a script with all project code that it imports and of the lock file: a change reruns the rule.

    A script that imports by a name that its rule gives has these modules in the parameter `modules` as well.
    """
    return rule_code(Path(workflow.basedir) / "workflow" / "scripts" / script, *modules)


wildcard_constraints:
    experiment="|".join(map(re.escape, study.experiments)),
    variant=r"[A-Za-z][A-Za-z0-9_-]*",
    method="|".join(sorted({*WORDLESS}.union(*(own.settings.methods for own in study.experiments.values())))),
    sampler=r"[A-Za-z][A-Za-z0-9_-]*",
    set="train|generation|description",
    block=r"\d+-\d+",
    D=r"\d+",
    ROW=r"\d+",
    seed=r"\d+",
    chain=r"\d+",
