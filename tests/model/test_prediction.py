"""Instructions and descriptions against direct sums over every category and frame."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest
from scipy.special import logsumexp

from model import Blocked, Fit, Prior, Problem, Trials, fit, load, save
from model.data import Floats, Ints
from model.distributions.gaussian_densities import gaussian_log_density
from model.frame_paths import orders_of
from model.open_frames import Once
from model.prediction import Answer, describe, responsibilities, spoken_order, understand


@pytest.fixture
def learned(method: str, trials: Trials) -> Fit:
    """A fit of three channels: action, position, color."""
    priors = [Prior(categories=K, mean_precision=0.5, scale=0.5) for K in (3, 2, 4)]
    return fit(Problem.of(trials, method, priors), Blocked(iterations=10), np.random.default_rng(3))


@pytest.fixture
def scene() -> dict[str, Floats]:
    rng = np.random.default_rng(6)
    return {"position": rng.normal(size=(3, 2)), "color": rng.normal(size=(3, 1))}


def joint_of_all_objects(learned: Fit, scene: dict[str, Floats]) -> list[Floats]:
    """For each object channel (M, K) log π N: not normalised, as the model has it for every object on the table."""
    return [
        learned.state.log_weights[c + 1]
        + gaussian_log_density(features, learned.state.mean[c + 1], learned.state.factor[c + 1])
        for c, features in enumerate(scene.values())
    ]


def log_words_given_frames(learned: Fit, z: tuple[int, ...], words: list[int]) -> float:
    """Log Σ_f λ_f ∏ p(word | f): every frame of the method listed, z the categories of the three channels."""
    C, N, W = len(z), len(words), len(learned.trials.vocabulary)
    frame_prior = learned.problem.frame_prior
    theta = np.full((C + 1, N), -np.log(W))  # surplus words are as probable as any
    for c, k in enumerate(z):
        theta[c] = learned.state.log_words[c][k, words]
    if not frame_prior.has_frames:
        return float(theta[:C].sum())
    if frame_prior.has_none:
        theta[C] = learned.state.log_words[C][0, words]
    if N <= frame_prior.word_limit(C):
        frames = frame_prior.allowed(C, N)
    else:
        frames = np.full((math.perm(N, C), N), C)
        for frame, chosen in zip(frames, permutations(range(N), C), strict=True):
            frame[list(chosen)] = np.arange(C)
    log_frames = np.array([log_frame(learned, frame, C) for frame in frames])
    assert logsumexp(log_frames) == pytest.approx(0.0, abs=1e-12)
    return float(logsumexp(log_frames + theta[frames, np.arange(N)].sum(axis=1)))


def log_frame(learned: Fit, frame: Ints, C: int) -> float:
    """Log λ_f as the methods are defined."""
    prior, N = learned.problem.frame_prior, len(frame)
    order = tuple(frame[frame < C].tolist())
    most, j = min(C, N), len(order)
    if not isinstance(prior, Once):
        named = -np.log((N + 1) * math.comb(N, j) * float(C) ** j)
        return float(named if prior.has_none else -np.log(prior.count(C, N)))
    places = -np.log(math.comb(N, j)) - (np.log(most + 1) if prior.none else 0.0)
    if not prior.ordered:
        return float(places - np.log(math.perm(C, j)))
    return float(places + learned.state.log_orders[orders_of(C).index(order)])


def direct(learned: Fit, scene: dict[str, Floats], words: list[int]) -> Floats:
    """(M, K_a) log p(words, A, z^a | objects), by summing over the categories of all objects on the table."""
    densities = joint_of_all_objects(learned, scene)
    M, K = len(densities[0]), len(learned.state.log_weights[0])
    evidence = sum(logsumexp(density, axis=1).sum() for density in densities)
    result = np.empty((M, K))
    for m, k in product(range(M), range(K)):
        terms = []
        for labels in product(*(range(density.shape[1]) for density in densities for _ in range(M))):
            of_channel = [labels[c * M : (c + 1) * M] for c in range(len(densities))]
            weight = sum(
                density[i, part[i]] for density, part in zip(densities, of_channel, strict=True) for i in range(M)
            )
            terms.append(weight + log_words_given_frames(learned, (k, *(part[m] for part in of_channel)), words))
        result[m, k] = logsumexp(terms) - evidence + learned.state.log_weights[0][k] - np.log(M)
    return result


@pytest.mark.parametrize("N", range(7))
def test_scores_are_the_direct_sum(learned: Fit, scene: dict[str, Floats], N: int) -> None:
    """The objects that are not attended divide out exactly; sentences may be longer or shorter than the channels."""
    two_objects = {name: features[:2] for name, features in scene.items()}
    words = np.random.default_rng(N).integers(len(learned.trials.vocabulary), size=N).tolist()
    answer = understand(learned, two_objects, [learned.trials.vocabulary[w] for w in words])
    assert answer.log_scores == pytest.approx(direct(learned, two_objects, words), rel=1e-9, abs=1e-9)
    assert answer.probabilities.sum() == pytest.approx(1.0)


def test_the_order_of_the_words_matters_only_where_it_is_learned(learned: Fit, scene: dict[str, Floats]) -> None:
    prior, words = learned.problem.frame_prior, list(learned.trials.vocabulary[:3])
    scores = [understand(learned, scene, order).log_scores for order in permutations(words)]
    alike = [np.allclose(one, scores[0]) for one in scores]
    assert all(alike) != (isinstance(prior, Once) and prior.ordered)


def test_the_order_that_is_learned_is_told(learned: Fit) -> None:
    if not len(learned.state.log_orders):
        assert spoken_order(learned) is None
        return
    likely = np.full(len(learned.state.log_orders), -9.0)
    likely[orders_of(3).index((2, 0, 1))] = -0.1
    likely[orders_of(3).index((1, 0))] = 0.0  # of fewer channels: not an order of all
    assert spoken_order(replace(learned, state=replace(learned.state, log_orders=likely))) == (
        "color",
        "action",
        "position",
    )


def test_no_word_leaves_the_prior(learned: Fit, scene: dict[str, Floats]) -> None:
    expected = np.tile(np.exp(learned.state.log_weights[0]) / 3, (3, 1))
    assert understand(learned, scene, []).probabilities == pytest.approx(expected)


def test_an_unknown_word_is_left_out_and_named(learned: Fit, scene: dict[str, Floats]) -> None:
    word = learned.trials.vocabulary[0]
    with_it = understand(learned, scene, [word, "blorp"])
    assert with_it.ignored == ("blorp",)
    assert with_it.log_scores == pytest.approx(understand(learned, scene, [word]).log_scores)


def test_equal_objects_are_tied(learned: Fit, scene: dict[str, Floats]) -> None:
    twins = {name: np.tile(features[:1], (2, 1)) for name, features in scene.items()}
    chosen = {m for m, _ in understand(learned, twins, [learned.trials.vocabulary[0]]).choices()}
    assert chosen == {0, 1}


def test_a_choice_is_the_highest_score() -> None:
    answer = Answer(np.log(np.array([[0.1, 0.5], [0.3, 0.1]])), ())
    assert answer.choices() == ((0, 1),)


def test_long_instructions(learned: Fit, scene: dict[str, Floats]) -> None:
    word = learned.trials.vocabulary[0]
    most = learned.problem.frame_prior.longest_instruction
    longest = understand(learned, scene, [word] * most)
    assert np.all(np.isfinite(longest.log_scores))
    with pytest.raises(ValueError, match=f"{most + 1} words"):
        understand(learned, scene, [word] * (most + 1))


def test_an_empty_table_is_refused(learned: Fit) -> None:
    with pytest.raises(ValueError, match="no object"):
        understand(learned, {"position": np.empty((0, 2)), "color": np.empty((0, 1))}, [])


def test_descriptions_are_the_most_probable_words(learned: Fit, scene: dict[str, Floats]) -> None:
    for c, (channel, features) in enumerate(scene.items(), start=1):
        r = np.exp(responsibilities(learned.state, c, features))
        assert r.sum(axis=1) == pytest.approx(1.0)
        best = np.argmax(r @ np.exp(learned.state.log_words[c]), axis=1)
        assert describe(learned, channel, features) == tuple(learned.trials.vocabulary[w] for w in best)


def test_no_description_without_words(learned: Fit, scene: dict[str, Floats]) -> None:
    wordless = replace(learned, problem=replace(learned.problem, trials=replace(learned.trials, vocabulary=())))
    with pytest.raises(ValueError, match="training had none"):
        describe(wordless, "color", scene["color"])


def test_lost_logarithms_of_words(learned: Fit, scene: dict[str, Floats], tmp_path: Path) -> None:
    """A fit is stored with θ, where a small enough one underflows: then a word is improbable, not impossible."""
    sure = tuple(np.full_like(log_words, -2000.0) for log_words in learned.state.log_words)
    for log_words in sure:
        log_words[:, 0] = 0.0
    save(replace(learned, state=replace(learned.state, log_words=sure)), tmp_path / "fit.npz")
    again = load(tmp_path / "fit.npz")
    answer = understand(again, scene, again.trials.vocabulary[1:4])
    assert np.isfinite(answer.log_scores).all()
    assert answer.probabilities.sum() == pytest.approx(1.0)
    assert answer.choices()
