"""Diagnostics: chains that agree, chains that do not, and fits that are no chains of one posterior."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from model import Blocked, Fit, Problem, Trials, fit
from model.diagnostics import chain_quantities, diagnose, rank_counts


@pytest.fixture
def fits(trials: Trials) -> list[Fit]:
    problem = Problem.of(trials, "no_mec2")
    return [fit(problem, Blocked(iterations=40), np.random.default_rng(s)) for s in range(4)]


def test_quantities_are_label_free(fits: list[Fit]) -> None:
    quantities = chain_quantities(fits, burn_in=0.25, pairs=4)
    assert quantities["log_joint"].shape == quantities["used_color"].shape == (4, 30)
    history = fits[2].history
    assert history is not None
    pairs = [name for name in quantities if name.startswith("same_action")]
    assert pairs
    i, j = (int(part) for part in pairs[0].split("_")[2:])
    assert quantities[pairs[0]][2].tolist() == (history.z[0][5:, i] == history.z[0][5:, j]).tolist()
    assert sum(quantities[f"frame_{c.name}"] for c in fits[0].trials.channels) == pytest.approx(np.ones((4, 15)))
    words = fits[2].trials.words[0]
    shares = [quantities[f"word_color_{word}"][2] for word in fits[2].trials.vocabulary]
    by_hand = [(history.F[5:, words == w] == 2).mean(axis=1) for w in range(len(shares))]
    assert fits[2].trials.channels[2].name == "color"
    assert np.array_equal(shares, by_hand)
    # New names for the categories change nothing.
    histories = [f.history for f in fits if f.history is not None]
    others = [replace(kept, z=tuple(9 - part for part in kept.z)) for kept in histories]
    renamed = [replace(f, history=other) for f, other in zip(fits, others, strict=True)]
    for name, values in chain_quantities(renamed, burn_in=0.25, pairs=4).items():
        assert np.array_equal(values, quantities[name])


def test_the_burn_in_is_the_samplers_unless_told(fits: list[Fit]) -> None:
    sampler = fits[0].sampler.model_copy(update={"burn_in": 0.75})
    shorter = chain_quantities([replace(f, sampler=sampler) for f in fits])
    for name, values in chain_quantities(fits, burn_in=0.75).items():
        assert np.array_equal(values, shorter[name])
    assert shorter["log_joint"].shape == (4, 10)
    assert chain_quantities(fits)["log_joint"].shape == (4, 20)


def test_without_history_there_are_the_traces(fits: list[Fit]) -> None:
    quantities = chain_quantities([replace(f, history=None) for f in fits])
    assert sorted(quantities) == ["log_joint", "used_action", "used_color", "used_position"]


def test_a_word_that_nobody_hears_and_a_method_without_frames_have_no_shares(trials: Trials) -> None:
    word = trials.words[0, 0]
    fewer = Problem.of(trials.keep_words(trials.words[0] != word), "no_mec2")
    names = list(chain_quantities([fit(fewer, Blocked(iterations=10), np.random.default_rng(0))]))
    assert sum(name.startswith("word_color_") for name in names) == len(trials.vocabulary) - 1
    assert f"word_color_{trials.vocabulary[word]}" not in names
    whole = fit(Problem.of(trials, "mmlda"), Blocked(iterations=10), np.random.default_rng(0))
    assert not any(name.startswith(("word_", "frame_")) for name in chain_quantities([whole]))


def test_figures_are_those_of_arviz() -> None:
    """Also of shares, which take few values, and of chains of an odd length."""
    arviz: Any = import_module("arviz")
    rng = np.random.default_rng(1)
    walks = rng.normal(size=(3, 201)).cumsum(axis=1) * 0.1
    for draws in (rng.normal(size=(4, 100)), walks, rng.integers(3, size=(2, 40)) / 2.0):
        (found,) = diagnose({"quantity": draws})
        assert found.r_hat == pytest.approx(float(arviz.rhat(draws, method="rank")))
        assert found.ess_bulk == pytest.approx(float(arviz.ess(draws, method="bulk")))
        assert found.ess_tail == pytest.approx(float(arviz.ess(draws, method="tail")))
        assert (found.mean, found.sd) == pytest.approx((draws.mean(), draws.std()))
        assert (found.chains, found.draws) == draws.shape


def test_chains_that_agree_and_chains_that_do_not() -> None:
    rng = np.random.default_rng(0)
    same = rng.normal(size=(4, 500))
    apart = same + np.arange(4)[:, None]
    constant = np.ones((4, 500))
    good, bad, unknown = diagnose({"same": same, "apart": apart, "constant": constant})
    assert good.r_hat == pytest.approx(1.0, abs=0.01)
    assert good.ess_bulk == pytest.approx(2000, rel=0.2)
    assert bad.r_hat is not None
    assert bad.r_hat > 1.3
    assert bad.ess_bulk is not None
    assert bad.ess_bulk < 50
    stuck = diagnose({"stuck": np.repeat([[1.0], [1.0], [2.0], [2.0]], 500, axis=1)})[0]
    assert stuck.r_hat == np.inf
    assert (unknown.mean, unknown.r_hat, unknown.ess_bulk, unknown.ess_tail) == (1.0, None, None, None)
    assert unknown.sd == 0
    alone = diagnose({"alone": same[:1]})[0]
    assert alone.r_hat is None
    assert alone.ess_bulk == pytest.approx(500, rel=0.2)


def test_rank_counts() -> None:
    rng = np.random.default_rng(0)
    same = rank_counts(rng.normal(size=(3, 400)), bins=10)
    assert same.sum(axis=1).tolist() == [400, 400, 400]
    assert np.abs(same - 40).max() < 30
    split = rank_counts(np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]]), bins=2)
    assert split.tolist() == [[4, 0], [0, 4]]
    assert rank_counts(np.ones((2, 5)), bins=4).sum() == 10


def test_fits_of_different_posteriors_are_refused(trials: Trials, fits: list[Fit]) -> None:
    other = trials.keep_words(np.arange(len(trials.word_trial)) > 0)
    stranger = fit(Problem.of(other, "mmlda"), Blocked(iterations=40), np.random.default_rng(0))
    with pytest.raises(ValueError, match=r"fit 5 is no other chain .* method, words"):
        chain_quantities([*fits, stranger])
    with pytest.raises(ValueError, match="kept iterations"):
        chain_quantities([fits[0], replace(fits[1], history=None)])
    with pytest.raises(ValueError, match="at least one fit"):
        chain_quantities([])
    with pytest.raises(ValueError, match="burn_in = 1"):
        chain_quantities(fits, burn_in=1)
