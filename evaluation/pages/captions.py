"""What the file of a figure shows, by its name."""

from __future__ import annotations

from collections.abc import Collection

from evaluation.catalogue import Figure, figure_of


def titled(stem: str, experiments: Collection[str]) -> tuple[str, Figure]:
    """The title of a figure, and its entry in the catalogue, an empty one where it has none.

    Args:
        stem: the file's name without its ending: the experiment's, `_`, the figure's. Both may hold `_` themselves.
        experiments: the names of the experiments.
    """
    pairs = [(name, stem.removeprefix(f"{name}_")) for name in experiments if stem.startswith(f"{name}_")]
    known = [pair for pair in pairs if figure_of(pair[1])]
    experiment, figure = (known or sorted(pairs, reverse=True) or [("", stem)])[0]
    words = figure.replace("_", " ")
    title = ", ".join(filter(None, (words[:1].upper() + words[1:], experiment)))
    return title, figure_of(figure) or Figure(None, "")


def caption(figure: Figure) -> str:
    """What a figure shows, and what the paper calls it."""
    if figure.number is None:
        return figure.caption
    plural = "s" if " and " in figure.number else ""
    return f"{figure.caption} In the paper: Figure{plural} {figure.number}."
