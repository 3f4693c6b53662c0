"""Property-based tests over degenerate inputs: every fit runs and stays finite (docs/model.md, Numerics)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from model import METHODS, SAMPLERS, Blocked, Collapsed, Prior, Problem, Sampler, Trials, fit


@st.composite
def some_trials(draw: st.DrawFn) -> Trials:
    """One to five trials; constant, repeated, huge or tiny features; sentences from empty to long."""
    D = draw(st.integers(1, 5))
    objects = draw(st.lists(st.integers(1, 3), min_size=D, max_size=D))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    scale = draw(st.sampled_from([0.0, 1e-8, 1.0, 1e3, 1e6]))

    def features(count: int) -> np.ndarray:
        dim = draw(st.integers(1, 4))
        rows = draw(st.sampled_from(["constant", "few", "any", "flat"]))
        drawn = scale * rng.normal(size=(count, dim))
        if rows == "constant":
            drawn[:] = drawn[0]
        elif rows == "few":
            drawn = drawn[rng.integers(min(2, count), size=count)]
        elif rows == "flat":
            drawn[:, 0] = 0.0
        return drawn

    vocabulary = ["a", "b", "c"][: draw(st.integers(1, 3))]
    longest = draw(st.sampled_from([0, 1, 3, 9]))
    sentences = [[str(rng.choice(vocabulary)) for _ in range(rng.integers(longest + 1))] for _ in range(D)]
    names = ["position", "color"][: draw(st.integers(1, 2))]
    owner = np.repeat(np.arange(D), objects)
    attended = [int(rng.integers(count)) for count in objects]
    return Trials.from_arrays(features(D), {name: features(len(owner)) for name in names}, owner, attended, sentences)


some_priors = st.builds(
    Prior,
    categories=st.sampled_from([1, 2, 10]),
    concentration=st.sampled_from([1e-3, 1.0, 100.0]),
    mean_precision=st.sampled_from([1e-6, 0.001, 10.0]),
    scale=st.sampled_from([1e-6, 0.01, 1.0]),
    extra_degrees_of_freedom=st.sampled_from([-0.99, 0.0, 2.0, 50.0]),
    word_concentration=st.sampled_from([1e-6, 0.1, 10.0]),
)


def check(trials: Trials, prior: Prior, method: str, sampler: Sampler[Any], seed: int) -> None:
    """A fit of a few iterations is finite and in range, or refused for a sentence that is too long."""
    prior_of_frames, C = METHODS[method].frame_prior, len(trials.channels)
    if trials.sentence_lengths.max() > prior_of_frames.word_limit(C):
        with pytest.raises(ValueError, match="sentences have more than"):
            Problem.of(trials, method, prior)
        return
    result = fit(Problem.of(trials, method, prior), sampler, np.random.default_rng(seed))
    state = result.state
    assert np.all(np.isfinite(result.trace_log_joint))
    for c in range(len(trials.channels)):
        assert state.z[c].min() >= 0
        assert state.z[c].max() < prior.categories
        for array in (state.log_weights[c], state.mean[c], state.factor[c], state.log_words[c]):
            assert np.all(np.isfinite(array))
        assert np.diagonal(state.factor[c], axis1=1, axis2=2).min() > 0
    if METHODS[method].has_frames and len(trials.word_trial):
        assert set(np.unique(state.F)) <= set(range(prior_of_frames.sources(C)))


ONE_TRIAL = Trials.from_arrays(np.zeros((1, 2)), {"color": np.zeros((1, 1))}, [0], [0], [[]])


some_samplers = st.sampled_from(
    [*(kind(iterations=4) for kind in SAMPLERS.values()), Collapsed(iterations=4, temperature=7.0)]
)
some_fits = given(
    trials=some_trials(),
    prior=some_priors,
    method=st.sampled_from(sorted(name for name, method in METHODS.items() if method.is_model)),
    sampler=some_samplers,
    seed=st.integers(0, 1000),
)


@example(trials=ONE_TRIAL, prior=Prior(), method="proposed", sampler=Blocked(iterations=4), seed=0)
@example(trials=ONE_TRIAL, prior=Prior(), method="mmlda", sampler=Collapsed(iterations=4), seed=0)
@settings(max_examples=150, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@some_fits
def test_every_fit_is_finite(trials: Trials, prior: Prior, method: str, sampler: Sampler[Any], seed: int) -> None:
    check(trials, prior, method, sampler, seed)


@pytest.mark.slow
@settings(max_examples=3000, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@some_fits
def test_every_fit_is_finite_at_length(
    trials: Trials, prior: Prior, method: str, sampler: Sampler[Any], seed: int
) -> None:
    check(trials, prior, method, sampler, seed)
