"""Each kernel of the mixing sampler leaves an enumerated posterior as it is, also with tempered features."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import numpy as np
import pytest
from scipy import stats

from model.joint import log_marginal_joint
from model.kernels.mixing import clusters, exchange, group_move, split_merge, trial_block, word_move
from model.state import Partition
from tests.model.mixing_walk import KERNELS, Step, Tiny, kinds, tiny, walker

WITHOUT_FRAMES = ("silent", "trial block", "split and merge", "group move", "clusters")
OPEN = ("proposed_open", "no_mec2_open", "proposed_ordered", "proposed_open_ordered")
CASES = [
    (kernel, method)
    for method in ("proposed", "no_mec2", "mmlda", *OPEN)
    for kernel in KERNELS
    if method != "mmlda" or kernel in WITHOUT_FRAMES
]


def p_values(model: Tiny, step: Step, draws: int) -> tuple[float, float, float]:
    """The p-values of the states after a step from exact draws, and of the flows between them; the share that moved.

    The flows are the sharper test: how often a kind of state was left is compared with how often it was entered.
    """
    rng = np.random.default_rng(17)
    start = rng.choice(len(model.p), size=draws, p=model.p)
    zs, Fs = model.zs[start], model.Fs[start]
    walker(step)(rng, model.setup, model.tables(), zs, Fs)
    before, after = model.kind[start], kinds(model.setup.size.tolist(), zs, Fs)
    names, index = np.unique(model.kind, return_inverse=True)
    expected = np.bincount(index, weights=model.p) * draws
    left, entered = (
        np.bincount(np.searchsorted(names, side[before != after]), minlength=len(names)) for side in (before, after)
    )
    observed = np.bincount(np.searchsorted(names, after), minlength=len(names))
    common = expected >= 8
    # The rare kinds of states count as one.
    seen, exact = (np.append(side[common], side[~common].sum()) for side in (observed, expected))
    distance = np.sum((seen - exact) ** 2 / np.maximum(exact, 1.0))
    gross = left + entered
    busy = gross >= 16
    flow = np.sum((entered - left)[busy] ** 2 / gross[busy])
    return (
        float(stats.chi2.sf(distance, len(seen) - 1)),
        float(stats.chi2.sf(flow, max(1, busy.sum() - 1))),
        float(np.mean(before != after)),
    )


@pytest.mark.parametrize("power", [1.0, 0.5])
@pytest.mark.parametrize(("kernel", "method"), CASES)
def test_a_kernel_leaves_the_posterior_as_it_is(kernel: str, method: str, power: float) -> None:
    ends, flows, moved = p_values(tiny(method, power), KERNELS[kernel], 60_000)
    assert moved > 0.02
    assert min(ends, flows) > 1e-4


@pytest.mark.parametrize("kernel", ["trial block", "word move", "exchange", "permutation"])
@pytest.mark.parametrize("method", ["no_mec2", "proposed_open", "proposed_open_ordered"])
def test_long_sentences_with_words_said_twice(kernel: str, method: str) -> None:
    """Longer than what is drawn together, where frames are listed; else some tokens are held."""
    shape = "long sentence" if method == "no_mec2" else "word said twice"
    ends, flows, moved = p_values(tiny(method, 1.0, shape), KERNELS[kernel], 60_000)
    assert moved > 0.02
    assert min(ends, flows) > 1e-4


@pytest.mark.parametrize("kernel", ["split and merge", "group move", "clusters"])
def test_categories_of_many_elements(kernel: str) -> None:
    ends, flows, _ = p_values(tiny("proposed", 1.0, "many objects"), KERNELS[kernel], 100_000)
    assert min(ends, flows) > 1e-4


@pytest.mark.parametrize("method", ["proposed", "no_mec2", "mmlda", *OPEN])
def test_masses_are_the_log_joint(method: str) -> None:
    model = tiny(method, 1.0)
    log_p = np.log(model.p)
    for s in range(0, len(log_p), len(log_p) // 50):
        z = tuple(row[:size] for row, size in zip(model.zs[s], model.setup.size, strict=True))
        state = Partition(z, model.Fs[s])
        # Up to a constant, the same for all states.
        exact = log_marginal_joint(model.problem, state)
        first = Partition(
            tuple(row[:size] for row, size in zip(model.zs[0], model.setup.size, strict=True)), model.Fs[0]
        )
        reference = log_marginal_joint(model.problem, first)
        assert log_p[s] - log_p[0] == pytest.approx(exact - reference, abs=1e-9)


# Acceptance ratios and weights broken on purpose: module, kernel, what is replaced, by what.
BROKEN: dict[str, tuple[ModuleType, str, str, str]] = {
    "split without ½": (
        split_merge,
        "split and merge",
        "ratio += _LOG_HALF + math.log(empty)",
        "ratio += math.log(empty)",
    ),
    "merge with E for E′": (
        split_merge,
        "split and merge",
        "ratio -= _LOG_HALF + math.log(empty + 1)",
        "ratio -= _LOG_HALF + math.log(max(1, empty))",
    ),
    # Another order of the elements for the new path would break nothing: orders are as probable in both directions.
    "shuffle always accepted": (
        split_merge,
        "split and merge",
        "ratio = new - present",
        "ratio = 0.0 if kind == SHUFFLE else new - present",
    ),
    "merge without the way back": (
        split_merge,
        "split and merge",
        "ratio = new - present",
        "ratio = new - present * (kind != MERGE)",
    ),
    "group move without its way back": (group_move, "group move", "log_ratio += _move_along(", "_move_along("),
    "group move with a wrong target": (
        group_move,
        "group move",
        "log_ratio += _log_target(tables, c, target, k, count_empty(setup, tables, c))",
        "log_ratio += 0.0",
    ),
    "clusters that meet as if they did not": (clusters, "clusters", "if _meet(labels)", "if False"),
    "clusters of several categories": (clusters, "clusters", "if tables.z[c, i] != k:", "if False:"),
    "word move half as choosy": (word_move, "word move", "< new - present", "< 0.5 * (new - present)"),
    "exchange half as choosy": (exchange, "exchange", "< new - present", "< 0.5 * (new - present)"),
    "trial block of distinct sets": (
        trial_block,
        "trial block",
        "equal += setup.words[c, part[m]] == w",
        "equal += 1",
    ),
    "trial block that hears itself": (
        trial_block,
        "trial block",
        "count_frame(setup, tables, d, -1)",
        "count_frame(setup, tables, d, 0)",
    ),
    "exchange without the present order": (
        exchange,
        "exchange",
        "present = orders_log_mass(setup.paths, tables.orders)",
        "present = 0.0",
    ),
}
# What only methods with words of no channel and word order have.
OF_OPEN = ("trial block that hears itself", "exchange without the present order")
# Where categories are many and clear, what a path was drawn with matters.
OF_PATHS, SHARP = ("shuffle always accepted",), (3.0, "many objects")


def broken_module(original: ModuleType, old: str, new: str, folder: Path) -> ModuleType:
    """A copy of a module with one place changed, compiled by itself."""
    source = Path(str(original.__file__)).read_text()
    assert source.count(old) == 1
    path = folder / f"broken_{original.__name__.rpartition('.')[2]}.py"
    path.write_text(source.replace(old, new))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def step_of(module: ModuleType, kernel: str) -> Any:
    """The kernel of a module as the walk calls it."""
    if kernel == "trial block":
        sweep = module.sweep_trials
        return numba.njit(lambda rng, setup, tables, u: sweep(rng, setup, tables))
    within = {"split and merge": "split_or_merge", "group move": "move_group", "clusters": "move_clusters"}
    if kernel in within:
        move = getattr(module, within[kernel])
        return numba.njit(lambda rng, setup, tables, u: move(rng, setup, tables, int(u * len(setup.size))))
    move = getattr(module, {"word move": "move_word", "exchange": "exchange"}[kernel])
    return numba.njit(lambda rng, setup, tables, u: move(rng, setup, tables, int(u * tables.words.shape[2])))


@pytest.mark.slow
@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_ratio_is_noticed(name: str, tmp_path: Path) -> None:
    module, kernel, old, new = BROKEN[name]
    step = step_of(broken_module(module, old, new, tmp_path), kernel)
    method = "proposed_open_ordered" if name in OF_OPEN else "no_mec2"
    ends, flows, _ = p_values(tiny(method, *SHARP if name in OF_PATHS else (1.0,)), step, 400_000)
    assert min(ends, flows) < 1e-6
