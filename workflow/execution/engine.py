"""Snakemake, called twice: it lays out the jobs, keys decide which of them to run, and it runs those.

Snakemake's own decision would rest on times of files and on its notes, which restored artifacts lack. So it gets the
outputs of the chosen jobs, which do not exist, as its targets. What it calls back is in `workflow.execution.plugins`.
"""

from __future__ import annotations

import io
import sys
from argparse import Namespace
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from snakemake import cli

from workflow.artifacts.provenance import ROOT
from workflow.execution import forks, plugins
from workflow.execution.dag import Job, Plan
from workflow.execution.progress import working_at

PROFILES = ROOT / "workflow" / "profiles"
DEFAULT = "default"
STAGES_OF_RULES = ("collect", "figures")  # whose rules are many, named by what each makes


@dataclass(frozen=True)
class Hooks:
    """What a run asks and tells.

    Attributes:
        decide: Gives the jobs of a plan that must run, by index. If the plan is for real, it leaves none of their
            outputs, and no other artifact older than its inputs.
        finished: Receives each job that has succeeded, and whether its code is still as planned.
    """

    decide: Callable[[Plan], Collection[int]]
    finished: Callable[[Job, bool], None] = lambda job, same_code: None


def run(arguments: Sequence[str], hooks: Hooks) -> int:
    """Run Snakemake in this process; its exit status."""
    try:
        parser, asked = _parsed(arguments)
        plugins.install(asked.executor)
        asked = _changed(asked, logger=[plugins.LOGGER], rerun_incomplete=False)  # records tell what is complete
        try:
            plugins.orders = plugins.Orders()
            changes_files = asked.touch or asked.delete_all_output or asked.delete_temp_output
            stages = forced_stages(asked.forcerun)
            asked = _changed(asked, forcerun=set(asked.forcerun) - stages)
            laying_out = asked if changes_files else _changed(asked, dryrun=True)
            with working_at("laying out the jobs"):
                return 0 if cli.args_to_api(laying_out, parser) else 1  # the answer to a question such as --summary
        except plugins.LaidOut as laid_out:
            jobs = forced(laid_out.jobs, stages)
        part = asked.targets or asked.until or asked.omit_from or asked.batch
        chosen = [jobs[i] for i in sorted(hooks.decide(Plan(jobs, for_real=not asked.dryrun, whole=not part)))]
        if asked.dryrun:
            sys.stdout.write(_table(chosen))
        if asked.dryrun or not chosen:
            return 0
        plugins.orders = plugins.Orders({next(iter(job.outputs.values())): job for job in chosen}, hooks.finished)
        forks.preload({path for job in chosen for path in (job.script, *(ROOT / name for name in job.modules))})
        try:
            return 0 if cli.args_to_api(_making(asked, list(plugins.orders.jobs)), parser) else 1
        finally:
            forks.stop()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1
    except KeyboardInterrupt:  # before the first job; later ones Snakemake handles
        return 1
    except (ValueError, OSError) as error:
        sys.stderr.write(f"{error}\n")
        return 1


def forced_stages(asked: Collection[str] | None) -> set[str]:
    """Of what `--forcerun` names, the stages that stand for all of their rules: each block of trials is a rule."""
    return set(asked or ()) & set(STAGES_OF_RULES)


def forced(jobs: Sequence[Job], stages: Collection[str]) -> list[Job]:
    """The jobs, with those of some stages forced.

    Raises:
        ValueError: There is no job of a stage.
    """
    for stage in set(stages) - {job.stage for job in jobs}:
        raise ValueError(f"--forcerun {stage}: this study has no such job")
    return [replace(job, forced=job.forced or job.stage in stages) for job in jobs]


def _parsed(arguments: Sequence[str]) -> tuple[Any, Namespace]:
    """Snakemake's parser, and what it reads from the arguments, without the remark that profiles are used."""
    said = io.StringIO()
    try:
        with redirect_stderr(said):
            parser, asked = cli.parse_args(list(arguments))
    finally:
        sys.stderr.writelines(
            line for line in said.getvalue().splitlines(True) if not line.startswith("Using profile")
        )
    return parser, asked


def _changed(asked: Namespace, **changes: Any) -> Namespace:
    return Namespace(**{**vars(asked), **changes})


def _making(asked: Namespace, targets: list[str]) -> Namespace:
    """The arguments that make these files and nothing else."""
    none: dict[str, Any] = {
        "batch": None,
        "force": False,
        "forceall": False,
        "forcerun": [],
        "omit_from": [],
        "until": [],
    }
    # With a limit of jobs per second, the scheduler looks at all jobs again each second for each job that has ended.
    none["max_jobs_per_timespan"] = None
    executor = plugins.FORKS if asked.executor in (None, "local") else asked.executor
    return _changed(asked, executor=executor, targets=targets, **none)


def _table(jobs: Collection[Job]) -> str:
    """The number of jobs of each rule."""
    counts = [*sorted(Counter(job.rule for job in jobs).items()), ("total", len(jobs))]
    return "".join(f"{rule:{max(len(name) for name, _ in counts)}}  {count}\n" for rule, count in counts)


def command_line(config: Path, out: Path, cores: int | None = None, profile: str = DEFAULT) -> list[str]:
    """The arguments of Snakemake for a study.

    Args:
        config: The config file.
        out: The output folder.
        cores: How many jobs may run at the same time (on a cluster, within one of its jobs); None for the profile's.
        profile: The folder of a profile, or the name of one in `workflow/profiles`; it is laid over the default one.

    Raises:
        ValueError: There is no such profile.
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
        "--ignore-incomplete",
        *("--rerun-triggers", "software-env"),  # none, since no rule has its own environment
        "--nolock",  # the runner's lock ends with its process, however that dies
    ]


def planned(config: Path, out: Path) -> list[Job]:
    """The jobs of a study, in an order in which they could run; runs nothing.

    Raises:
        RuntimeError: Snakemake cannot plan it, and has printed why.
    """
    found: list[Job] = []

    def decide(plan: Plan) -> Collection[int]:
        found[:] = plan.jobs
        return ()

    if run(command_line(config, out, 1), Hooks(decide)) != 0:
        raise RuntimeError(f"{config}: Snakemake cannot plan this study")
    return found
