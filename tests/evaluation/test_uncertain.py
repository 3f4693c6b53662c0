"""Uncertain instructions: which are made, which objects fit them, and how the answers are measured."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.catalogue import Table
from evaluation.rendering import write
from evaluation.scores import write_csv
from evaluation.uncertain.answers import (
    MEASURES,
    answer_uncertain,
    entropy,
    measures_of,
    object_probabilities,
    read_uncertain,
)
from evaluation.uncertain.instructions import KINDS, Instruction, fitting, instructions
from evaluation.uncertain.scenes import OBJECT_CHANNELS, Scene
from evaluation.uncertain.table import sheet_of_answers, summarise_uncertain
from features.table import FeatureTable, head
from model import Fit
from model.prediction import Answer, understand
from tests.evaluation.conftest import fit_of
from tests.synthetic import WORDS

CHANNEL_OF = {word: channel for channel, own in WORDS.items() for word in own}
CONDITION = {
    "experiment": "own",
    "dataset": 1,
    "variant": "default",
    "method": "proposed",
    "sampler": "published",
    "D": 12,
    "ROW": 0,
    "seed": 1,
}
TABLE = Table("Uncertain", "own", ("uncertain",))


@pytest.fixture(scope="module")
def asked(table: FeatureTable) -> tuple[Instruction, ...]:
    return instructions(table, WORDS)


def of_kind(asked: tuple[Instruction, ...], kind: str) -> list[Instruction]:
    return [one for one in asked if one.kind == kind]


def scene_of(objects: list[tuple[str, str, str]], instructed: int | None = 0) -> Scene:
    """A scene of objects with these true words (position, object, color), all with the same features."""
    truth = dict(zip(OBJECT_CHANNELS, zip(*objects, strict=True), strict=True))
    M = len(objects)
    return Scene(1, {name: np.ones((M, 2)) for name in OBJECT_CHANNELS}, truth, instructed)


def test_every_kind_is_made_and_is_what_it_says(asked: tuple[Instruction, ...], table: FeatureTable) -> None:
    assert {one.kind for one in asked} == set(KINDS)
    D, vocabulary = len(table.trial), set(CHANNEL_OF)
    count = Counter(one.kind for one in asked)
    # Subsets of four words; one added word; a second word: 3 + 3 + 2 + 2 others in all, 3 + 2 + 2 of objects.
    assert [count[f"words_{n}"] for n in range(5)] == [D, 4 * D, 6 * D, 4 * D, D]
    assert (count["unknown_word"], count["repeated_word"]) == (D, 4 * D)
    assert (count["five_words"], count["repeated_channel"]) == (10 * D, 7 * D)
    said = {int(trial): set(words) for trial, words in zip(table.trial, table.words, strict=True)}
    for one in asked:
        new = set(one.words) - said[one.scene.trial]
        channels = Counter(CHANNEL_OF.get(word) for word in one.words)
        if one.kind.startswith("words_"):
            assert len(one.words) == int(one.kind[-1])
            assert not new
        if one.kind == "unknown_word":
            assert len(one.words) == 5
            assert not new & vocabulary
        if one.kind == "repeated_word":
            assert (len(one.words), len(set(one.words))) == (5, 4)
        if one.kind == "five_words":
            assert (len(one.words), len(new), max(channels.values())) == (5, 1, 2)
        if one.kind == "repeated_channel":
            assert (len(one.words), len(new), max(channels.values())) == (4, 1, 2)
            assert "action" not in channels
        if one.kind == "no_fit":
            assert (len(one.words), len(new), max(channels.values())) == (4, 1, 1)
            wrong = new.pop()
            assert wrong not in one.scene.truth[CHANNEL_OF[wrong]]


def test_two_alike_differ_in_nothing_but_the_place(asked: tuple[Instruction, ...], table: FeatureTable) -> None:
    made = of_kind(asked, "two_alike")
    assert made
    for one in made:
        scene, twin = one.scene, one.scene.instructed
        assert twin is not None
        for channel in ("object", "color"):
            assert np.array_equal(scene.features[channel][-1], scene.features[channel][twin])
            assert scene.truth[channel][-1] == scene.truth[channel][twin]
        # A place where nothing else is, as an object of the table has it.
        assert scene.truth["position"][-1] not in scene.truth["position"][:-1]
        assert table.truth_position is not None
        place = scene.features["position"][-1]
        rows = [i for i, p in enumerate(table.position) if np.array_equal(p, place)]
        assert [table.truth_position[i] for i in rows] == [scene.truth["position"][-1]]
        assert one.fits is not None
        assert one.fits[twin]
        assert one.fits[-1]
    for one in of_kind(asked, "two_alike_place"):
        assert one.fits is not None
        assert one.fits[-1] is False


def test_fitting_by_brute_force() -> None:
    """Of every scene of two objects and every sentence of two words: an object fits unless a word names another."""
    kinds = list(product(("front", "left"), ("cup", "box"), ("red", "blue")))
    words = ["reach", "front", "left", "cup", "box", "red", "blue", "blorp"]
    for objects in product(kinds, kinds):
        scene = scene_of(list(objects))
        for sentence in product(words, words):
            expected = []
            for one in objects:
                own = {"reach", "blorp", *one}
                expected.append(all(word in own for word in sentence))
            assert fitting(scene, sentence, CHANNEL_OF) == tuple(expected)


def test_what_fits_is_not_known_without_truth() -> None:
    truth = {"position": ("front", None), "object": ("cup", "box"), "color": (None, None)}
    scene = replace(scene_of([("front", "cup", "red")] * 2), truth=truth)
    assert fitting(scene, ["front"], CHANNEL_OF) is None
    assert fitting(scene, ["cup", "reach"], CHANNEL_OF) == (True, False)


@pytest.mark.parametrize("words", [(), ("cup",), ("front", "red", "cup", "reach"), ("red", "blue", "cup", "cup")])
@pytest.mark.parametrize("M", [1, 2, 5])
def test_equal_objects_have_the_entropy_of_their_number(
    proposed: Fit, table: FeatureTable, M: int, words: tuple[str, ...]
) -> None:
    features = {"position": table.position, "object": table.object_feature, "color": table.color}
    answer = understand(proposed, {name: np.tile(rows[:1], (M, 1)) for name, rows in features.items()}, words)
    assert entropy(object_probabilities(answer)) == pytest.approx(np.log(M), abs=1e-9)


def test_entropy_by_hand() -> None:
    assert entropy(np.array([0.5, 0.25, 0.25, 0.0])) == pytest.approx(1.5 * np.log(2))


def test_ties_are_scored_in_expectation() -> None:
    """Three of four objects are tied; one of two that fit is among them, and so is the instructed one."""
    scores = np.array([[0.0, -5.0], [0.0, -5.0], [-1.0, -5.0], [-5.0, 0.0]])
    scene = scene_of([("front", "cup", "red")] * 4, instructed=3)
    one = Instruction("five_words", scene, (), (False, False, True, True))
    measured = measures_of(Answer(scores, ()), one)
    assert measured["OAR_fit"] == pytest.approx(1 / 3)
    assert measured["outvoted"] == pytest.approx(1 / 3)
    assert (measured["chance_fit"], measured["chance_outvoted"]) == (0.5, 0.25)
    assert measured["ln_fitting"] == pytest.approx(np.log(2))
    p = np.exp(scores) / np.exp(scores).sum()
    assert measured["mass_fit"] == pytest.approx(p[2:].sum())


def test_measures_are_empty_where_they_are_not_defined() -> None:
    answer = Answer(np.zeros((2, 1)), ())
    scene = scene_of([("front", "cup", "red")] * 2)
    none_fits = measures_of(answer, Instruction("no_fit", scene, ("blue",), (False, False)))
    assert (none_fits["fitting"], none_fits["OAR_fit"], none_fits["ln_fitting"]) == (0, None, None)
    assert none_fits["outvoted"] == 0.5
    no_word_is_wrong = measures_of(answer, Instruction("words_1", scene, ("red",), (True, True)))
    assert (no_word_is_wrong["outvoted"], no_word_is_wrong["OAR_fit"]) == (None, 1.0)
    nobody_knows = measures_of(answer, Instruction("no_fit", replace(scene, instructed=None), ("red",), None))
    assert [nobody_knows[name] for name in ("fitting", "OAR_fit", "mass_fit", "outvoted")] == [None] * 4
    assert nobody_knows["entropy"] == pytest.approx(np.log(2))


@pytest.mark.parametrize("method", ["proposed", "no_mec2", "mmlda"])
def test_an_unknown_word_is_ignored_and_noted(
    table: FeatureTable, asked: tuple[Instruction, ...], tmp_path: Path, method: str
) -> None:
    rows = answer_uncertain(CONDITION | {"method": method}, fit_of(table, method), asked)
    write_csv(pd.DataFrame(rows), tmp_path / "own.csv")
    kept = read_uncertain([tmp_path / "own.csv"]).set_index("kind")
    assert len(kept) == len(asked)
    assert kept.loc["unknown_word", "ignored"].tolist() == ["blorp"] * len(table.trial)
    assert kept.drop("unknown_word")["ignored"].isna().all()
    same = ["entropy", "OAR_fit", "mass_fit"]
    assert np.allclose(kept.loc["unknown_word", same].to_numpy(float), kept.loc["words_4", same].to_numpy(float))
    write("t", sheet_of_answers(kept.reset_index(), TABLE), tmp_path)
    assert "left out: blorp." in (tmp_path / "t.md").read_text()


def test_a_word_that_the_experiment_has_is_not_unknown(table: FeatureTable) -> None:
    made = instructions(table, WORDS | {"color": [*WORDS["color"], "blorp"]})
    assert {one.words[-1] for one in of_kind(made, "unknown_word")} == {"blorp-blorp"}


def test_a_table_without_truth_leaves_the_measures_empty(proposed: Fit, table: FeatureTable, tmp_path: Path) -> None:
    blind = replace(
        head(table, 3), attended_object=np.full(3, -1), truth_position=None, truth_object=None, truth_color=None
    )
    asked = instructions(blind, WORDS)
    assert not {"no_fit", "two_alike", "two_alike_place"} & {one.kind for one in asked}
    write_csv(pd.DataFrame(answer_uncertain(CONDITION, proposed, asked)), tmp_path / "own.csv")
    answered = read_uncertain([tmp_path / "own.csv"])
    write("t", sheet_of_answers(answered, TABLE), tmp_path)
    assert "it is not known which objects fit" in (tmp_path / "t.md").read_text()
    summary = summarise_uncertain(answered).set_index("kind")
    # No word and action words fit any object, whatever it is.
    assert summary.loc["words_0", "OAR_fit_mean"] == 1.0
    assert np.isnan(summary.loc["words_4", "OAR_fit_mean"])
    assert summary["entropy_mean"].notna().all()


def test_the_table_holds_means_over_seeds_of_means_over_sentences(asked: tuple[Instruction, ...]) -> None:
    rows = [
        CONDITION
        | {"method": method, "seed": seed, "trial": trial, "kind": kind, "instruction": words, "ignored": None}
        | {"fitting": 1, "ln_fitting": 0.0, "chance_fit": 0.5, "chance_outvoted": None}
        | {"OAR_fit": value + (method == "mmlda"), "mass_fit": 0.5, "entropy": 0.1, "outvoted": None}
        for method in ("proposed", "mmlda")
        for kind, words in (("no_fit", "a"), ("words_1", "a"), ("words_1", "b"))
        for seed, by_trial in ((1, (0.0, 1.0)), (2, (1.0, 1.0)))
        for trial, value in enumerate(by_trial)
    ]
    summary = summarise_uncertain(pd.DataFrame(rows))
    assert summary["kind"].tolist() == ["words_1", "words_1", "no_fit", "no_fit"]
    assert summary["method"].tolist() == ["proposed", "mmlda"] * 2
    assert summary["sentences"].tolist() == [4, 4, 2, 2]
    assert summary["OAR_fit_mean"].tolist() == pytest.approx([0.75, 1.75, 0.75, 1.75])
    assert summary["OAR_fit_sd"].tolist() == pytest.approx([np.sqrt(0.125)] * 4)
    assert summary["OAR_fit_n"].tolist() == [2] * 4
    assert {f"{name}_mean" for name in MEASURES} <= set(summary.columns)
