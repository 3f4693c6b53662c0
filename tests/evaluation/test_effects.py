"""What is due to the model and what to the sampler, on scores made by hand."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pandas as pd
import pytest

from evaluation.effects import effects
from evaluation.pages import causes
from tests.evaluation.hand_made import scores_of

NOISE = np.linspace(-0.01, 0.01, 5)


def study() -> pd.DataFrame:
    """A and B by two samplers: A hears better by both, describes better by the first sampler alone."""
    parts = []
    for sampler, gap, shift in (("published", 0.2, 0.0), ("mixing", 0.0, 0.3)):
        values = {}
        for ROW, gain in ((0, 0.1), (40, 0.3)):
            values["csl", "proposed", 20, ROW, "EAR"] = list(0.6 + gain + shift + NOISE)
            values["csl", "no_mec2", 20, ROW, "EAR"] = list(0.6 + shift - NOISE)
            values["description", "proposed", 20, ROW, "F1"] = list(0.5 + gap + NOISE)
            values["description", "no_mec2", 20, ROW, "F1"] = list(np.full(5, 0.5))
            values["csl", "proposed", 20, ROW, "used_a"] = [3.0] * 5
        parts.append(scores_of(values).assign(sampler=sampler))
    return pd.concat(parts, ignore_index=True)


def found_in(scores: pd.DataFrame) -> dict[tuple[str, ...], tuple[Any, str]]:
    found = effects(scores)
    names = found[["side", "other", "given", "measure"]].itertuples(index=False, name=None)
    return dict(zip(names, zip(found["mean"], found.found, strict=True), strict=True))


def test_each_cause_is_changed_while_the_other_stays() -> None:
    found = found_in(study())
    assert found == {
        ("proposed", "no_mec2", "published", "EAR"): (pytest.approx(0.2), "higher"),
        ("proposed", "no_mec2", "published", "F1"): (pytest.approx(0.2), "higher"),
        ("proposed", "no_mec2", "mixing", "EAR"): (pytest.approx(0.2), "higher"),
        ("proposed", "no_mec2", "mixing", "F1"): (pytest.approx(0.0), "not decidable"),
        ("mixing", "published", "proposed", "EAR"): (pytest.approx(0.3), "higher"),
        ("mixing", "published", "proposed", "F1"): (pytest.approx(-0.2), "lower"),
        ("mixing", "published", "no_mec2", "EAR"): (pytest.approx(0.3), "higher"),
        ("mixing", "published", "no_mec2", "F1"): (pytest.approx(0.0), "equal"),
    }


def test_only_conditions_that_both_sides_have_count() -> None:
    """Without B at ROW 40 the gain there, which is larger, counts for nobody; other variants do not count."""
    scores = study()
    scores = scores[(scores.method == "proposed") | (scores.ROW == 0)]
    few = scores.assign(variant="few", value=0.0)
    found = found_in(pd.concat([scores, few], ignore_index=True))
    assert found["proposed", "no_mec2", "published", "EAR"][0] == pytest.approx(0.1)


def test_the_interval_is_that_of_the_seeds() -> None:
    """A − B varies between seeds by twice the noise; the mean of five seeds by σ/√5."""
    found = effects(study())
    own = found[(found.given == "published") & (found.measure == "EAR") & (found.compared == "method")].iloc[0]
    assert own.n == 5
    spread = 1.96 * np.std(2 * NOISE) / np.sqrt(5)
    assert (own.high - own["mean"], own["mean"] - own.low) == pytest.approx((spread, spread), rel=0.15)


def test_one_seed_decides_nothing() -> None:
    found = effects(study().query("seed == 1"))
    assert set(found.found) == {"not decidable"}


def test_the_section_says_what_hangs_on_the_sampler() -> None:
    body = causes.section(study()).body
    assert re.findall(r"<li>(.*?)</li>", body) == [
        "A − B, simulator: higher whatever the sampler: EAR; "
        "depending on the sampler: F1 (higher with published; not decidable with mixing)."
    ]
    assert "<td>mixing − published</td><td>(A) proposed</td><td><b>+0.300 (" in body
    assert "<td>A − B</td><td>mixing</td><td><b>+0.200 (" in body
    assert "<td>+0.000 (−0.00" in body


def test_one_sampler_says_nothing_of_samplers() -> None:
    body = causes.section(study().query("sampler == 'mixing'")).body
    assert "One sampler was run (mixing)" in body
    assert "<li>" not in body
    assert "<td>A − B</td><td>mixing</td>" in body


def test_a_study_of_one_method_compares_none() -> None:
    body = causes.section(study().query("method == 'proposed' and sampler == 'mixing'")).body
    assert "Nothing was run that could be compared." in body


def test_c_as_released_is_told_from_c() -> None:
    values = {("csl", method, 20, 0, "ARI_a"): list(level + NOISE) for method, level in LEVELS.items()}
    body = causes.section(scores_of(values)).body
    assert "<td>C released − C</td><td>published</td><td><b>+0.100 (" in body


LEVELS = {"mmlda": 0.3, "mmlda_released": 0.4}
