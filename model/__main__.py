"""Commands on fits: hand the chains of a condition to other programs.

`python -m model export seed1.npz seed2.npz … --to chains.nc`
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 2 for files of no use."""
    parser = argparse.ArgumentParser(prog="python -m model", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    export = commands.add_parser("export", help="write chains of one posterior as ArviZ InferenceData (netCDF)")
    export.add_argument("fits", nargs="+", type=Path, metavar="FIT", help="fits, one a chain")
    export.add_argument("--to", type=Path, required=True, metavar="FILE", help="the file to write, such as chains.nc")
    export.add_argument(
        "--burn-in",
        type=float,
        metavar="SHARE",
        help="share of the iterations left out at the start, 0 to below 1 (default: that of the sampler)",
    )
    options = parser.parse_args(arguments)
    try:
        from model.exporting import export as write

        write(options.fits, options.to, options.burn_in)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
