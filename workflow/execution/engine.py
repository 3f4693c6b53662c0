"""Snakemake as a function: it lays out the jobs, somebody else decides which to run, and it runs those.

Snakemake itself would go by times of files and by its own notes, of which a restored artifact has none.
"""

from __future__ import annotations

import io
import sys
from argparse import Namespace
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workflow.artifacts.provenance import ROOT
from workflow.execution import forks
from workflow.execution.dag import Job, Plan

PROFILES = ROOT / "workflow" / "profiles"
DEFAULT = "default"


@dataclass(frozen=True)
class Hooks:
    """What is asked and told during a run.

    Attributes:
        decide: the jobs of a plan that must run, by their place in it. If it is for real, none of their outputs is
            left, and no other artifact is older than what it is made from.
        finished: told of each job that has succeeded, and whether its code is still that of the plan.
    """

    decide: Callable[[Plan], Collection[int]]
    finished: Callable[[Job, bool], None] = lambda job, same_code: None


def run(arguments: Sequence[str], hooks: Hooks) -> int:
    """Run Snakemake in this process; its exit status."""
    from snakemake import cli

    from workflow.execution import plugins

    try:
        parser, asked = _parsed(arguments)
        plugins.install(asked.executor)
        asked = _changed(asked, logger=[plugins.LOGGER], rerun_incomplete=False)  # records tell what is complete
        try:
            plugins.orders = plugins.Orders()
            laying = asked if asked.touch else _changed(asked, dryrun=True)
            return 0 if cli.args_to_api(laying, parser) else 1  # it was asked something else, or cannot
        except plugins.LaidOut as laid_out:
            jobs = laid_out.jobs
        part = asked.targets or asked.until or asked.omit_from or asked.batch
        chosen = [jobs[i] for i in sorted(hooks.decide(Plan(jobs, for_real=not asked.dryrun, whole=not part)))]
        if asked.dryrun or not chosen:
            sys.stdout.write(_table(chosen) if asked.dryrun else "")
            return 0
        plugins.orders = plugins.Orders({next(iter(job.outputs.values())): job for job in chosen}, hooks.finished)
        forks.preload({job.script for job in chosen})
        try:
            return 0 if cli.args_to_api(_running(asked, list(plugins.orders.jobs)), parser) else 1
        finally:
            forks.stop()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1
    except KeyboardInterrupt:  # before the first job; later ones Snakemake deals with
        return 1
    except (ValueError, OSError) as error:
        sys.stderr.write(f"{error}\n")
        return 1


def _parsed(arguments: Sequence[str]) -> tuple[Any, Namespace]:
    """What the arguments say, and the parser. That profiles are used is not said."""
    from snakemake import cli

    from workflow.execution.plugins import CHATTER

    said = io.StringIO()
    try:
        with redirect_stderr(said):
            parser, asked = cli.parse_args(list(arguments))
    finally:
        sys.stderr.writelines(
            line for line in said.getvalue().splitlines(keepends=True) if not line.startswith(CHATTER)
        )
    return parser, asked


def _changed(asked: Namespace, **changes: Any) -> Namespace:
    return Namespace(**{**vars(asked), **changes})


def _running(asked: Namespace, targets: list[str]) -> Namespace:
    """What to ask of Snakemake, so that it makes these files and nothing else."""
    from workflow.execution.plugins import FORKS

    return _changed(
        asked,
        executor=FORKS if asked.executor in (None, "local") else asked.executor,
        targets=targets,
        until=[],
        omit_from=[],
        batch=None,
        force=False,
        forceall=False,
        forcerun=[],
        # Its limit of jobs a second has the scheduler look at all jobs again once a second for each job that has
        # ended: after some hundreds it does little else.
        max_jobs_per_timespan=None,
    )


def _table(jobs: Collection[Job]) -> str:
    """How many jobs of each rule would run."""
    counts = sorted(Counter(job.rule for job in jobs).items())
    width = max([len(rule) for rule, _ in counts], default=0)
    return "".join(f"{rule:{width}}  {count}\n" for rule, count in [*counts, ("total", len(jobs))])


def command_line(config: Path, out: Path, cores: int | None = None, profile: str = DEFAULT) -> list[str]:
    """The arguments of Snakemake for a study.

    Args:
        config: the config file.
        out: the output folder.
        cores: how many jobs may run at the same time, on a cluster within one of its jobs; None for the profile's.
        profile: the folder of a profile, or the name of one of `workflow/profiles`. It is laid over the default one.

    Raises:
        ValueError: there is no such profile.
    """
    folder = next((each for each in (PROFILES / profile, Path(profile)) if (each / "config.yaml").is_file()), None)
    if folder is None:
        known = ", ".join(sorted(each.name for each in PROFILES.iterdir()))
        raise ValueError(f"--profile {profile}: neither one of {known}, nor a folder with a config.yaml")
    return [
        *("--snakefile", str(ROOT / "Snakefile")),
        *(f"--profile={each}" for each in dict.fromkeys([PROFILES / DEFAULT, folder.resolve()])),
        *("--workflow-profile", "none"),
        *("--configfile", str(config.resolve())),
        *("--directory", str(out.resolve())),
        *(() if cores is None else ("--cores", str(cores))),
        "--ignore-incomplete",  # records tell better what is complete
        *("--rerun-triggers", "software-env"),  # that is, none: no rule has an environment of its own
        "--nolock",  # the runner holds a lock that lets go when its process dies, however it dies
    ]


def planned(config: Path, out: Path) -> list[Job]:
    """The jobs of a study, in an order in which they could run; nothing is run.

    Raises:
        RuntimeError: Snakemake could not plan it, and has printed why.
    """
    found: list[Job] = []

    def decide(plan: Plan) -> Collection[int]:
        found[:] = plan.jobs
        return ()

    if run(command_line(config, out, 1), Hooks(decide)) != 0:
        raise RuntimeError(f"{config}: Snakemake cannot plan this study")
    return found
