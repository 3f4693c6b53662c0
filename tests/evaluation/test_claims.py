"""The claims on results made by hand, in which each verdict is known."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.catalogue import tables_of
from evaluation.claims.lights import with_lights
from evaluation.claims.paper import CLAIMS
from evaluation.claims.terms import ACTION_WORDS, SHADES_APART
from evaluation.claims.verdicts import description_scores, judge_claims
from evaluation.description import read_descriptions
from evaluation.measures import MEASURES
from evaluation.metrics import f1_macro
from evaluation.pages.claims import claims_html, write_claims
from evaluation.rendering import write
from evaluation.scores import COLUMNS, CONDITION
from evaluation.tables import sheet_of_scores
from tests.evaluation.hand_made import scores_of

SEEDS = 10
NOISE = np.linspace(-0.004, 0.004, SEEDS)
Level = Callable[[str, str, int, int, str], float]
SIMULATOR = {"EAR": (0.9, 0.7, 0.0), "F1": (0.8, 0.6, 0.5), "ACC": (0.8, 0.6, 0.5), "WAR": (0.7, 0.6, 0.5)}
# Categories in use: as many as words.
USED = {"used_p": 4.0, "used_c": 3.0}
METHODS = ("proposed", "no_mec2", "mmlda")


def as_the_paper_says(experiment: str, method: str, D: int, ROW: int, measure: str) -> float:
    """A level of each measure for which all claims about scores hold."""
    if measure in USED:
        return USED[measure]
    if measure == "OAR":
        return {"simulator": 1.0, "real": 1.0 if method != "mmlda" else 0.8}[experiment]
    if measure.startswith("ARI"):
        gain = 0.2 * (ROW < 100) if measure == "ARI_p" else 0.0
        return {"ARI_a": 0.3, "ARI_p": 0.5, "ARI_o": 0.4, "ARI_c": 0.98}[measure] + gain - ROW / 5000 + D / 2000
    level = SIMULATOR[measure][METHODS.index(method)] if method in METHODS else 0.0
    if measure == "EAR" and D == 20 and method == "no_mec2" and ROW >= 40:
        return as_the_paper_says(experiment, "proposed", D, ROW, measure) - 0.02
    return level - ROW / 500 + D / 2000


# The paper has no other measures than these.
MEASURED = [(one.task, one.name) for one in MEASURES if (one.in_tables and not one.optional) or one.name in USED]


def results(level: Level) -> pd.DataFrame:
    """The scores of a whole study, seeds apart by a little noise of their own."""
    grids = {"simulator": ((20, 40), (0, 20, 40, 60)), "real": ((25, 40), (0, 9, 20, 40))}
    frames = []
    for experiment, (Ds, ROWs) in grids.items():
        values = {}
        conditions = [(m, D, ROW) for m in METHODS for D in Ds for ROW in ROWs] + [("gmm", D, 100) for D in Ds]
        for i, (method, D, ROW) in enumerate(conditions):
            for task, measure in MEASURED:
                noise = 0.0 if measure in ("OAR", *USED) else np.roll(NOISE, 3 * i)
                values[(task, method, D, ROW, measure)] = list(
                    np.full(SEEDS, level(experiment, method, D, ROW, measure)) + noise
                )
        frames.append(scores_of(values, experiment))
    return pd.concat(frames, ignore_index=True)


def descriptions(
    mistake: tuple[str, str] = ("reach", "touch"),
    bad: str = "action",
    unheard: tuple[str, ...] = ("action", "object"),
) -> pd.DataFrame:
    """What fits of both experiments say.

    Args:
        mistake: What A always says wrong.
        bad: The channel that, with another, A loses words of at ROW 40.
        unheard: The channels of which C in `real` says nothing right.
    """
    told = [_told("simulator", (20, 40), "proposed", mistake, bad), _told("real", (25, 40), "proposed", mistake, bad)]
    return pd.concat([*told, _told("real", (25, 40), "mmlda", mistake, bad, unheard)], ignore_index=True)


def _told(
    experiment: str,
    Ds: tuple[int, ...],
    method: str,
    mistake: tuple[str, str],
    bad: str,
    unheard: tuple[str, ...] = (),
) -> pd.DataFrame:
    """Two trials an action word."""
    rows = []
    truth = {"action": ACTION_WORDS, "position": ("left", "far"), "object": ("cup", "ball"), "color": ("red", "blue")}
    lost = {"action": ("action", "position"), "object": ("object", "color")}[bad]
    for D in Ds:
        for ROW in (0, 40):
            for seed in range(1, SEEDS + 1):
                for channel, words in truth.items():
                    for trial, word in enumerate(words * 2):
                        # At ROW 40 some words are said wrong: one of another channel, that is never true.
                        forgotten = ROW == 40 and channel in lost and trial < len(words) - seed % 2
                        said = (
                            "what" if forgotten or channel in unheard else mistake[1] if word == mistake[0] else word
                        )
                        rows.append((D, ROW, seed, trial, channel, word, said))
    told = pd.DataFrame(rows, columns=["D", "ROW", "seed", "trial", "channel", "true", "described"])
    same = {
        "experiment": experiment,
        "dataset": 1,
        "variant": "default",
        "task": "description",
        "method": method,
    }
    return told.assign(**same, sampler="published")


def shown(*values: float) -> pd.DataFrame:
    """Whether the shades of green are apart in the fit of Figure 8, of each data set."""
    names = {"experiment": "real", "variant": "few", "task": "csl", "method": "proposed", "sampler": "published"}
    rows = [
        {**names, "D": 25, "ROW": 9, "seed": 4, "dataset": i, "measure": SHADES_APART, "value": value}
        for i, value in enumerate(values, start=1)
    ]
    return pd.DataFrame(rows)[COLUMNS]


def verdicts(scores: pd.DataFrame, told: pd.DataFrame, of_figures: pd.DataFrame | None = None) -> dict[int, str]:
    claims, _ = judge_claims(scores, told, of_figures)
    return dict(zip(claims["claim"], claims["verdict"], strict=True))


def test_everything_as_the_paper_says() -> None:
    found = verdicts(results(as_the_paper_says), descriptions(), shown(1.0, 1.0, 1.0))
    assert found == dict.fromkeys(range(1, 23), "holds")


@pytest.mark.parametrize(
    ("values", "verdict"),
    [
        ((1.0, 1.0), "holds"),
        ((1.0,), "not decidable"),
        ((0.0,), "not decidable"),
        ((0.0, 0.0, 0.0), "does not hold"),
        ((1.0, 1.0, 0.0), "not decidable"),
        ((0.0,) * 9 + (1.0,), "does not hold"),
        ((float("nan"), float("nan")), "not run"),
    ],
)
def test_shades_are_judged_by_the_fit_of_figure_8_of_each_data_set(
    values: tuple[float, ...], verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("verdicts", "lights"):  # the other claims take their time
        monkeypatch.setattr(f"evaluation.claims.{module}.CLAIMS", CLAIMS[-1:])
    scores, told, of_figures = results(as_the_paper_says), descriptions(), shown(*values)
    claims, comparisons = judge_claims(scores, told, of_figures)
    found = claims.set_index("claim").loc[22]
    assert found["verdict"] == verdict
    own = comparisons[comparisons["claim"] == 22].iloc[0]
    assert own["comparison"] == "shades of green apart(A, D 25, ROW 9, few) = 1"
    assert own["rests_on"] == ("" if verdict == "not run" else "claims_shades.csv")
    assert verdicts(scores, told, of_figures.assign(variant="default"))[22] == "not run"
    lights = convergence("green")
    lights.loc[lights["variant"] == "few", "light"] = "amber"
    assert with_lights(claims, lights).set_index("claim").loc[22, "lights"] == (
        "" if verdict == "not run" else "1 amber"
    )


def changed(**change: float) -> Level:
    """The paper's levels with other ones for cells named experiment_method_D_ROW_measure, `x` for any."""

    def level(*names: object) -> float:
        for pattern, value in change.items():
            if re.fullmatch(pattern.replace("x", "[^/]*").replace("__", "/"), "/".join(map(str, names))):
                return value
        return as_the_paper_says(*names)

    return level


@pytest.mark.parametrize(
    ("change", "refuted"),
    [
        ({"simulator__proposed__40__20__EAR": 0.3}, {1}),
        ({"simulator__no_mec2__20__60__EAR": 0.1}, {2, 3}),
        ({"simulator__proposed__20__40__ACC": 0.99}, {4}),
        ({"simulator__proposed__40__0__F1": 0.5}, {4, 5, 10}),
        ({"simulator__gmm__20__100__ARI_p": 0.9}, {6}),
        ({"simulator__proposed__40__0__ARI_c": 0.9}, {7}),
        ({"simulator__proposed__40__0__ARI_o": 1.0}, {6, 8, 16}),
        ({"simulator__proposed__40__0__ARI_a": 0.75}, {6, 16}),
        ({"simulator__proposed__40__0__used_p": 5.0}, {15}),
        ({"simulator__proposed__40__0__used_c": 2.0}, {15}),
        ({"real__no_mec2__25__0__ACC": 0.9}, {17}),
        ({"real__proposed__25__0__F1": 0.9}, {18}),
        ({"real__proposed__40__40__ARI_x": 0.2}, {13, 19}),
        ({"simulator__mmlda__40__0__WAR": 0.9}, {9}),
        ({"simulator__proposed__40__0__OAR": 0.9}, {9}),
        ({"simulator__mmlda__20__0__F1": 0.9}, {10}),
        ({"real__mmlda__25__9__ARI_c": 0.5}, {13}),
        ({"real__proposed__40__40__EAR": 0.1}, {13}),
        ({"real__no_mec2__25__0__OAR": 0.9}, {14}),
        ({"real__mmlda__25__0__OAR": 1.0}, {14}),
    ],
)
def test_each_claim_can_be_refuted(change: dict[str, float], refuted: set[int]) -> None:
    found = verdicts(results(changed(**change)), read_descriptions([]))
    assert {claim for claim, verdict in found.items() if verdict == "does not hold"} == refuted


def test_claims_about_words_can_be_refuted() -> None:
    scores = results(as_the_paper_says)
    assert verdicts(scores, descriptions(mistake=("grasp", "touch")))[11] == "does not hold"
    assert verdicts(scores, descriptions(mistake=("grasp", "touch")))[20] == "does not hold"
    assert verdicts(scores, descriptions(unheard=("position", "object")))[21] == "does not hold"
    assert verdicts(scores, descriptions(unheard=("action", "color")))[21] == "does not hold"
    assert verdicts(scores, descriptions(bad="object"))[12] == "does not hold"


def test_what_a_study_did_not_run_is_not_run() -> None:
    scores = results(as_the_paper_says)
    nothing = read_descriptions([])
    found = verdicts(scores[(scores.experiment == "simulator") & (scores.task != "generation")], nothing)
    assert {claim for claim, verdict in found.items() if verdict == "not run"} == {
        9,
        11,
        12,
        13,
        14,
        17,
        18,
        19,
        20,
        21,
        22,
    }
    claims, comparisons = judge_claims(scores[:0], nothing)
    assert set(claims["verdict"]) == {"not run"}
    assert set(claims["ours"]) == set(claims["rests_on"]) == set(comparisons["rests_on"]) == {""}
    assert comparisons[["left", "right", "difference", "low", "high"]].isna().all(axis=None)
    assert "not run" in claims_html(with_lights(claims, convergence("red")), comparisons)


def test_other_variants_and_samplers_are_not_the_papers() -> None:
    scores = results(as_the_paper_says)
    assert set(verdicts(scores.assign(variant="small_alpha"), descriptions()).values()) <= {"not run", "holds"}
    assert verdicts(scores.assign(sampler="collapsed"), descriptions())[1] == "not run"


def test_each_sampler_is_judged_by_its_own_fits() -> None:
    """The other sampler finds A no better than B; its descriptions were not made."""
    scores = results(as_the_paper_says)
    other = results(changed(simulator__no_mec2__40__20__EAR=0.99)).assign(sampler="other")
    alone, _ = judge_claims(scores, descriptions())
    claims, comparisons = judge_claims(pd.concat([scores, other], ignore_index=True), descriptions())
    pd.testing.assert_frame_equal(claims.drop(columns="other_samplers"), alone.drop(columns="other_samplers"))
    assert set(alone["other_samplers"]) == {""}
    told = claims.set_index("claim")["other_samplers"]
    assert (told[1], told[7], told[11]) == ("other: does not hold", "other: holds", "other: not run")
    links = comparisons[(comparisons.claim == 1) & (comparisons.sampler == "other")]["rests_on"]
    assert "tables/table_1a.html#default-other-D20-ROW0-proposed-EAR" in links.iloc[0]
    page = claims_html(with_lights(claims, convergence("green")), comparisons)
    assert "<td>other: does not hold</td>" in page
    assert page.count("<tr><td>other</td>") == page.count("<tr><td>published</td>") == len(comparisons) / 2


def test_the_same_results_give_the_same_verdicts() -> None:
    scores, told = results(as_the_paper_says), descriptions()
    for first, second in zip(judge_claims(scores, told), judge_claims(scores.iloc[::-1], told), strict=True):
        pd.testing.assert_frame_equal(first, second)


def convergence(light: str) -> pd.DataFrame:
    """The same light for each condition of the study, and a green one for those that no claim is about."""
    conditions = (
        results(as_the_paper_says)[CONDITION].drop(columns=["task", "seed"]).drop_duplicates().assign(light=light)
    )
    others = [conditions.assign(light="green", sampler="mixing"), conditions.assign(light="green", variant="few")]
    return pd.concat([conditions, *others], ignore_index=True)


def test_a_claim_tells_the_lights_of_the_fits_that_it_rests_on() -> None:
    claims, comparisons = judge_claims(results(as_the_paper_says), descriptions())
    found = convergence("green")
    of_claim_7 = (found.D == 40) & (found.ROW == 0) & (found.method == "proposed") & (found.sampler == "published")
    found.loc[of_claim_7 & (found.experiment == "simulator") & (found.variant == "default"), "light"] = "red"
    told = with_lights(claims, found).set_index("claim")["lights"]
    assert told[7] == "1 red"
    assert told[1] == "1 red, 15 green"  # A and B, two D, four ROW
    assert told[13] == f"{3 * 2 * 4} green"
    page = claims_html(with_lights(claims, found), comparisons)
    assert '<td style="background: #f9d5cf">1 red, 15 green</td>' in page
    assert '<td style="background: #d9f0d3">24 green</td>' in page
    not_run = with_lights(claims.assign(verdict="not run"), found)
    assert set(not_run["lights"]) == {""}


def test_measures_of_parts_of_descriptions() -> None:
    """F1 of all channels, weighted by their words, is F1; confusions are counted in both directions."""
    told = descriptions(mistake=("touch", "reach"))
    one = told[(told.experiment == "simulator") & (told.D == 20) & (told.ROW == 0) & (told.seed == 1)]
    found = description_scores(one).set_index("measure")["value"]
    assert found["confused reach/touch"] == 2
    assert found["confused touch/grasp"] == 0
    counts = {"action": 4, "position": 2, "object": 2, "color": 2}
    weighted = sum(n * found[f"F1_{channel}"] for channel, n in counts.items()) / sum(counts.values())
    assert weighted == pytest.approx(f1_macro(one["true"].tolist(), one["described"].tolist()))
    silent = one[~one["true"].isin(["reach", "touch"])]
    assert "confused reach/touch" not in description_scores(silent)["measure"].tolist()


def test_every_link_leads_to_a_cell(tmp_path: Path) -> None:
    scores = results(as_the_paper_says)
    for name, table in tables_of(set(zip(scores.experiment, scores.task, scores.D, strict=True))).items():
        write(name, sheet_of_scores(scores, table), tmp_path / "tables")
    claims, comparisons = judge_claims(scores, descriptions(), shown(1.0, 1.0))
    claims = with_lights(claims, convergence("red"))
    write_claims(claims, comparisons, tmp_path / "claims.csv", tmp_path / "rows.csv", tmp_path / "claims.html")
    page = (tmp_path / "claims.html").read_text()
    links = {link for links in comparisons["rests_on"] for link in links.split()}
    assert len(links) > 100
    for link in links:
        assert f'href="{link}"' in page
        file, _, cell = link.partition("#")
        if cell:
            assert f'id="{cell}"' in (tmp_path / file).read_text()
        else:
            assert re.fullmatch(r"descriptions/(simulator|real)_D\d+\.csv|scores\.csv|claims_shades\.csv", file)
    kept = pd.read_csv(tmp_path / "claims.csv", keep_default_na=False)
    assert kept["claim"].tolist() == [claim.number for claim in CLAIMS] == list(range(1, 23))
