"""The commands of `python -m workflow`: run a study, and look at what it made."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from data_collection.console import counted
from workflow.artifacts.cache_options import default_folder, default_limit, size_in_bytes
from workflow.artifacts.provenance import ROOT
from workflow.artifacts.store import Store
from workflow.execution.progress import working_at
from workflow.plan.config import ConfigError
from workflow.plan.loading import load_study
from workflow.plan.out_folder import refuse_sources
from workflow.plan.study import Study

WRONG = 2
SECONDS_OF_SILENCE = 5.0


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; the exit status is 0 (good), 1 (failed or stopped), 2 (not started) or 3 (folder in use)."""
    options = _parser().parse_args(arguments)
    try:
        return _command(options)
    except BrokenPipeError:
        raise  # nobody reads what is printed
    except OSError as error:
        sys.stderr.write(f"{error.filename}: {error.strerror}\n" if error.filename else f"{error}\n")
        return WRONG
    except (ConfigError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return WRONG


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m workflow",
        description="Run a study and look at what it made: run --config config/config.yaml --out results",
    )
    commands = parser.add_subparsers(required=True, dest="command")
    run = commands.add_parser("run", help="run what is new in a study")
    check = commands.add_parser("check", help="check a config and the files that it names, without running anything")
    verify = commands.add_parser("verify", help="hash every artifact of a finished study again")
    explain = commands.add_parser("explain", help="print what an artifact was made from, as a tree")
    info = commands.add_parser("cache-info", help="where the cache is, and how much it holds")
    clean = commands.add_parser("cache-clean", help="empty the cache, or make it smaller")
    for command in (run, check):
        command.add_argument(
            "--config", type=Path, default=ROOT / "config" / "config.yaml", help="config file (default: %(default)s)"
        )
    for command in (run, verify):
        command.add_argument(
            "--out", type=Path, default=ROOT / "results", help="output folder (default: %(default)s)"
        )
    for command in (run, info, clean):
        command.add_argument(
            "--cache",
            type=Path,
            help=f"folder of shared artifacts (default: $CACHE, or {default_folder() or 'none'})",
        )
    run.add_argument(
        "--cores",
        type=int,
        help="jobs at the same time; on Slurm, within one of its jobs (default: the profile's, which is all here)",
    )
    run.add_argument(
        "--profile",
        default="default",
        help="default, slurm, or a folder with a Snakemake profile (default: %(default)s)",
    )
    run.add_argument(
        "--until-decided",
        type=int,
        metavar="N",
        help="simulate further data sets until every claim of the paper is decided, or an experiment has N "
        "(default: those of the config)",
    )
    run.add_argument("snakemake", nargs="*", help="further arguments for Snakemake, after -- (default: none)")
    explain.add_argument("path", type=Path, help="an artifact, for instance results/scores.csv")
    clean.add_argument(
        "--to", default="0", metavar="GIB", help="what may stay, last used first (default: %(default)s)"
    )
    return parser


def _command(arguments: argparse.Namespace) -> int:
    match arguments.command:
        case "run":
            if arguments.cores is not None and arguments.cores < 1:
                raise ValueError(f"--cores {arguments.cores}: must be at least 1")
            refuse_sources(arguments.out)
            store = _store(arguments)
            _checked(arguments.config)
            if arguments.until_decided is not None:
                return _run_until_decided(arguments)
            from workflow.execution.runner import run

            how = arguments.cores, arguments.profile, arguments.snakemake
            return run(arguments.config, arguments.out, *how, store)
        case "check":
            study = _checked(arguments.config)
            fits = sum(1 for name in study.experiments for _ in study.conditions(name))
            experiments = counted(len(study.first_sets), "experiment")
            _print(f"{arguments.config}: {experiments}, {counted(fits, 'fit')}, no problem found")
        case "verify":
            from workflow.artifacts.manifest import verify

            with working_at("hashing every artifact again"):
                count, problems = verify(arguments.out)
            found = f"{counted(count, 'artifact')}, {counted(len(problems), 'problem')}"
            _print(*problems, f"{arguments.out}: {found}")
            return 1 if problems else 0
        case "explain":
            from workflow.artifacts.explain import explain, output_folder

            out = output_folder(arguments.path)
            _print(*explain(out, arguments.path.absolute().relative_to(out).as_posix()))
        case "cache-info":
            store = _store(arguments)
            sizes = [entry.size for entry in store.entries()]
            _print(f"{store.folder}: {counted(len(sizes), 'job')}, {_mib(sum(sizes))} of at most {_mib(store.limit)}")
        case "cache-clean":
            store = _store(arguments)
            count, freed = store.trim(size_in_bytes("--to", arguments.to, "0 to empty the cache"))
            _print(f"{store.folder}: {counted(count, 'job')} removed, {_mib(freed)} freed")
    return 0


def _checked(config: Path) -> Study:
    """The study of a config; mistakes in it, and in the files that it names, are found before anything starts."""
    with working_at("checking the config, and the files that it names"):
        study = load_study(config)
    _load_weights(config, study)
    _open_logs(config, study)
    return study


def _run_until_decided(arguments: argparse.Namespace) -> int:
    """Run a study with more and more data sets, each round in a process of its own.

    Raises:
        ValueError: There are further arguments for Snakemake, which could keep the claims from being made.
    """
    from workflow.execution.until_decided import run_until_decided

    if arguments.snakemake:
        raise ValueError(
            f"--until-decided: takes no further arguments for Snakemake ({' '.join(arguments.snakemake)})"
        )
    own = Path(arguments.profile)
    options = ["--out", str(arguments.out.absolute())]
    options += ["--profile", str(own.absolute()) if own.is_dir() else arguments.profile]
    options += ["--cores", str(arguments.cores)] if arguments.cores is not None else []
    options += ["--cache", str(arguments.cache.absolute())] if arguments.cache is not None else []

    def run_round(config: Path, targets: Sequence[str]) -> int:
        line = [sys.executable, "-m", "workflow", "run", "--config", str(config), *options]
        return subprocess.run([*line, *(["--", *targets] if targets else [])], cwd=ROOT, check=False).returncode

    return run_until_decided(arguments.config, arguments.out, arguments.until_decided, run_round)


def _load_weights(config: Path, study: Study) -> None:
    """Load the files of weights that a config names, as feature extraction will.

    Raises:
        ConfigError: With everything for which it would refuse them.
    """
    files = {name: study.weights_file(name) for name in study.first_sets}
    problems = []
    for name, path in files.items():
        if path is not None and study.experiments[name].source != "features":
            from features.object_feature import weights_problem  # imports PyTorch

            if problem := weights_problem(str(path)):
                problems.append(f"experiments.{name}.feature_extraction.weights: {problem}")
    if problems:
        raise ConfigError(str(config), problems)


def _open_logs(config: Path, study: Study) -> None:
    """Look into the logs that a config names.

    Raises:
        ConfigError: With everything for which a run would refuse them.
    """
    if all(experiment.source != "logs" for experiment in study.experiments.values()):
        return
    from workflow.artifacts.provenance import code_hash
    from workflow.artifacts.remembered import recall, remember
    from workflow.plan.log_checks import log_problems, unread_logs

    folder = default_folder()
    memory_file = folder / "checked_logs.json" if folder and default_limit() else None
    known = recall(memory_file) if memory_file else {}
    before = len(known)
    try:
        problems = list(log_problems(study, known, code_hash(ROOT / "features" / "log_check.py"), _progress()))
    finally:
        if memory_file and len(known) > before:
            remember(memory_file, known)
    if problems:
        raise ConfigError(str(config), problems)
    _print(*(f"note: {line}" for line in unread_logs(study)))


def _progress() -> Callable[[int, int], None]:
    """A function that says every few seconds how many logs have been opened."""
    last = time.monotonic()

    def tell(done: int, total: int) -> None:
        nonlocal last
        if time.monotonic() - last > SECONDS_OF_SILENCE:
            last = time.monotonic()
            sys.stderr.write(f"{done} of {total} logs opened\n")

    return tell


def _store(arguments: argparse.Namespace) -> Store:
    folder = arguments.cache or default_folder()
    if folder is None:
        sys.stderr.write("there is no home folder, and so no cache: CACHE or --cache names a folder for one\n")
        return Store(Path(os.devnull), 0)
    return Store(folder.absolute(), default_limit())


def _mib(size: int) -> str:
    return f"{size / 2**20:,.1f} MiB"


def _print(*lines: str) -> None:
    sys.stdout.writelines(f"{line}\n" for line in lines)
