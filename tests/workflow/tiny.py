"""A tiny plan of three jobs without Snakemake, to test what keeps, stores and verifies artifacts."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from types import SimpleNamespace

from snakemake.iocontainers import InputFiles, OutputFiles, Params, Wildcards

from workflow import job as wrapper
from workflow.dag import Job, Plan
from workflow.keeping import Keeper
from workflow.manifest import write_manifest

CODE = "code and lock"


def plan(seed: int = 1, out: str = "") -> list[Job]:
    """Two trials → a folder and a fit → scores."""
    log = {"logs[0]": "mcap/a.mcap", "logs[1]": "mcap/b.mcap"}
    return [
        Job("collect", {}, {"seed": seed, "code": CODE}, {}, log),
        Job("fit", {"seed": "1"}, {"code": CODE}, {"x": "mcap/b.mcap"}, {"fit": "fits/1.npz", "extra": "fits/more"}),
        Job("scores", {}, {"code": CODE}, {"fit": "fits/1.npz"}, {"[0]": "scores.csv"}),
    ]


def work(job: Job) -> None:
    """Do a job as its script would, in the current folder."""
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
    with wrapper.recorded(SimpleNamespace(**names)):
        text = f"{job.rule} {job.parameters} " + " ".join(Path(path).read_text() for path in job.inputs.values())
        for path in map(Path, job.outputs.values()):
            path.parent.mkdir(parents=True, exist_ok=True)
            if path.name == "more":
                path.mkdir()
                (path / "one.txt").write_text(f"one {text}")
                (path / "two.txt").write_text(f"two {text}")
            else:
                path.write_text(f"{path} {text}")


def carry_out(keeper: Keeper, out: Path, jobs: list[Job], monkeypatch: object) -> list[str]:
    """Do what Snakemake would; the rules of the jobs that ran."""
    monkeypatch.chdir(out)  # type: ignore[attr-defined]
    needed: Collection[int] = keeper.decide(Plan(jobs))
    for i in sorted(needed):
        work(jobs[i])
        keeper.finished(jobs[i])
    assert keeper.artifacts is not None
    write_manifest(out, keeper.artifacts, patience=0)
    return [jobs[i].rule for i in sorted(needed)]
