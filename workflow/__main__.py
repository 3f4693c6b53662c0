"""Run a study: `python -m workflow run --config config/config.yaml --out results`."""

from __future__ import annotations

import argparse
import fcntl
import os
import sys
from pathlib import Path

from workflow.config import ConfigError
from workflow.plan import load_study

ROOT = Path(__file__).resolve().parent.parent


def main() -> int:
    """Check the config, make sure that nobody else runs in the output folder, and hand over to Snakemake."""
    parser = argparse.ArgumentParser(prog="python -m workflow", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    run = commands.add_parser("run", help="run what is new of a study")
    check = commands.add_parser("check", help="check a config, and the files that it names, without running it")
    for command in (run, check):
        command.add_argument("--config", type=Path, default=ROOT / "config" / "config.yaml")
    run.add_argument("--out", type=Path, default=ROOT / "results", help="output folder")
    run.add_argument("--cores", type=int, default=os.cpu_count() or 1)
    run.add_argument("snakemake", nargs="*", help="further arguments for Snakemake, after --")
    arguments = parser.parse_args()
    try:
        study = load_study(arguments.config)
    except ConfigError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    if arguments.command == "check":
        fits = sum(1 for name in study.experiments for _ in study.conditions(name))
        sys.stdout.write(f"{arguments.config}: {len(study.experiments)} experiments, {fits} fits, no problem found\n")
        return 0
    return _run(arguments.config, arguments.out, arguments.cores, arguments.snakemake)


def _run(config: Path, out: Path, cores: int, more: list[str]) -> int:  # noqa: RET503 (becomes Snakemake)
    if cores < 1:
        sys.stderr.write(f"--cores {cores}: must be at least 1\n")
        return 2
    out.mkdir(parents=True, exist_ok=True)
    if not _hold(out / ".running"):
        sys.stderr.write(f"{out}: another study is running in this folder; wait for it, or choose another --out\n")
        return 3
    # Whatever a killed run was about to write carries a temporary name. Its last jobs may still live: without
    # their temporary files they fail, rather than write beside the new ones.
    for part in out.rglob(".*.part"):
        part.unlink(missing_ok=True)
    command = [
        *(sys.executable, "-m", "snakemake"),
        *("--snakefile", str(ROOT / "Snakefile")),
        *("--workflow-profile", str(ROOT / "workflow" / "profiles" / "default")),
        *("--configfile", str(config.resolve())),
        *("--directory", str(out.resolve())),
        *("--cores", str(cores)),
        "--nolock",  # the file held above does it, and lets go when this process dies, however it dies
        *more,
    ]
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    os.execv(sys.executable, command)  # never returns


def _hold(path: Path) -> bool:
    """Lock a file for as long as this process, or the one that it becomes, lives."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    os.set_inheritable(descriptor, True)
    return True


if __name__ == "__main__":
    sys.exit(main())
