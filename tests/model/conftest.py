"""Tiny models on which everything can be computed exactly."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from model import SAMPLERS, Prior, Sampler, Trials
from tests.model.samplers import HEARING
from tests.synthetic import trials_of_model


@pytest.fixture(params=sorted(HEARING))
def method(request: pytest.FixtureRequest) -> str:
    """Each method that hears words."""
    return str(request.param)


@pytest.fixture(params=SAMPLERS)
def kind(request: pytest.FixtureRequest) -> type[Sampler[Any]]:
    """Each kind of sampler."""
    return SAMPLERS[request.param]


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
