"""Run a notebook where there is no Jupyter, and save its figures: `.venv/bin/python docs/run_notebook.py FOLDER`."""

from __future__ import annotations

import argparse
import ast
import json
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")  # pictures, not windows
import matplotlib.pyplot as plt

NOTEBOOK = Path(__file__).with_name("example.ipynb")


def run_cell(source: str, names: dict[str, Any]) -> None:
    """Run the code of a cell, and print what its last line gives, as Jupyter does, unless a semicolon ends it."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, str(NOTEBOOK), "exec"), names)
    if isinstance(last, ast.Expr):
        value = eval(compile(ast.Expression(last.value), str(NOTEBOOK), "eval"), names)
        if value is not None and not source.rstrip().endswith(";"):
            print(value)  # noqa: T201


def main() -> None:
    """Run the cells in order, and save each figure when its cell is done."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the figures go")
    parser.add_argument("--notebook", type=Path, default=NOTEBOOK, help="another notebook (default: %(default)s)")
    options = parser.parse_args()
    names: dict[str, Any] = {"__name__": "__main__"}
    saved = 0
    for cell in json.loads(options.notebook.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            run_cell("".join(cell["source"]), names)
        for number in plt.get_fignums():
            saved += 1
            options.folder.mkdir(parents=True, exist_ok=True)
            plt.figure(number).savefig(options.folder / f"{saved}.png")
            plt.close(number)
    print(f"{saved} figures in {options.folder}")  # noqa: T201


if __name__ == "__main__":
    main()
