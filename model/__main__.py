"""Commands on fits: fit two feature tables without a study, and hand the chains of a condition to other programs.

`python -m model fit trials.parquet objects.parquet --to fit.npz`
`python -m model export seed1.npz seed2.npz … --to chains.nc`
"""

from __future__ import annotations

import argparse
import json
import logging
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from data_collection.console import run_command
from data_collection.processor import begin_pinned
from model.methods import METHODS
from model.prior import Prior
from model.samplers import SAMPLERS

WRONG = 2

_Settings = TypeVar("_Settings", bound=BaseModel)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 2 for files or settings of no use."""
    options = _parser().parse_args(arguments)
    try:
        return _fit(options) if options.command == "fit" else _export(options)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return WRONG


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m model", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    fit = commands.add_parser(
        "fit",
        help="fit two feature tables, without a study",
        epilog=f"settings of samplers: {_settings(SAMPLERS)}; of the prior: {_settings({'each channel': Prior})}",
    )
    fit.add_argument("trials", type=Path, metavar="TRIALS", help="Parquet file with a row per trial")
    fit.add_argument("objects", type=Path, metavar="OBJECTS", help="Parquet file with a row per object")
    fit.add_argument("--to", type=Path, required=True, metavar="FILE", help="the file to write, such as fit.npz")
    fit.add_argument("--method", choices=METHODS, default="proposed", help="(default: %(default)s)")
    fit.add_argument("--sampler", choices=SAMPLERS, default="mixing", help="its kind (default: %(default)s)")
    fit.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a setting of the sampler, such as iterations=100; once for each (default: those of its kind)",
    )
    fit.add_argument(
        "--prior",
        action="append",
        default=[],
        metavar="[CHANNEL.]NAME=VALUE",
        help="a hyperparameter, such as categories=5, or color.scale=0.02 of one channel; once for each (default: "
        "the paper's)",
    )
    fit.add_argument("--seed", type=int, default=1, help="of all draws, 0 or more (default: %(default)s)")
    export = commands.add_parser("export", help="write chains of one posterior as ArviZ InferenceData (netCDF)")
    export.add_argument("fits", nargs="+", type=Path, metavar="FIT", help="fits, one a chain")
    export.add_argument("--to", type=Path, required=True, metavar="FILE", help="the file to write, such as chains.nc")
    export.add_argument(
        "--burn-in",
        type=float,
        metavar="SHARE",
        help="share of the iterations left out at the start, 0 to below 1 (default: that of the sampler)",
    )
    return parser


def _fit(options: argparse.Namespace) -> int:
    """Fit two feature tables and write the fit."""
    if options.seed < 0:
        raise ValueError(f"--seed {options.seed}: must be 0 or more")
    sampler = _made(SAMPLERS[options.sampler], "--set ", _named("--set", options.set))
    hyperparameters = _named("--prior", options.prior)

    import numpy as np

    from features.table import import_table
    from model import Problem, Trials, fit, save

    logging.basicConfig(level=logging.INFO, format="%(message)s, a minute or two")  # that it compiles
    table = import_table(options.trials, options.objects, need_attention=True)
    trials = Trials.from_arrays(**table.learning_input())
    priors = _priors([channel.name for channel in trials.channels], hyperparameters)
    result = fit(Problem.of(trials, options.method, priors), sampler, np.random.default_rng(options.seed), _show)
    save(result, options.to)
    sys.stdout.write(f"{options.to}: {result!r}\n")
    return 0


def _export(options: argparse.Namespace) -> int:
    from model.exporting import export

    export(options.fits, options.to, options.burn_in)
    return 0


def _priors(channels: Sequence[str], hyperparameters: Mapping[str, Any]) -> list[Prior]:
    """The prior of each channel: what is said of all of them, and then what is said of it.

    Raises:
        ValueError: A channel is unknown, or a hyperparameter is of no use.
    """
    for name in hyperparameters:
        if "." in name and name.split(".")[0] not in channels:
            raise ValueError(f"--prior {name}: there is no such channel (there are {', '.join(channels)})")
    shared = {name: value for name, value in hyperparameters.items() if "." not in name}
    _made(Prior, "--prior ", shared)
    own = {
        channel: {
            name.removeprefix(f"{channel}."): value
            for name, value in hyperparameters.items()
            if name.startswith(f"{channel}.")
        }
        for channel in channels
    }
    for channel in channels:
        _made(Prior, f"--prior {channel}.", own[channel])
    return [Prior(**(shared | own[channel])) for channel in channels]


def _named(option: str, settings: Sequence[str]) -> dict[str, Any]:
    """Settings by name, their values read as JSON where they are, as text elsewhere.

    Raises:
        ValueError: One is not NAME=VALUE, or stands twice.
    """
    found: dict[str, Any] = {}
    for each in settings:
        name, equals, text = each.partition("=")
        if not name or not equals:
            raise ValueError(f"{option} {each}: must be NAME=VALUE")
        if name in found:
            raise ValueError(f"{option} {name}: stands twice")
        try:
            found[name] = json.loads(text)
        except ValueError:
            found[name] = text
    return found


def _made(kind: type[_Settings], where: str, settings: Mapping[str, Any]) -> _Settings:
    """Settings of a kind, or all that is wrong with them in words, each after where it was said.

    Raises:
        ValueError: They are of no use.
    """
    unknown = [name for name in settings if name not in kind.model_fields or name == "kind"]
    if unknown:
        raise ValueError(f"{where}{unknown[0]}: unknown (allowed: {_names(kind)})")
    try:
        return kind(**settings)
    except ValidationError as error:
        wrong = [(each["loc"][0] if each["loc"] else "", each["msg"]) for each in error.errors()]
        lines = [f"{where}{name}".rstrip(" .") + f": {why.removeprefix('Value error, ')}" for name, why in wrong]
        raise ValueError("\n".join(lines)) from None


def _names(kind: type[BaseModel]) -> str:
    return ", ".join(name for name in kind.model_fields if name != "kind")


def _settings(kinds: Mapping[str, type[BaseModel]]) -> str:
    return "; ".join(f"{name}: {_names(kind)}" for name, kind in kinds.items())


def _show(done: int, total: int) -> None:
    """Show the sweeps that are done, ten times, so that long fits look alive."""
    if done * 10 // total > (done - 1) * 10 // total:
        sys.stderr.write(f"{done} of {total} sweeps\n")


if __name__ == "__main__":
    begin_pinned()  # the same bytes on every processor
    sys.exit(run_command(main))
