"""The one place that knows Snakemake from inside (its private parts are those of the version in environment.lock).

`run` calls Snakemake as its command line does, but lets somebody else decide which jobs are to run: Snakemake itself
would go by times of files and by its own notes, of which a restored artifact has none.
"""

from __future__ import annotations

import io
import logging
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, redirect_stderr
from dataclasses import dataclass
from pathlib import Path
from signal import Signals
from typing import Any

from workflow.artifacts.provenance import ROOT, code_is_unchanged, rule_code
from workflow.execution import cluster, forks
from workflow.execution.dag import Job, Plan
from workflow.execution.job import last_lines
from workflow.execution.roles import by_role

SCRIPTS = ROOT / "workflow" / "scripts"
PROFILES = ROOT / "workflow" / "profiles"
DEFAULT = "default"
# What Snakemake says before it lays out the jobs.
CHATTER = ("Using profile", "Assuming unrestricted shared filesystem", "Building DAG of jobs")


@dataclass(frozen=True)
class Hooks:
    """What Snakemake is to ask and to tell.

    Attributes:
        decide: the jobs of a plan that must run, by their place in it.
        finished: told of each job that has succeeded, and whether its code is still that of the plan.
    """

    decide: Callable[[Plan], Collection[int]]
    finished: Callable[[Job, bool], None] = lambda job, same_code: None


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


@contextmanager
def _hooked(hooks: Hooks) -> Iterator[None]:
    """Put the hooks in place of methods of Snakemake, and forks in place of its processes, while the block lasts."""
    from snakemake import cli
    from snakemake.dag import DAG
    from snakemake.logging import LoggerManager
    from snakemake.script import PythonScript

    finish, make_handler, calm = DAG.finish, LoggerManager._default_streamhandler, _Calm()
    parse_args = cli.parse_args

    def parsed(argv: Any) -> Any:
        said = io.StringIO()
        try:
            with redirect_stderr(said):
                return parse_args(argv)
        finally:
            lines = said.getvalue().splitlines(keepends=True)
            sys.stderr.writelines(line for line in lines if not line.startswith(CHATTER))

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
            calm.running = True
            forks.preload({path for job in chosen for path in (_script(job), *(ROOT / name for name in _modules(job)))})
            dag.workflow.iocache.deactivate()  # it has seen files that the decision removed, and missed restored ones
            # Its limit of jobs a second has the scheduler look at all jobs again once a second for each job that has
            # ended: after some hundreds it does little else.
            dag.workflow.scheduling_settings.max_jobs_per_timespan = None
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
                    hooks.finished(_job(dag, each), code_is_unchanged(_script(each), *_modules(each)))
        return result

    def execute(script: Any, fname: str, edit: bool = False) -> None:
        status = forks.run(fname)
        if status < 0:  # it could not say why by itself
            log = str(script.log[0])
            ended = f"rule {script.rulename} was ended by {Signals(-status).name}"
            sys.stderr.write(f"{ended}\n{last_lines(Path(log))}(more in {log})\n")
        if status != 0:
            raise JobError(script.rulename)

    def handler(manager: Any) -> logging.Handler:
        made: logging.Handler = make_handler(manager)
        made.addFilter(calm)
        return made

    with ExitStack() as replaced:
        for owner, method, replacement in (
            (cli, "parse_args", parsed),
            (DAG, "update_needrun", decided),
            (DAG, "finish", finished),
            (PythonScript, "execute_script", execute),
            (LoggerManager, "_default_streamhandler", handler),
        ):
            replaced.callback(setattr, owner, method, getattr(owner, method))
            setattr(owner, method, replacement)
        replaced.callback(forks.stop)
        yield


class JobError(Exception):
    """A job has failed, and has told why."""


class _Calm(logging.Filter):
    """Keeps off the screen what Snakemake tells of each job: its own log, in OUT/.snakemake/log, has all of it.

    Of a job that failed the job itself has told, so that Snakemake need not tell where it was called.

    Attributes:
        running: jobs are being run; before, and where none are, Snakemake may be asked a question, and answers.
    """

    running = False

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether a record is shown."""
        if record.levelno >= logging.WARNING:
            return getattr(record, "event", "") != "job_error" and JobError.__name__ not in record.getMessage()
        return not self.running and not record.getMessage().startswith(CHATTER)


def _name(job: Any) -> tuple[str, str]:
    return job.rule.name, str(sorted(by_role(job.wildcards).items()))


def _script(job: Any) -> Path:
    return SCRIPTS / Path(job.rule.script).name


def _modules(job: Any) -> list[str]:
    """The modules that the script of a job imports by name, beside those that it names itself."""
    return list(by_role(job.params).get("modules", ()))


def _job(dag: Any, job: Any) -> Job:
    """A job of Snakemake as ours.

    Raises:
        ValueError: its rule does something that its key would not tell.
    """
    rule = job.rule.name
    if not job.rule.script:
        raise ValueError(f"rule {rule} has no script: what it does would not be part of its key")
    script = _script(job)
    parameters = by_role(job.params)
    if parameters.get("code") != rule_code(script, *_modules(job)):
        raise ValueError(f"rule {rule}: its parameter code must be tracked({script.name!r}), the script that it runs")
    return Job(
        rule=rule,
        wildcards={name: str(value) for name, value in by_role(job.wildcards).items()},
        parameters=parameters,
        inputs={role: str(path) for role, path in by_role(job.input).items()},
        outputs={role: str(path) for role, path in by_role(job.output).items()},
        log=str(job.log[0]),
        forced=job.rule in dag.forcerules or not dag.forcefiles.isdisjoint(job.output),
    )
