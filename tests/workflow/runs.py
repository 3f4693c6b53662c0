"""Run studies as users do, and look at what came out."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from workflow.artifacts.provenance import ROOT

SMOKE = ROOT / "config" / "smoke.yaml"
ARTIFACTS = (".mcap", ".parquet", ".npz", ".csv", ".md", ".tex", ".html", ".png", ".pdf", ".gif")


def copy_project(folder: Path) -> Path:
    """A copy, in an empty folder, of what a study needs of the project: one that a test may change."""
    for name in ("data_collection", "features", "model", "evaluation", "workflow", "config"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("Snakefile", "environment.lock", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    return folder


def command(
    config: Path, out: Path, *more: str, cache: Path | None = None, options: tuple[str, ...] = ()
) -> list[str]:
    """The command line that the Makefile uses, with a cache for this output folder alone unless one is named."""
    base = [sys.executable, "-m", "workflow", "run", "--config", str(config), "--out", str(out), "--cores", "2"]
    return [*base, *("--cache", str(cache or f"{out}.cache")), *options, *(["--", *more] if more else [])]


def forget(out: Path) -> None:
    """Remove Snakemake's logs of earlier runs, so that `jobs` counts those of the next one."""
    shutil.rmtree(out / ".snakemake" / "log", ignore_errors=True)


def run(
    config: Path,
    out: Path,
    *more: str,
    succeeds: bool = True,
    cache: Path | None = None,
    root: Path = ROOT,
    options: tuple[str, ...] = (),
) -> str:
    """Run a study, of the clone at `root`, and return what it printed."""
    line = command(config, out, *more, cache=cache, options=options)
    forget(out)
    done = subprocess.run(line, cwd=root, capture_output=True, text=True, check=False)
    printed = done.stdout + done.stderr
    assert (done.returncode == 0) is succeeds, printed
    return printed


def start(
    config: Path,
    out: Path,
    *more: str,
    cache: Path | None = None,
    root: Path = ROOT,
    output: int = subprocess.PIPE,
) -> subprocess.Popen[str]:
    """Start a study, of the clone at `root`, in a process group of its own."""
    line = command(config, out, *more, cache=cache)
    forget(out)
    return subprocess.Popen(
        line, cwd=root, stdout=output, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )


def wait_until(true: Callable[[], bool], process: subprocess.Popen[str], patience: float = 300.0) -> None:
    """Wait until something is true of what a running study does, looking often."""
    until = time.monotonic() + patience
    while not true():
        assert process.poll() is None, "the study ended before that"
        assert time.monotonic() < until, f"not true within {patience} s"
        time.sleep(0.01)


def jobs(out: Path) -> Counter[str]:
    """How many jobs of each rule finished in a folder since `forget`, by Snakemake's own logs."""
    texts = [log.read_text(encoding="utf-8") for log in (out / ".snakemake" / "log").glob("*")]
    return Counter(re.findall(r"Finished jobid: \d+ \(Rule: ([\w.]+)\)", "".join(texts)))


def hashes(out: Path) -> dict[str, str]:
    """sha256 of every artifact below a folder."""
    return {
        path.relative_to(out).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(out.rglob("*"))
        if path.suffix in ARTIFACTS and ".snakemake" not in path.parts and not path.name.startswith(".")
    }
