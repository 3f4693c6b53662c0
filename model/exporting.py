"""Chains of a condition as ArviZ `InferenceData`, in a netCDF file that other programs read.

| group | variable | dimensions |
| --- | --- | --- |
| `posterior` | `z_{x}`, the category of each element of channel x | chain, draw, element_{x} |
| | `F`, the index of the channel of each word, C for none; not of a method without frames | chain, draw, word |
| | `mean_precision`, κ0; only where a channel learns it | chain, draw, channel |
| `sample_stats` | `lp`, log p(X, w, z, F) | chain, draw |
| | `used`, the number of categories in use | chain, draw, channel |
| `observed_data` | `features_{x}`, the features of the elements | element_{x}, feature_{x} |
| | `speaker_{x}`, the element that each trial's sentence is about | trial |
| | `word_trial`, the trial of each word | word |

The coordinate `draw` is the iteration after which the state was kept, counted from 1; `word` the words themselves,
one for each token; `channel` the names of the channels. Attributes of the file: `method`, and as JSON `sampler`,
`priors`, `vocabulary` and `seeds`, one a chain.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from model.diagnostics import check_chains, import_arviz, skipped_iterations
from model.fits import Fit, load
from model.history import History

if TYPE_CHECKING:
    import xarray as xr

Variables = Mapping[str, tuple[list[str], np.ndarray]]


def export(paths: Sequence[Path], to: Path, burn_in: float | None = None) -> None:
    """Write the chains that are kept in some files as one netCDF file.

    The same fits give the same bytes under the same `environment.lock`: libraries note their versions in each file
    of this format, and no time. The file appears only when it is complete.

    Args:
        paths: Fits, one a chain.
        to: The file; one of that name is replaced.
        burn_in: Share of the iterations left out at the start, 0 to below 1; by default the sampler's.

    Raises:
        ValueError: As for `inference_data`, or a file is no fit.
        OSError: A fit cannot be read, or the file cannot be written.
    """
    if not to.parent.is_dir():
        raise FileNotFoundError(f"{to.parent} is not a folder")
    if to.is_dir():
        raise IsADirectoryError(f"{to} is a folder")
    data = inference_data([load(path) for path in paths], burn_in)
    temporary = to.with_name(f".{to.name}.{os.getpid()}.part")
    try:
        data.to_netcdf(str(temporary), engine="h5netcdf")
        temporary.replace(to)
    finally:
        temporary.unlink(missing_ok=True)


def inference_data(fits: Sequence[Fit], burn_in: float | None = None) -> Any:
    """The kept states of chains as an `arviz.InferenceData`, in the form that the module describes.

    Args:
        fits: One a chain.
        burn_in: Share of the iterations left out at the start, 0 to below 1; by default the sampler's.

    Raises:
        ValueError: No fits, fits that are not chains of one posterior, or none of whose kept states counts.
    """
    check_chains(fits)
    first, skipped = fits[0], skipped_iterations(fits[0], burn_in)
    histories = [fit.history for fit in fits if fit.history is not None]
    if len(histories) < len(fits):
        raise ValueError("the fits keep no states (keep_history of their sampler was 0)")
    kept = histories[0].iterations > skipped
    if not kept.any():
        raise ValueError(f"the fits keep no state after the first {skipped} iterations")
    draws = histories[0].iterations[kept]
    names = [channel.name for channel in first.trials.channels]
    words = np.array([first.trials.vocabulary[w] for w in first.trials.words[0]], dtype=np.str_)
    chain_and_draw = {"chain": np.arange(len(fits)), "draw": draws}
    attributes = {
        "method": first.problem.method.name,
        "sampler": _as_json(first.sampler.model_dump()),
        "priors": _as_json(
            {name: prior.model_dump() for name, prior in zip(names, first.problem.priors, strict=True)}
        ),
        "vocabulary": _as_json(first.trials.vocabulary),
        "seeds": _as_json([fit.seed for fit in fits]),
    }
    groups = {
        "posterior": _dataset(_states(names, histories, kept), chain_and_draw | {"word": words, "channel": names}),
        "sample_stats": _dataset(_statistics(fits, draws), chain_and_draw | {"channel": names}),
        "observed_data": _dataset(_observed(first), {"trial": np.arange(first.trials.count), "word": words}),
    }
    return import_arviz().InferenceData(attrs=attributes, **groups)


def _states(names: Sequence[str], histories: Sequence[History], kept: np.ndarray) -> Variables:
    states = {
        f"z_{name}": (["chain", "draw", f"element_{name}"], np.stack([history.z[c][kept] for history in histories]))
        for c, name in enumerate(names)
    }
    F = np.stack([history.F[kept] for history in histories])
    learned = [history.mean_precision[kept] for history in histories if history.mean_precision is not None]
    kappa = {"mean_precision": (["chain", "draw", "channel"], np.stack(learned))} if learned else {}
    return states | ({"F": (["chain", "draw", "word"], F)} if F.shape[2] else {}) | kappa


def _statistics(fits: Sequence[Fit], draws: np.ndarray) -> Variables:
    return {
        "lp": (["chain", "draw"], np.stack([fit.trace_log_joint[draws - 1] for fit in fits])),
        "used": (["chain", "draw", "channel"], np.stack([fit.trace_used[draws - 1] for fit in fits])),
    }


def _observed(fit: Fit) -> Variables:
    observed: dict[str, tuple[list[str], np.ndarray]] = {"word_trial": (["word"], fit.trials.word_trial)}
    for channel in fit.trials.channels:
        observed[f"features_{channel.name}"] = (
            [f"element_{channel.name}", f"feature_{channel.name}"],
            channel.features,
        )
        observed[f"speaker_{channel.name}"] = (["trial"], channel.speaker)
    return observed


def _dataset(variables: Variables, coordinates: Mapping[str, Any]) -> xr.Dataset:
    """A dataset with those of the coordinates whose dimensions it has."""
    import xarray as xr

    dimensions = {dimension for names, _ in variables.values() for dimension in names}
    return xr.Dataset(dict(variables), {name: values for name, values in coordinates.items() if name in dimensions})


def _as_json(value: object) -> str:
    return json.dumps(value, sort_keys=True, ensure_ascii=False)
