"""What Snakemake calls through its registries of plugins: executors, and the handler of its log.

What is used of Snakemake beyond its manual and these interfaces is listed, and limited, by `.ci/private_names`.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from signal import Signals
from threading import Event
from types import SimpleNamespace
from typing import Any

from snakemake.iocontainers import InputFiles, Log, OutputFiles, Params, Wildcards
from snakemake_interface_executor_plugins.executors.base import AbstractExecutor, SubmittedJobInfo
from snakemake_interface_executor_plugins.registry import ExecutorPluginRegistry
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.registry import LoggerPluginRegistry

from workflow.artifacts.provenance import ROOT, code_is_unchanged, rule_code
from workflow.execution import forks
from workflow.execution.dag import Job
from workflow.execution.job import last_lines
from workflow.execution.roles import by_role

FORKS, LOGGER = "forks", "study"
SCRIPTS = ROOT / "workflow" / "scripts"
CHATTER = ("Assuming unrestricted shared filesystem", "Building DAG of jobs")


class LaidOut(BaseException):
    """Leaves Snakemake when it has laid out the jobs. It would report an `Exception`."""

    def __init__(self, jobs: list[Job]) -> None:
        self.jobs = jobs


@dataclass
class Orders:
    """What the plugins are to do.

    Attributes:
        jobs: The jobs to run, by the path of their first output; empty while jobs are laid out.
        finished: As in `workflow.execution.engine.Hooks`.
    """

    jobs: Mapping[str, Job] = field(default_factory=dict)
    finished: Callable[[Job, bool], None] = lambda job, same_code: None


orders = Orders()


def install(executor: str | None) -> None:
    """Put the plugins into the registries of this process.

    Args:
        executor: The one that was asked for, which is extended.
    """
    executors = ExecutorPluginRegistry()
    plugins = executors.plugins
    if FORKS not in plugins:
        plugins[FORKS] = replace(plugins["local"], executor=_Forks)
        plugins["dryrun"] = replace(plugins["dryrun"], executor=_Layout)
        LoggerPluginRegistry().register_plugin(
            f"snakemake_logger_plugin_{LOGGER}", SimpleNamespace(LogHandler=_Handler)
        )
    if executor in plugins and not issubclass(plugins[executor].executor, _Reporting):
        kinds = (_Slurm if executor == "slurm" else _Reporting, plugins[executor].executor)
        plugins[executor] = replace(plugins[executor], executor=type("Executor", kinds, {}))


class _Layout:
    """Takes the jobs, in place of the executor of dry runs."""

    def __init__(self, workflow: Any, logger: Any) -> None:
        dag = workflow.dag
        ordered = [job for level in dag.toposorted() for job in sorted(level, key=_name) if not job.is_norun]
        raise LaidOut([_job(dag, job) for job in ordered])


def _name(job: Any) -> tuple[str, str]:
    return job.rule.name, str(sorted(by_role(job.wildcards).items()))


def _job(dag: Any, job: Any) -> Job:
    """Convert a job of Snakemake.

    Raises:
        ValueError: The key would not tell what the rule does.
    """
    rule = job.rule.name
    if not job.rule.script:
        raise ValueError(f"rule {rule} has no script: what it does would not be part of its key")
    script = SCRIPTS / Path(job.rule.script).name
    parameters = by_role(job.params)
    if parameters.get("code") != rule_code(script, *parameters.get("modules", ())):
        raise ValueError(f"rule {rule}: its parameter code must be tracked({script.name!r}), the script that it runs")
    return Job(
        rule=rule,
        wildcards={name: str(value) for name, value in by_role(job.wildcards).items()},
        parameters=parameters,
        inputs={role: str(path) for role, path in by_role(job.input).items()},
        outputs={role: str(path) for role, path in by_role(job.output).items()},
        log=str(job.log[0]),
        forced=job.rule in dag.forcerules or not dag.forcefiles.isdisjoint(job.output),
        script=script,
    )


def _ordered(job: Any) -> Job | None:
    """The job to run that Snakemake means.

    None if Snakemake would run it only because one of its inputs is made again; its key tells that it need not.
    """
    return orders.jobs.get(str(job.output[0]))


class _Reporting:
    """Part of an executor: reports each job that has succeeded."""

    def handle_job_success(self, job: Any) -> None:
        super().handle_job_success(job)  # type: ignore[misc]
        for each in map(_ordered, job.jobs if job.is_group() else [job]):
            if each is not None:
                orders.finished(each, code_is_unchanged(each.script, *each.modules))


class _Forks(_Reporting, AbstractExecutor):  # type: ignore[misc]
    """Runs each job as a fork of one process."""

    def __init__(self, workflow: Any, logger: Any) -> None:
        super().__init__(workflow, logger)
        self._pool = ThreadPoolExecutor(workflow.resource_settings.cores)
        self._cancelled = Event()
        self._reported: set[str] = set()

    def run_job(self, job: Any) -> None:
        info = SubmittedJobInfo(job)
        self.report_job_submission(info)
        self._pool.submit(self._run, info)

    def _run(self, info: SubmittedJobInfo) -> None:
        try:
            succeeded = _succeeds(info.job)
        except Exception as error:  # such as a full disk; Snakemake would wait for the job forever
            self._report_once(f"{error or type(error).__name__}")
            succeeded = False
        (self.report_job_success if succeeded else self.report_job_error)(info)

    def _report_once(self, fault: str) -> None:
        """Say what keeps jobs from starting, once for all of them, and not of jobs that an interrupt stops."""
        # An interrupt ends the process that starts jobs as well, perhaps before it is known here.
        if fault not in self._reported and not self._cancelled.wait(1.0):
            self._reported.add(fault)
            sys.stderr.write(f"{fault}\n")

    def shutdown(self) -> None:
        self._pool.shutdown()

    def cancel(self) -> None:
        self._cancelled.set()
        self.shutdown()

    def handle_job_error(self, job: Any) -> None:
        """Do nothing: the job has reported it."""


def _succeeds(job: Any) -> bool:
    """Run a job in a fork, and report whether it succeeded."""
    ours = _ordered(job)
    if ours is None:
        return True
    job.register()  # notes the time, for Snakemake's own report
    for path in (*job.output, *job.log):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    given = SimpleNamespace(
        rule=ours.rule,
        input=InputFiles(job.input, plainstr=True),
        output=OutputFiles(job.output, plainstr=True),
        params=Params(job.params),
        wildcards=Wildcards(job.wildcards),
        log=Log(job.log, plainstr=True),
    )
    status = forks.run(ours.script, given)
    if status < 0 or status == forks.LOST:  # it could not say why by itself
        why = f": {forks.ENDED}" if status == forks.LOST else f" was ended by {Signals(-status).name}"
        ended = f"rule {ours.rule}{why}"
        sys.stderr.write(f"{ended}\n{last_lines(Path(ours.log))}(more in {ours.log})\n")
    return status == 0


class _Slurm(_Reporting):
    """Part of the executor for Slurm, whose jobs are Snakemake again.

    Each is to run its group itself, as many jobs at a time as it has cores; the plugin would have it do one after the
    other, each by `srun` and a further Snakemake (issue 469 of the plugin). And Snakemake does not show
    what the plugin knows of a group that failed.
    """

    def additional_general_args(self) -> str:
        return "--executor local"

    def print_job_error(
        self, job_info: Any, msg: str | None = None, aux_logs: Iterable[str] = (), **more: Any
    ) -> None:
        logs = "".join(f"\n(more in {log})" for log in aux_logs if log)
        sys.stderr.write(f"{msg or 'a job of Slurm failed'}{logs}\n")
        super().print_job_error(job_info, msg, aux_logs=list(aux_logs), **more)  # type: ignore[misc]


class _Handler(LogHandlerBase):  # type: ignore[misc]
    """Keeps off the screen what Snakemake says about each job; its log in OUT/.snakemake/log has everything."""

    writes_to_stream = True
    writes_to_file = has_filter = has_formatter = needs_rulegraph = False

    def emit(self, record: logging.LogRecord) -> None:
        text = self.format(record)
        if record.levelno >= logging.WARNING:
            shown = getattr(record, "event", "") != "job_error"  # the job has reported it
        else:
            shown = not orders.jobs and not text.startswith(CHATTER)
        if shown and text not in ("", "None"):
            sys.stderr.write(f"{text}\n")
