"""Confusion matrices: every pair is counted once, in the order of the words."""

from __future__ import annotations

import pandas as pd
import pytest

from evaluation.confusion import count_confusions, of_method
from evaluation.figures.confusion import confusion_figure
from evaluation.scores import SEEDS

WORDS = {"action": ["reach", "grasp"], "position": ["left"], "object": ["cup"], "color": ["red", "blue"]}
PAIRS = [("reach", "grasp"), ("reach", "grasp"), ("red", "red"), ("blue", "hello"), ("cup", "red")]


@pytest.fixture
def described() -> pd.DataFrame:
    condition: dict[str, object] = {"experiment": "own", "dataset": 1, "sampler": "published"}
    return pd.DataFrame(
        [
            condition
            | {
                "variant": variant,
                "method": method,
                "D": D,
                "ROW": ROW,
                "seed": seed,
                "true": true,
                "described": word,
            }
            for variant, method, D, ROW in (
                ("default", "proposed", 40, 0),
                ("default", "proposed", 20, 0),
                ("default", "proposed", 20, 40),
                ("few", "proposed", 20, 0),
                ("default", "mmlda", 20, 0),
            )
            for seed in (1, 2)
            for true, word in PAIRS[: 3 if method == "mmlda" else None]
        ]
    )


def test_counts_add_up_over_the_seeds(described: pd.DataFrame) -> None:
    counts = count_confusions(described, WORDS)
    assert list(counts.columns) == [*SEEDS, "true", "described", "count"]
    totals = counts.groupby(["variant", "method", "D", "ROW"])["count"].sum()
    assert totals.to_dict() == described.groupby(["variant", "method", "D", "ROW"]).size().to_dict()
    one = counts[(counts.method == "mmlda") & (counts["count"] > 0)]
    assert one[["true", "described", "count"]].to_numpy().tolist() == [["reach", "grasp", 4], ["red", "red", 2]]


def test_words_come_channel_after_channel_and_strangers_last(described: pd.DataFrame) -> None:
    counts = count_confusions(described, WORDS)
    order = ["reach", "grasp", "left", "cup", "red", "blue", "hello"]
    assert list(dict.fromkeys(counts["true"])) == list(dict.fromkeys(counts["described"])) == order
    assert len(counts) == 5 * len(order) ** 2


def test_a_figure_has_a_panel_for_each_condition(described: pd.DataFrame) -> None:
    figure = confusion_figure(of_method(count_confusions(described, WORDS), "proposed"), WORDS)
    panels = {axes.get_title(): axes for axes in figure.axes if axes.get_title()}
    # Columns are D, rows ROW; nothing is run at D = 40, ROW 40, and another variant is not mixed in.
    assert list(panels) == ["D = 20, ROW 0 %", "D = 40, ROW 0 %", "D = 20, ROW 40 %"]
    panel = panels["D = 20, ROW 0 %"]
    assert sorted(text.get_text() for text in panel.texts) == ["2", "2", "2", "4"]
    share = panel.images[0].get_array()
    assert share is not None
    assert (share[0, 1], share[5, 6], share[2].sum()) == (1.0, 1.0, 0.0)


def test_lines_part_the_channels(described: pd.DataFrame) -> None:
    figure = confusion_figure(of_method(count_confusions(described, WORDS), "mmlda"), WORDS)
    lines = figure.axes[0].lines
    assert sorted({float(line.get_ydata()[0]) for line in lines if list(line.get_xdata()) == [0, 1]}) == [  # type: ignore[index]
        1.5, 2.5, 3.5, 5.5,
    ]  # fmt: skip
