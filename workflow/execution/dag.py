"""The plan of a run, as data, and the keys of its jobs."""

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
        rule: The name of its rule.
        wildcards: Values by name.
        parameters: `params` of the rule.
        inputs: Path by role; relative to OUT for artifacts, absolute for external files.
        outputs: Path by role, relative to OUT.
        log: The path of its log, relative to OUT.
        forced: Whether the user asked for it to run in any case.
        script: The script that it runs.
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
    def modules(self) -> list[str]:
        """The project files that its script imports by a name that it is given."""
        return list(self.parameters.get("modules", ()))

    @property
    def stage(self) -> str:
        """The stage that it belongs to: the folder of its log, or the log's name."""
        return Path(self.log).with_suffix("").parts[1]


@dataclass(frozen=True)
class Plan:
    """The jobs of a run.

    Attributes:
        jobs: In an order in which they could run.
        for_real: Whether this is not a dry run.
        whole: Whether these are all jobs of the study, rather than those for some targets.
    """

    jobs: Sequence[Job]
    for_real: bool = True
    whole: bool = True


def keys_of(jobs: Sequence[Job], source_key: Callable[[str], str]) -> list[str]:
    """The key of each job, for jobs in an order in which they could run.

    Args:
        jobs: Each after the jobs that make its inputs.
        source_key: The key of an external file.

    Raises:
        ValueError: An input is made by no job, and its path is not absolute.
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
