"""A tiny plan of three jobs without Snakemake, to test what keeps, stores and verifies artifacts."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Sequence
from contextlib import chdir
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

from snakemake.iocontainers import InputFiles, OutputFiles, Params, Wildcards

from data_collection.files import replacing
from tests.workflow.runs import SMOKE
from workflow.artifacts.manifest import write_manifest
from workflow.artifacts.records import FOLDER, DamagedError, remove
from workflow.artifacts.store import Store
from workflow.execution import engine, runner
from workflow.execution import job as wrapper
from workflow.execution.dag import Job, Plan
from workflow.execution.engine import Hooks
from workflow.execution.keeping import Keeper

CODE = "code and lock"


def plan(seed: int = 1, out: str = "") -> list[Job]:
    """Two trials → a folder and a fit → scores."""
    logs = {"logs[0]": "mcap/a.mcap", "logs[1]": "mcap/b.mcap"}
    fit = {"fit": "fits/1.npz", "extra": "fits/more"}
    return [
        Job("collect", {}, {"seed": seed, "code": CODE}, {}, logs, "joblogs/collect.log"),
        Job("fit", {"seed": "1"}, {"code": CODE}, {"x": "mcap/b.mcap"}, fit, "joblogs/fit/1.log"),
        Job("scores", {}, {"code": CODE}, {"fit": "fits/1.npz"}, {"[0]": "scores.csv"}, "joblogs/scores.log"),
    ]


def given(job: Job) -> SimpleNamespace:
    """What Snakemake gives the script of a job."""
    names = {
        "rule": job.rule,
        "input": InputFiles(fromdict=job.inputs),
        "output": OutputFiles(fromdict={role: path for role, path in job.outputs.items() if "[" not in role}),
        "params": Params(fromdict=job.parameters),
        "wildcards": Wildcards(fromdict=job.wildcards),
    }
    for role, path in job.outputs.items():
        if "[" in role:
            names["output"].append(path)
    if job.rule == "collect":
        names["output"]._set_name("logs", 0, 2)
    return SimpleNamespace(**names)


def work(job: Job) -> None:
    """Do a job as its script would, in the current folder."""
    with wrapper.recorded(given(job)):
        text = f"{job.rule} {job.parameters} " + " ".join(Path(path).read_text() for path in job.inputs.values())
        for path in map(Path, job.outputs.values()):
            path.parent.mkdir(parents=True, exist_ok=True)
            if path.name == "more":
                path.mkdir()
                written = {path / f"{name}.txt": f"{name} {text}" for name in ("one", "two")}
            else:
                written = {path: f"{path} {text}"}
            for file, content in written.items():
                with replacing(file) as (temporary,):
                    temporary.write_text(content)


def run(
    out: Path,
    store: Store,
    jobs: list[Job] | None = None,
    after: Callable[[str], None] | None = None,
    whole: bool = True,
) -> int:
    """Run the tiny study as `workflow.execution.runner` runs a study; its status.

    Args:
        out: The output folder.
        store: Where artifacts are shared.
        jobs: Of the plan.
        after: Called with each rule when its job has finished.
        whole: Whether these are all jobs of the study.
    """
    jobs = jobs or plan()

    def in_place_of_snakemake(arguments: Sequence[str], hooks: Hooks) -> int:
        with chdir(out):
            for i in sorted(hooks.decide(Plan(jobs, whole=whole))):
                try:
                    work(jobs[i])
                except (OSError, DamagedError) as error:
                    sys.stderr.write(f"{error}\n")
                    for path in jobs[i].outputs.values():
                        remove(out, path)
                    return 1
                hooks.finished(jobs[i], True)
                if after is not None:
                    after(jobs[i].rule)
        return 0

    with patch.object(engine, "run", in_place_of_snakemake):
        return runner.run(SMOKE, out, 1, engine.DEFAULT, (), store)  # any config: the jobs are given


def files(folder: Path) -> dict[str, bytes]:
    """What a tiny study left: artifacts, records and the manifest, by path."""
    left = {path.relative_to(folder): path for path in sorted(folder.rglob("*")) if path.is_file()}
    hidden = [name for name in left if any(part.startswith(".") and part != FOLDER for part in name.parts)]
    return {name.as_posix(): path.read_bytes() for name, path in left.items() if name not in hidden}


def carry_out(keeper: Keeper, out: Path, jobs: list[Job], monkeypatch: object) -> list[str]:
    """Do what Snakemake would; the rules of the jobs that ran."""
    monkeypatch.chdir(out)  # type: ignore[attr-defined]
    needed: Collection[int] = keeper.decide(Plan(jobs))
    for i in sorted(needed):
        work(jobs[i])
        keeper.finished(jobs[i])
    assert keeper.whole
    write_manifest(out, keeper.planned, patience=0)
    return [jobs[i].rule for i in sorted(needed)]
