"""The one place that knows Snakemake from inside (its private parts are those of the version in environment.lock).

`run` calls Snakemake as its command line does, but lets somebody else decide which jobs are to run: Snakemake itself
would go by times of files and by its own notes, of which a restored artifact has none.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workflow import cluster
from workflow.keys import by_role, job_key, output_key
from workflow.provenance import ROOT, code_hash, lock_hash

SCRIPTS = ROOT / "workflow" / "scripts"
PROFILES = ROOT / "workflow" / "profiles"
DEFAULT = "default"


@dataclass(frozen=True)
class Job:
    """A job of the plan.

    Attributes:
        rule: name of its rule.
        wildcards: values by name.
        parameters: `params` of the rule.
        inputs: path by role; relative to OUT where a job makes it, absolute where it comes from elsewhere.
        outputs: path by role, relative to OUT.
        forced: the user asked Snakemake to run it in any case.
    """

    rule: str
    wildcards: dict[str, str]
    parameters: dict[str, Any]
    inputs: dict[str, str]
    outputs: dict[str, str]
    forced: bool = False


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


@dataclass(frozen=True)
class Hooks:
    """What Snakemake is to ask and to tell.

    Attributes:
        decide: the jobs of a plan that must run, by their place in it.
        finished: told of each job that has succeeded.
    """

    decide: Callable[[Plan], Collection[int]]
    finished: Callable[[Job], None] = lambda job: None


def run(arguments: Sequence[str], hooks: Hooks) -> int:
    """Run Snakemake in this process; its exit status."""
    from snakemake.cli import main

    with _hooked(hooks), cluster.mended():
        try:
            main(list(arguments))
        except SystemExit as end:
            return end.code if isinstance(end.code, int) else 1
        except KeyboardInterrupt:  # before the first job; later ones Snakemake deals with
            return 1
    return 0


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

    if run([*command_line(config, out, 1), "--dry-run", "--quiet", "all"], Hooks(decide)) != 0:
        raise RuntimeError(f"{config}: Snakemake cannot plan this study")
    return found


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


@contextmanager
def _hooked(hooks: Hooks) -> Iterator[None]:
    """Put the hooks in place of two methods of Snakemake's DAG, for as long as the block lasts."""
    from snakemake.dag import DAG

    update_needrun, finish = DAG.update_needrun, DAG.finish

    async def decided(dag: Any, create_inventory: bool = False) -> None:
        ordered = [job for level in dag.toposorted() for job in sorted(level, key=_name)]
        tracked = [job for job in ordered if not job.is_norun]
        asked = dag.workflow.dag_settings
        plan = Plan(
            [_job(dag, job) for job in tracked],
            for_real=dag.workflow.executor_plugin is not None and not (dag.workflow.dryrun or dag.workflow.touch),
            whole=not (asked.targets or asked.until or asked.omit_from or asked.batch),
        )
        chosen = {tracked[i] for i in hooks.decide(plan)}
        if plan.for_real:
            dag.workflow.iocache.deactivate()  # it has seen files that the decision removed, and missed restored ones
        for job in ordered:  # targets such as `all`, which do nothing but ask for files
            if job.is_norun and not chosen.isdisjoint(dag.dependencies[job]):
                chosen.add(job)
        dag._needrun = chosen
        dag._n_until_ready.clear()
        dag._ready_jobs.clear()
        for job in dag._needrun:
            dag.reason(job).missing_output.update(job.output)
            dag._n_until_ready[job] = sum(1 for maker in dag.dependencies[job] if maker in dag._needrun)
        dag._len = len(dag._finished | dag._needrun)

    async def finished(dag: Any, job: Any, update_checkpoint_dependencies: bool = True) -> Any:
        result = await finish(dag, job, update_checkpoint_dependencies)
        if not (dag.workflow.dryrun or dag.workflow.touch):
            for each in job if job.is_group() else [job]:
                if not each.is_norun:
                    hooks.finished(_job(dag, each))
        return result

    DAG.update_needrun, DAG.finish = decided, finished
    try:
        yield
    finally:
        DAG.update_needrun, DAG.finish = update_needrun, finish


def _name(job: Any) -> tuple[str, str]:
    return job.rule.name, str(sorted(by_role(job.wildcards).items()))


def _job(dag: Any, job: Any) -> Job:
    """A job of Snakemake as ours.

    Raises:
        ValueError: its rule does something that its key would not tell.
    """
    rule = job.rule.name
    if not job.rule.script:
        raise ValueError(f"rule {rule} has no script: what it does would not be part of its key")
    script = SCRIPTS / Path(job.rule.script).name
    parameters = by_role(job.params)
    if parameters.get("code") != code_hash(script) + lock_hash():
        raise ValueError(f"rule {rule}: its parameter code must be tracked({script.name!r}), the script that it runs")
    return Job(
        rule=rule,
        wildcards={name: str(value) for name, value in by_role(job.wildcards).items()},
        parameters=parameters,
        inputs={role: str(path) for role, path in by_role(job.input).items()},
        outputs={role: str(path) for role, path in by_role(job.output).items()},
        forced=job.rule in dag.forcerules or not dag.forcefiles.isdisjoint(job.output),
    )
