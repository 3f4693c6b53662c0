"""Larger studies: their configs, and what they need.

`python -m benchmarks.scale config FILE --trials 10 --seeds 10` prints a config with ten times the trials and seeds.
`python -m benchmarks.scale needs STUDY --times 1000` prints a page: what each stage of a finished study took in time
and room, and what a study with so many times its jobs would take.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from benchmarks.jobs import job_times
from benchmarks.summary import markdown, processor
from workflow.artifacts.manifest import read_manifest
from workflow.plan.config import read_config
from workflow.plan.study_config import ExperimentConfig

CORES = (2, 100, 1000)
NUMBERS = ("D", "trials")  # the keys that say how many trials there are
RUN = "workflow"  # the stage of the run itself, which one process does
MORE_JOBS = ("collect", "perceive", "fit", "generate")  # a larger study has more of these; of all others longer ones
SAME_TIME = ("figures", "ratings", "calibrate", "report")  # what they show does not grow with trials and seeds
SAME_ROOM = ("figures", "report.html", "claims.html", "claims.csv", "claims_comparisons.csv")
_PAGE = """# What a study needs

Written by `python -m benchmarks.scale needs`. {processor}; seconds are processor time, and memory is the most that
one process held, libraries that it shares with others included.{elapsed}

“× {times:,}” is a study that simulates, looks at, fits and carries out so many times as much: so many times the jobs
of {more}. What sums them up are as many jobs as before, each in proportion longer; {same} show
a few conditions or fits whatever their number, and stay as they are.

## Time

{time}

The stage `{run}` is the run itself, which lays jobs out, starts them and keeps what they made: one process, whatever
the number of cores. What it takes is a lower bound, and so is the longest job. All stages but this one share the
cores. Here jobs were forks of one process; where each starts its own Python, as on a cluster, 1 to 3 s a job come on
top.

{wall}

## Room

What does not show each condition stays as large as it is.

{room}
"""


def larger(config: Mapping[str, Any], trials: int, seeds: int) -> dict[str, Any]:
    """The same study with so many times its trials (`NUMBERS`, wherever a config names them) and its seeds.

    Raises:
        ValueError: A factor is less than 1.
    """
    if trials < 1 or seeds < 1:
        raise ValueError(f"{trials} times the trials, {seeds} times the seeds: both must be at least 1")

    def grown(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: _times(inner, trials) if key in NUMBERS else grown(inner) for key, inner in value.items()}
        return value

    result: dict[str, Any] = grown(config)
    for own in result["experiments"].values():
        own["seeds"] = seeds * own.get("seeds", ExperimentConfig.model_fields["seeds"].default)
    return result


def needs(stages: pd.DataFrame, sizes: Mapping[str, int], times: int) -> str:
    """The page.

    Args:
        stages: Rows of `job_times`, one of them the run itself; what is not known of wall and memory may be missing.
        sizes: Bytes of the artifacts by folder.
        times: How many times as many jobs.
    """
    rows, shared, alone = [], {1: 0.0, times: 0.0}, {1: 0.0, times: 0.0}
    for row in stages.to_dict("records"):
        stage, jobs, seconds = row["stage"], row["jobs"], row["processor"]
        more = times * jobs if stage in MORE_JOBS else jobs
        longer = 1 if stage in SAME_TIME else times
        memory = row.get("memory", math.nan)
        known = "–" if math.isnan(memory) else f"{memory:,.0f}"
        row_now = [stage, f"{jobs:,}", f"{seconds / jobs:.3g}", known, _hours(seconds)]
        rows.append([*row_now, f"{more:,}", _hours(longer * seconds)])
        for n, (number, took) in {1: (jobs, seconds), times: (more, longer * seconds)}.items():
            shared[n] += 0.0 if stage == RUN else took
            alone[n] = max(alone[n], took / (1 if stage == RUN else number))
    wall = [[f"{cores:,}", *(_hours(max(shared[n] / cores, alone[n])) for n in (1, times))] for cores in CORES]
    after = {name: size if name in SAME_ROOM else times * size for name, size in sizes.items()}
    largest = sorted(sizes, key=lambda name: -sizes[name])
    room = [[name, _gib(sizes[name]), _gib(after[name])] for name in largest]
    room.append(["all", _gib(sum(sizes.values())), _gib(sum(after.values()))])
    run = stages[stages["stage"] == RUN]
    elapsed = run["wall"].sum() if "wall" in run else 0.0
    hours = "core-hours"
    head = ["stage", "jobs", "seconds a job", "memory, MiB", hours, f"jobs × {times:,}", f"{hours} × {times:,}"]
    return _PAGE.format(
        processor=processor(),
        times=times,
        more=", ".join(MORE_JOBS),
        same=", ".join(SAME_TIME),
        elapsed=f" From its start to its end this study took {_hours(elapsed)} hours." if elapsed else "",
        run=RUN,
        time=markdown(head, rows),
        wall=markdown(["cores", "hours, at least", f"hours × {times:,}, at least"], wall),
        room=markdown(["folder", "GiB", f"GiB × {times:,}"], room),
    )


def sizes_of(study: Path) -> dict[str, int]:
    """Bytes of the artifacts of a finished study by folder; those in none by name.

    Raises:
        ValueError: The study was not run to its end.
    """
    sizes: dict[str, int] = {}
    for path, record in read_manifest(study).items():
        folder = path.split("/")[0]
        sizes[folder] = sizes.get(folder, 0) + record.size
    return sizes


def main() -> int:
    """Read the command line and do what it says."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scale", description=__doc__.split("\n")[0])
    commands = parser.add_subparsers(dest="command", required=True)
    config = commands.add_parser("config", help="print a config with more trials and seeds")
    config.add_argument("file", type=Path, help="the config to start from")
    config.add_argument("--trials", type=int, default=10, help="how many times its trials (default 10)")
    config.add_argument("--seeds", type=int, default=10, help="how many times its seeds (default 10)")
    told = commands.add_parser("needs", help="what a study took, and what a larger one would take")
    told.add_argument("study", type=Path, help="output folder of a finished study")
    told.add_argument("--times", type=int, default=1000, help="how many times its jobs (default 1000)")
    arguments = parser.parse_args()
    try:
        if arguments.command == "config":
            grown = larger(read_config(arguments.file), arguments.trials, arguments.seeds)
            text = yaml.safe_dump(grown, sort_keys=False, default_flow_style=None, allow_unicode=True)
        else:
            sizes = sizes_of(arguments.study)
            stages = job_times(arguments.study / "joblogs")
            if stages.empty:
                raise ValueError(f"{arguments.study}: no job has run here, so that no time is known")
            text = needs(stages, sizes, arguments.times)
    except ValueError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    sys.stdout.write(text)
    return 0


def _times(value: Any, times: int) -> Any:
    if isinstance(value, str):  # the name of a file
        return value
    return [times * each for each in value] if isinstance(value, Sequence) else times * value


def _hours(seconds: float) -> str:
    return f"{seconds / 3600:,.3g}" if seconds < 3.6e6 else f"{seconds / 3600:,.0f}"


def _gib(size: float) -> str:
    return f"{size / 2**30:,.2g}" if size < 100 * 2**30 else f"{size / 2**30:,.0f}"


if __name__ == "__main__":
    sys.exit(main())
