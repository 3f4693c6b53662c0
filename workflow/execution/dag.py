"""The plan of a run: what Snakemake laid out, as data, and the keys of its jobs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workflow.artifacts.keys import job_key, output_key


@dataclass(frozen=True)
class Job:
    """A job of the plan.

    Attributes:
        rule: name of its rule.
        wildcards: values by name.
        parameters: `params` of the rule.
        inputs: path by role; relative to OUT where a job makes it, absolute where it comes from elsewhere.
        outputs: path by role, relative to OUT.
        log: path of its log, relative to OUT.
        forced: the user asked Snakemake to run it in any case.
        script: what it runs.
    """

    rule: str
    wildcards: dict[str, str]
    parameters: dict[str, Any]
    inputs: dict[str, str]
    outputs: dict[str, str]
    log: str = ""
    forced: bool = False
    script: Path = Path()

    @property
    def stage(self) -> str:
        """What it is a part of: the folder of its log, or its name."""
        return Path(self.log).with_suffix("").parts[1]


@dataclass(frozen=True)
class Plan:
    """What Snakemake laid out.

    Attributes:
        jobs: in an order in which they could run.
        for_real: this is no dry run, nor a question such as --summary.
        whole: these are all jobs of the study, not those for some target.
    """

    jobs: Sequence[Job]
    for_real: bool = True
    whole: bool = True


def keys_of(jobs: Sequence[Job], source_key: Callable[[str], str]) -> list[str]:
    """The key of each job, for jobs in an order in which they could run.

    Args:
        jobs: with the makers of their inputs before them.
        source_key: the key of a file that no job makes.
    """
    keys: list[str] = []
    made: dict[str, str] = {}
    for job in jobs:
        for role, path in job.inputs.items():
            if path not in made and not Path(path).is_absolute():
                raise ValueError(f"rule {job.rule}, input {role}: {path} is made by no rule; it must be absolute")
        inputs = {role: made[path] if path in made else source_key(path) for role, path in job.inputs.items()}
        keys.append(job_key(job.rule, job.wildcards, job.parameters, inputs))
        made |= {path: output_key(keys[-1], role) for role, path in job.outputs.items()}
    return keys
