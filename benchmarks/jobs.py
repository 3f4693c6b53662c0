"""Where the time of a study goes, from the logs of its jobs: `python -m benchmarks.jobs STUDY --out DIR`.

Writes jobs.csv and jobs.png: for each stage how many jobs ran, and the processor time of their processes, of which
start-up is what passed before a job looked at its inputs, and the memory of the largest one. The stage `workflow` are
the runs themselves: they lay jobs out, start them and keep what they made. Jobs count where they ran: not in a folder
that has their results from the cache, and still after their conditions have left the config.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from workflow.execution.job import time_of


def job_times(logs: Path) -> pd.DataFrame:
    """Seconds of each stage, the longest first: stage, jobs, start_up, work, processor, longest, wall, memory, share.

    Args:
        logs: The folder of the job logs; a folder in it, or a log, is a stage.
    """
    rows = [
        {"stage": path.relative_to(logs).with_suffix("").parts[0], **took}
        for path in sorted(logs.rglob("*.log"))
        if (took := time_of(path)) is not None
    ]
    jobs = pd.DataFrame(rows, columns=["stage", "start_up", "processor", "wall", "memory"])
    stages = jobs.groupby("stage").agg(
        jobs=("processor", "size"),
        start_up=("start_up", "sum"),
        processor=("processor", "sum"),
        longest=("processor", "max"),
        wall=("wall", "sum"),
        memory=("memory", "max"),
    )
    stages.insert(2, "work", stages["processor"] - stages["start_up"])
    stages["share"] = stages["processor"] / stages["processor"].sum()
    return stages.sort_values("processor", ascending=False).reset_index()


def draw_job_times(stages: pd.DataFrame, path: Path) -> None:
    """A bar a stage, the longest on top: start-up and work."""
    figure = Figure(figsize=(7.0, 0.9 + 0.28 * len(stages)), layout="constrained")
    axis = figure.subplots()
    labels = [f"{stage} ({jobs})" for stage, jobs in zip(stages["stage"], stages["jobs"], strict=True)]
    axis.barh(labels, stages["start_up"], color="tab:orange", label="start-up")
    bars = axis.barh(labels, stages["work"], left=stages["start_up"], color="tab:blue", label="work")
    axis.bar_label(bars, [f"{share:.0%}" for share in stages["share"]], padding=3, fontsize=8)
    axis.margins(x=0.1)
    axis.invert_yaxis()
    axis.set_xlabel(f"processor seconds, {stages['processor'].sum():.0f} in all")
    axis.set_ylabel("stage (number of jobs)")
    axis.legend(loc="lower right")
    figure.savefig(path, dpi=120)


def main() -> None:
    """Read, write, draw; a folder in which no job ran is named."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.jobs", description=__doc__.split("\n")[0])
    parser.add_argument("study", type=Path, help="output folder of a finished study")
    parser.add_argument("--out", type=Path, required=True, help="folder of the results")
    arguments = parser.parse_args()
    stages = job_times(arguments.study / "joblogs")
    if stages.empty:
        sys.stderr.write(f"{arguments.study}: no job has run here; run a study first to see where its time goes\n")
        for old in ("jobs.csv", "jobs.png"):
            (arguments.out / old).unlink(missing_ok=True)
        return
    arguments.out.mkdir(parents=True, exist_ok=True)
    stages.to_csv(arguments.out / "jobs.csv", index=False, float_format="%.4g")
    draw_job_times(stages, arguments.out / "jobs.png")
    sys.stderr.write(f"where the time of {arguments.study} went: {arguments.out / 'jobs.png'}\n")


if __name__ == "__main__":
    main()
