"""The command line of benchmarks on feature files, which come in pairs: trials and objects."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from features.table import FeatureTable, read_table


def parser_of(module: str, doc: str | None) -> argparse.ArgumentParser:
    """A parser with what all of them take.

    Args:
        module: The benchmark's name.
        doc: Its docstring, of which the first line is shown.
    """
    parser = argparse.ArgumentParser(prog=f"python -m {module}", description=(doc or "").split("\n")[0])
    parser.add_argument("files", type=Path, nargs="+", help="trials and objects, in turn")
    parser.add_argument("--out", type=Path, required=True, help="folder of the results")
    return parser


def read_pairs(parser: argparse.ArgumentParser, files: Sequence[Path]) -> list[FeatureTable]:
    """The tables of pairs of files; an odd number of files ends the program."""
    if len(files) % 2:
        parser.error("feature files come in pairs: trials and objects")
    return [read_table(*pair, need_attention=True) for pair in zip(files[::2], files[1::2], strict=True)]
