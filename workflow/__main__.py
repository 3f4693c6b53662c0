"""Run a study and look at what it made: `python -m workflow run --config config/config.yaml --out results`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from workflow.artifacts.cache_options import default_folder, default_limit, size_in_bytes
from workflow.artifacts.provenance import ROOT
from workflow.artifacts.store import Store
from workflow.plan.config import ConfigError
from workflow.plan.loading import load_study
from workflow.plan.out_folder import refuse_sources

WRONG = 2


def main() -> int:
    """Run the command line; the exit status is 0 (good), 1 (failed), 2 (not started) or 3 (folder in use)."""
    arguments = _parser().parse_args()
    try:
        return _command(arguments)
    except (ConfigError, ValueError, OSError) as error:
        sys.stderr.write(f"{error}\n")
        return WRONG


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m workflow", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    run = commands.add_parser("run", help="run what is new in a study")
    check = commands.add_parser("check", help="check a config and the files that it names, without running anything")
    verify = commands.add_parser("verify", help="hash every artifact of a finished study again")
    explain = commands.add_parser("explain", help="print what an artifact was made from, as a tree")
    info = commands.add_parser("cache-info", help="where the cache is, and how much it holds")
    clean = commands.add_parser("cache-clean", help="empty the cache, or make it smaller")
    for command in (run, check):
        command.add_argument("--config", type=Path, default=ROOT / "config" / "config.yaml")
    for command in (run, verify):
        command.add_argument("--out", type=Path, default=ROOT / "results", help="output folder")
    for command in (run, info, clean):
        command.add_argument("--cache", type=Path, help="folder of shared artifacts (default: $CACHE, or the user's)")
    run.add_argument("--cores", type=int, help="jobs at the same time; on Slurm, within one of its jobs")
    run.add_argument("--profile", default="default", help="default, slurm, or a folder with a Snakemake profile")
    run.add_argument("snakemake", nargs="*", help="further arguments for Snakemake, after --")
    explain.add_argument("path", type=Path, help="an artifact, for instance results/scores.csv")
    clean.add_argument("--to", default="0", metavar="GIB", help="what may stay, last used first")
    return parser


def _command(arguments: argparse.Namespace) -> int:
    match arguments.command:
        case "run":
            refuse_sources(arguments.out)
            load_study(arguments.config)  # finds mistakes before anything starts
            if arguments.cores is not None and arguments.cores < 1:
                raise ValueError(f"--cores {arguments.cores}: must be at least 1")
            from workflow.execution.runner import run

            how = arguments.cores, arguments.profile, arguments.snakemake
            return run(arguments.config, arguments.out, *how, _store(arguments))
        case "check":
            study = load_study(arguments.config)
            fits = sum(1 for name in study.experiments for _ in study.conditions(name))
            _print(f"{arguments.config}: {len(study.first_sets)} experiments, {fits} fits, no problem found")
        case "verify":
            from workflow.artifacts.manifest import verify

            count, problems = verify(arguments.out)
            _print(*problems, f"{arguments.out}: {count} artifacts, {len(problems) or 'no'} problems")
            return 1 if problems else 0
        case "explain":
            from workflow.artifacts.explain import explain, output_folder

            out = output_folder(arguments.path)
            _print(*explain(out, arguments.path.absolute().relative_to(out).as_posix()))
        case "cache-info":
            store = _store(arguments)
            sizes = [entry.size for entry in store.entries()]
            _print(f"{store.folder}: {len(sizes)} jobs, {_mib(sum(sizes))} of at most {_mib(store.limit)}")
        case "cache-clean":
            store = _store(arguments)
            count, freed = store.trim(size_in_bytes("--to", arguments.to, "0 to empty the cache"))
            _print(f"{store.folder}: {count} jobs removed, {_mib(freed)} freed")
    return 0


def _store(arguments: argparse.Namespace) -> Store:
    return Store((arguments.cache or default_folder()).absolute(), default_limit())


def _mib(size: int) -> str:
    return f"{size / 2**20:,.1f} MiB"


def _print(*lines: str) -> None:
    sys.stdout.writelines(f"{line}\n" for line in lines)


if __name__ == "__main__":
    sys.exit(main())
