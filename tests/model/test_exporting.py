"""Exported chains: ArviZ reads them with named dimensions and the same values; others are refused with a reason."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from model import Blocked, Fit, History, Prior, Problem, Trials, fit, save
from model.__main__ import main
from model.diagnostics import chain_quantities
from model.exporting import export, inference_data


def chains(trials: Trials, method: str = "no_mec2", **settings: Any) -> list[Fit]:
    sampler = Blocked(iterations=40, **settings)
    return [fit(Problem.of(trials, method), sampler, np.random.default_rng(seed)) for seed in range(3)]


@pytest.fixture
def fits(trials: Trials) -> list[Fit]:
    return chains(trials)


def saved(fits: list[Fit], folder: Path) -> list[Path]:
    paths = [folder / f"seed{seed}.npz" for seed in range(1, len(fits) + 1)]
    for one, path in zip(fits, paths, strict=True):
        save(one, path)
    return paths


def test_arviz_reads_what_the_fits_hold(fits: list[Fit], tmp_path: Path) -> None:
    arviz: Any = import_module("arviz")
    assert main(["export", *map(str, saved(fits, tmp_path)), "--to", str(tmp_path / "chains.nc")]) == 0
    data = arviz.from_netcdf(tmp_path / "chains.nc")
    assert sorted(data.groups()) == ["observed_data", "posterior", "sample_stats"]
    trials, draws = fits[0].trials, list(range(22, 41, 2))  # 20 states are kept, the first ten of which do not count
    words = [trials.vocabulary[w] for w in trials.words[0]]
    assert data.posterior.draw.values.tolist() == data.sample_stats.draw.values.tolist() == draws
    assert data.posterior.F.dims == ("chain", "draw", "word")
    assert data.posterior.word.values.tolist() == data.observed_data.word.values.tolist() == words
    assert data.sample_stats.lp.dims == ("chain", "draw")
    assert data.sample_stats.used.dims == ("chain", "draw", "channel")
    assert data.sample_stats.channel.values.tolist() == [channel.name for channel in trials.channels]
    for i, one in enumerate(fits):
        assert one.history is not None
        assert np.array_equal(data.posterior.F[i], one.history.F[10:])
        assert np.array_equal(data.sample_stats.lp[i], one.trace_log_joint[np.array(draws) - 1])
        assert np.array_equal(data.sample_stats.used[i], one.trace_used[np.array(draws) - 1])
        for c, channel in enumerate(trials.channels):
            z = data.posterior[f"z_{channel.name}"]
            assert z.dims == ("chain", "draw", f"element_{channel.name}")
            assert np.array_equal(z[i], one.history.z[c][10:])
    for channel in trials.channels:
        features = data.observed_data[f"features_{channel.name}"]
        assert features.dims == (f"element_{channel.name}", f"feature_{channel.name}")
        assert np.array_equal(features, channel.features)
        speaker = data.observed_data[f"speaker_{channel.name}"]
        assert speaker.dims == ("trial",)
        assert np.array_equal(speaker, channel.speaker)
    assert np.array_equal(data.observed_data.word_trial, trials.word_trial)
    assert data.attrs["method"] == "no_mec2"
    assert json.loads(data.attrs["sampler"]) == fits[0].sampler.model_dump()
    assert json.loads(data.attrs["priors"])["color"] == fits[0].problem.priors[2].model_dump(mode="json")


def test_the_same_fits_give_the_same_bytes(fits: list[Fit], tmp_path: Path) -> None:
    """Also in another process."""
    paths = saved(fits, tmp_path)
    export(paths, tmp_path / "one.nc")
    line = [sys.executable, "-m", "model", "export", *map(str, paths), "--to", str(tmp_path / "two.nc")]
    subprocess.run(line, check=True)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()
    assert b"created_at" not in (tmp_path / "one.nc").read_bytes()
    export(paths, tmp_path / "one.nc", burn_in=0.0)  # takes the place of the file
    assert (tmp_path / "one.nc").read_bytes() != (tmp_path / "two.nc").read_bytes()
    assert {path.suffix for path in tmp_path.iterdir()} == {".npz", ".nc"}


def test_a_method_without_frames_and_trials_without_words(trials: Trials, tmp_path: Path) -> None:
    arviz: Any = import_module("arviz")
    silent = trials.keep_words(np.zeros(len(trials.word_trial), dtype=bool))
    for own, method, tokens in ((trials, "mmlda", len(trials.word_trial)), (silent, "gmm", 0)):
        export(saved(chains(own, method), tmp_path), tmp_path / "chains.nc")
        data = arviz.from_netcdf(tmp_path / "chains.nc")
        assert "F" not in data.posterior
        assert data.observed_data.sizes["word"] == tokens
        assert data.posterior.z_color.shape[:2] == (3, 10)


def test_every_state_counts_where_none_is_burn_in(fits: list[Fit]) -> None:
    assert inference_data(fits, burn_in=0.0).posterior.sizes["draw"] == 20


Change = Callable[[list[Fit], Trials], list[Fit]]


def other_words(fits: list[Fit], trials: Trials) -> list[Fit]:
    return [*fits[:1], *chains(trials.keep_words(np.arange(len(trials.word_trial)) > 0))[:1]]


@pytest.mark.parametrize(
    ("change", "to", "more", "message"),
    [
        (other_words, "chains.nc", [], "fit 2 is no other chain of the posterior of fit 1, for it has other words"),
        (lambda fits, _: [replace(one, history=None) for one in fits], "chains.nc", [], "the fits keep no states"),
        (lambda fits, _: fits, "chains.nc", ["--burn-in", "1"], "burn_in = 1.0 (must be 0 to below 1)"),
        (lambda _, trials: chains(trials, keep_history=1), "new/chains.nc", [], "new is not a folder"),
        (lambda fits, _: fits, ".", [], "is a folder"),
    ],
)  # fmt: skip
def test_what_cannot_be_exported_is_told_and_leaves_nothing(
    change: Change,
    to: str,
    more: list[str],
    message: str,
    fits: list[Fit],
    trials: Trials,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    paths = saved(change(fits, trials), tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert main(["export", *map(str, paths), "--to", str(tmp_path / to), *more]) == 2
    assert message in capsys.readouterr().err
    assert sorted(tmp_path.rglob("*")) == before


def test_a_learned_kappa_is_exported_and_diagnosed(trials: Trials) -> None:
    """One channel learns it, the others are told; ArviZ gets all, diagnostics those that move."""
    priors = [Prior(mean_precision="learned"), *[Prior()] * (len(trials.channels) - 1)]
    problem = Problem.of(trials, "no_mec2", priors)
    fits = [fit(problem, Blocked(iterations=40), np.random.default_rng(seed)) for seed in range(2)]
    data = inference_data(fits)
    assert data.posterior.mean_precision.dims == ("chain", "draw", "channel")
    traces = [one.trace_mean_precision for one in fits if one.trace_mean_precision is not None]
    quantities = chain_quantities(fits)
    assert len(traces) == 2
    for i, trace in enumerate(traces):
        assert np.array_equal(data.posterior.mean_precision[i], trace[np.arange(21, 40, 2)])
        assert np.array_equal(quantities["mean_precision_action"][i], np.log10(trace[20:, 0]))
    assert [name for name in quantities if name.startswith("mean_precision")] == ["mean_precision_action"]
    assert "mean_precision" not in inference_data(chains(trials)).posterior


def test_a_file_that_is_no_fit_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "seed1.npz").write_bytes(b"no fit")
    for name, message in (("seed1.npz", "is not a readable fit"), ("seed2.npz", "No such file")):
        assert main(["export", str(tmp_path / name), "--to", str(tmp_path / "chains.nc")]) == 2
        assert message in capsys.readouterr().err
    assert not (tmp_path / "chains.nc").exists()


def test_states_that_end_before_the_burn_in_are_refused(fits: list[Fit]) -> None:
    early = []
    for one in fits:
        assert one.history is not None
        iterations, z, F = one.history.iterations[:3], tuple(z[:3] for z in one.history.z), one.history.F[:3]
        early.append(replace(one, history=History(iterations, z, F)))
    with pytest.raises(ValueError, match="keep no state after the first 20 iterations"):
        inference_data(early)


def test_a_disk_that_is_full_leaves_the_file_as_it_was(
    fits: list[Fit], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Data:
        def to_netcdf(self, path: str, engine: str) -> None:
            Path(path).write_text(engine)
            raise OSError("No space left on device")

    (tmp_path / "chains.nc").write_text("earlier")
    paths = saved(fits, tmp_path)
    before = sorted(tmp_path.iterdir())
    monkeypatch.setattr("model.exporting.inference_data", lambda fits, burn_in: Data())
    assert main(["export", *map(str, paths), "--to", str(tmp_path / "chains.nc")]) == 2
    assert "No space left on device" in capsys.readouterr().err
    assert sorted(tmp_path.iterdir()) == before
    assert (tmp_path / "chains.nc").read_text() == "earlier"
