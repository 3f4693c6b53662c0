"""Fits on disk: one npz file without pickled objects, an array for each symbol of the model.

| array | symbol | shape |
| --- | --- | --- |
| `method`, `channels`, `vocabulary` | names | (), (C,), (W,) |
| `words`, `word_trial` | w and its trial d | (C, T), (T,) |
| `F` | F, index of a channel for each word; empty without frames | (T,) or (0,) |
| `trace_log_joint` | log p(X, w, z, F) after each iteration | (iterations,) |
| `trace_used` | categories in use after each iteration | (iterations, C) |
| `features_{x}`, `speaker_{x}` | features of the elements, speaking element a trial | (N_x, dim_x), (D,) |
| `z_{x}` | z^x | (N_x,) |
| `pi_{x}`, `mu_{x}`, `Sigma_{x}` | π^x, μ^x, Σ^x | (K_x,), (K_x, dim_x), (K_x, dim_x, dim_x) |
| `theta_{x}` | θ^x | (K_x, W) |
| `prior_{x}` | hyperparameters of the channel as JSON | () |
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from model.data import Channel, Prior, Trials
from model.fitting import Fit
from model.state import State


def save(fit: Fit, path: Path) -> None:
    """Write a fit: to a temporary name first, so that no half-written file carries the name.

    The same fit always gives the same bytes.
    """
    trials, state = fit.trials, fit.state
    arrays: dict[str, Any] = {
        "method": np.array(fit.method),
        "channels": np.array([channel.name for channel in trials.channels]),
        "vocabulary": np.array(trials.vocabulary, dtype=np.str_),
        "words": trials.words,
        "word_trial": trials.word_trial,
        "F": state.F,
        "trace_log_joint": fit.trace_log_joint,
        "trace_used": fit.trace_used,
    }
    for c, channel in enumerate(trials.channels):
        arrays |= {
            f"features_{channel.name}": channel.features,
            f"speaker_{channel.name}": channel.speaker,
            f"z_{channel.name}": state.z[c],
            f"pi_{channel.name}": np.exp(state.log_weights[c]),
            f"mu_{channel.name}": state.mean[c],
            f"Sigma_{channel.name}": state.factor[c] @ state.factor[c].transpose(0, 2, 1),
            f"theta_{channel.name}": np.exp(state.log_words[c]),
            f"prior_{channel.name}": np.array(json.dumps(asdict(fit.priors[c]), sort_keys=True)),
        }
    temporary = path.with_name(f".{path.name}.part")
    with temporary.open("wb") as file:
        np.savez_compressed(file, **arrays)
    temporary.replace(path)


def load(path: Path) -> Fit:
    """Read a fit.

    Raises:
        ValueError: the file is not a fit, or is damaged; the message names it.
    """
    try:
        with np.load(path, allow_pickle=False) as arrays:
            return _from_arrays({name: arrays[name] for name in arrays.files})
    except (
        KeyError,
        ValueError,
        EOFError,
        zipfile.BadZipFile,
        zipfile.error,
        np.linalg.LinAlgError,
    ) as error:
        raise ValueError(f"{path} is not a readable fit: {error}") from error


def _from_arrays(arrays: dict[str, Any]) -> Fit:
    names = [str(name) for name in arrays["channels"]]
    channels = tuple(Channel(name, arrays[f"features_{name}"], arrays[f"speaker_{name}"]) for name in names)
    vocabulary = tuple(str(word) for word in arrays["vocabulary"])
    settings = [json.loads(str(arrays[f"prior_{name}"])) for name in names]
    with np.errstate(divide="ignore"):
        state = State(
            z=tuple(arrays[f"z_{name}"] for name in names),
            log_weights=tuple(np.log(arrays[f"pi_{name}"]) for name in names),
            mean=tuple(arrays[f"mu_{name}"] for name in names),
            factor=tuple(np.linalg.cholesky(arrays[f"Sigma_{name}"]) for name in names),
            log_words=tuple(np.log(arrays[f"theta_{name}"]) for name in names),
            F=arrays["F"],
        )
    return Fit(
        trials=Trials(channels, arrays["words"], arrays["word_trial"], vocabulary),
        method=str(arrays["method"]),
        priors=tuple(Prior(**{**values, "box": tuple(values["box"])}) for values in settings),
        state=state,
        trace_log_joint=arrays["trace_log_joint"],
        trace_used=arrays["trace_used"],
    )
