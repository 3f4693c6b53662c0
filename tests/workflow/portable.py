"""What hangs on the kernels that libraries choose: `python -m tests.workflow.portable --out DIR` (`make portable`).

Runs the smoke study, and the trials of both experiments of the study up to their features, again and again: as they
are, as on other processors (`FOREIGN`, set where the run starts), and without each of the pins of
`data_collection.processor`. The first must give the same bytes; the others tell what a pin is there for. With
`--scores` it is Table 1 and the tasks of both experiments, by the published sampler, on each of `PROCESSORS`.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

import pandas as pd
import yaml

from data_collection.processor import pinned
from tests.workflow.runs import SMOKE, hashes
from workflow.artifacts.provenance import ROOT

STUDY = ROOT / "config" / "config.yaml"
FEATURES = [f"features/{data}/train_trials.parquet" for data in ("simulator/D40", "real/D40")]

FOREIGN: dict[str, dict[str, str]] = {
    "OpenBLAS of another processor": {"OPENBLAS_CORETYPE": "SANDYBRIDGE"},
    "PyTorch of another processor": {"ATEN_CPU_CAPABILITY": "avx2", "ONEDNN_MAX_CPU_ISA": "AVX2", "MKL_CBWR": "AVX2"},
    "glibc of another processor": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"},
    "NumPy of another processor": {"NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL AVX512_SPR"},
    "OpenCV of another processor": {"OPENCV_CPU_DISABLE": "AVX512-SKX", "OPENCV_IPP": "sse42"},
}
"""Variables that make libraries choose as they would elsewhere; of those that a run starts with no job sees any."""
ALL_FOREIGN = {name: value for row in FOREIGN.values() for name, value in row.items()}
PROCESSORS = {
    "AVX2, no AVX-512": ALL_FOREIGN,
    "neither AVX2 nor FMA": {
        "OPENBLAS_CORETYPE": "SANDYBRIDGE",
        "ATEN_CPU_CAPABILITY": "default",
        "ONEDNN_MAX_CPU_ISA": "SSE41",
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable",
        "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4",
        "NUMBA_CPU_NAME": "nehalem",
        "OPENCV_CPU_DISABLE": "AVX2,AVX512-SKX",
    },
}
"""Whole processors, as far as variables tell libraries of them; Numba compiles for the second one."""
PINS = {
    "OpenBLAS": ("OPENBLAS_CORETYPE",),
    "PyTorch": ("ATEN_CPU_CAPABILITY", "ONEDNN_MAX_CPU_ISA", "MKL_CBWR"),
    "glibc": ("GLIBC_TUNABLES",),
    "NumPy": ("NPY_DISABLE_CPU_FEATURES",),
    "OpenCV": ("OPENCV_CPU_DISABLE", "OPENCV_IPP", "OPENCV_OPENCL_RUNTIME", "OPENCV_LOG_LEVEL"),
    "Arrow": ("ARROW_USER_SIMD_LEVEL",),
}
"""What each library is told; all pins but those of threads."""


def study(
    config: Path, out: Path, *targets: str, foreign: Mapping[str, str] | None = None, without: tuple[str, ...] = ()
) -> dict[str, str]:
    """Run a study, or what some targets need, without a cache; the hashes of its artifacts.

    Args:
        config: The study.
        out: An empty folder.
        targets: Artifacts; none for all.
        foreign: Variables of the environment that it starts in.
        without: Pins that are left out.
    """
    line = [sys.executable, "-m", "tests.workflow.portable", "--without", ",".join(without), "run"]
    line += ["--config", str(config), "--out", str(out), "--cache", f"{out}.cache"]
    line += ["--", *targets] if targets else []
    # A process that has read the Snakefile is pinned itself; what it starts would be, whatever is left out here.
    own = {name: value for name, value in os.environ.items() if name not in pinned({})}
    environment = {**own, "PYTHONPATH": str(ROOT), **(foreign or {})}
    subprocess.run(line, cwd=ROOT, env=environment, check=True, capture_output=True)
    return hashes(out)


def different(one: Mapping[str, str], other: Mapping[str, str]) -> Counter[str]:
    """How many artifacts of each folder differ, or are in one run only."""
    names = [name for name in one.keys() | other.keys() if one.get(name) != other.get(name)]
    return Counter(name.partition("/")[0] for name in names)


def rows(out: Path) -> Iterator[str]:
    """The rows of a table: what was changed, and how many artifacts of which kinds differ."""
    cases: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {"as on other processors, all": (ALL_FOREIGN, ())}
    cases |= {name: (variables, ()) for name, variables in FOREIGN.items()}
    cases |= {f"without the pins of {name}": ({}, pins) for name, pins in PINS.items()}
    plain = {"smoke": study(SMOKE, out / "smoke"), "features": study(STUDY, out / "features", *FEATURES)}
    yield f"| the run | artifacts that differ, of {sum(map(len, plain.values()))} | kinds |\n| --- | --- | --- |\n"
    for number, (name, (foreign, without)) in enumerate(cases.items()):
        found = study(SMOKE, out / f"smoke{number}", foreign=foreign, without=without)
        counts = different(plain["smoke"], found)
        found = study(STUDY, out / f"features{number}", *FEATURES, foreign=foreign, without=without)
        counts += different(plain["features"], found)
        kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(counts.items()))
        yield f"| {name} | {counts.total()} | {kinds} |\n"


def published_alone(config: Path) -> str:
    """A study as YAML with the published sampler only, without what is fitted or drawn for other samplers."""
    plan = yaml.safe_load(config.read_text(encoding="utf-8"))
    plan["samplers"] = {"published": plan["samplers"]["published"]}
    for experiment in plan["experiments"].values():
        for name in ("variants", "figure"):
            experiment.pop(name, None)
        experiment.get("generation", {}).pop("samplers", None)
    return str(yaml.safe_dump(plan, sort_keys=False))


def different_cells(one: Path, other: Path) -> int:
    """How many cells of two CSV files differ, as they are written; rows or columns that one lacks count whole."""
    tables = [pd.read_csv(path, dtype=str, keep_default_na=False) for path in (one, other)]
    left, right = tables[0].align(tables[1])
    return int((left.ne(right) | left.isna() | right.isna()).to_numpy().sum())


def score_rows(out: Path) -> Iterator[str]:
    """The rows of a table: on which processor, how many cells of scores.csv and how many artifacts differ."""
    config = out / "published.yaml"
    config.write_text(published_alone(STUDY), encoding="utf-8")
    plain = study(config, out / "scores", "scores.csv")
    cells = pd.read_csv(out / "scores" / "scores.csv", dtype=str).size
    yield f"| the run | cells of scores.csv that differ, of {cells} | artifacts that differ, of {len(plain)} |\n"
    yield "| --- | --- | --- |\n"
    cases: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {
        name: (variables, ()) for name, variables in PROCESSORS.items()
    }
    cases["without any pin"] = ({}, tuple(name for pins in PINS.values() for name in pins))
    for number, (name, (foreign, without)) in enumerate(cases.items()):
        folder = out / f"scores{number}"
        counts = different(plain, study(config, folder, "scores.csv", foreign=foreign, without=without))
        kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(counts.items()))
        found = different_cells(out / "scores" / "scores.csv", folder / "scores.csv")
        yield f"| {name} | {found} | {counts.total()} {kinds} |\n"


def run_without(pins: list[str], arguments: list[str]) -> int:
    """Run `python -m workflow` without some of the pins."""
    from data_collection import processor
    from workflow.__main__ import main

    whole = processor.pinned
    processor.pinned = lambda environment: {k: v for k, v in whole(environment).items() if k not in pins}
    sys.argv[1:] = arguments
    return main()


if __name__ == "__main__":
    if sys.argv[1] == "--without":
        sys.exit(run_without(sys.argv[2].split(","), sys.argv[3:]))
    parser = argparse.ArgumentParser(prog="python -m tests.workflow.portable", description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=Path, required=True, help="an empty folder, for some 2 GB")
    parser.add_argument("--scores", action="store_true", help="scores of both experiments instead of all libraries")
    arguments = parser.parse_args()
    for text in (score_rows if arguments.scores else rows)(arguments.out.absolute()):
        sys.stdout.write(text)
        sys.stdout.flush()
