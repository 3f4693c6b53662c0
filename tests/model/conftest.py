"""Tiny models on which everything can be computed exactly."""

from __future__ import annotations

import numpy as np
import pytest

from model import Prior, Trials
from tests.model.samplers import RULES
from tests.synthetic import trials_of_model


@pytest.fixture(params=sorted(RULES))
def rule(request: pytest.FixtureRequest) -> str:
    """The frame rule of each method."""
    return RULES[request.param]


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(11)


@pytest.fixture
def trials(rng: np.random.Generator) -> Trials:
    """Four trials, eight objects, sentences of none to three words, three channels."""
    return trials_of_model(rng, [1, 3, 2, 2], [2, 3, 0, 1])


@pytest.fixture
def priors() -> tuple[Prior, ...]:
    """A different, moderate prior for each of the three channels."""
    return (
        Prior(categories=3, mean_precision=0.5, scale=0.5, extra_degrees_of_freedom=3.0),
        Prior(categories=4, mean_precision=0.2, scale=0.3, concentration=2.0, mean=0.3),
        Prior(categories=2, mean_precision=1.0, scale=1.0, word_concentration=0.7),
    )
