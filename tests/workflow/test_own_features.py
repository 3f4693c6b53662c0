"""Studies on feature tables that somebody brings."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from model import load
from tests.synthetic import OBJECTS_COLUMNS, TRIALS_COLUMNS, own_rows, write_own_study, write_rows
from tests.workflow.runs import jobs, run

QUICK = {"seeds": 1, "ROW": [0]}
ARI = ["ARI_a", "ARI_p", "ARI_o", "ARI_c", "ARI_p_attended", "ARI_o_attended", "ARI_c_attended"]


def test_own_features_give_tables_and_figures(tmp_path: Path) -> None:
    config, out = write_own_study(tmp_path, **QUICK), tmp_path / "out"
    run(config, out)
    assert jobs(out)["fit"] == 3  # proposed, mmlda, and ALL
    scores = pd.read_csv(out / "scores.csv")
    defined = scores[(scores.method == "proposed")].set_index("measure")["value"]
    # Only a method with words of no channel is asked how well it finds them.
    assert set(defined.index[defined.isna()]) == {"none_precision", "none_recall"}
    assert defined["ARI_c"] > 0.5  # three far clusters
    fit = load(out / "fits/own/default/proposed/published/D20/ROW0/seed1.npz")
    assert [channel.features.shape[1] for channel in fit.trials.channels] == [38, 2, 100, 10]
    assert (out / "tables" / "own_csl.html").stat().st_size > 500
    # Without logs there is nothing of crops, pictures or clips to show.
    forms = ("words.png", "words.pdf", "positions.png", "positions.pdf")
    assert sorted(path.name for path in (out / "figures").iterdir()) == sorted(f"own_{form}" for form in forms)
    assert not (out / "ratings").exists()
    run(config, out)
    assert jobs(out) == {}


def test_without_truth_the_measures_that_need_it_stay_empty(tmp_path: Path) -> None:
    config, out = write_own_study(tmp_path, truth=False, **QUICK), tmp_path / "out"
    printed = run(config, out)
    assert "no column truth_action" in printed
    scores = pd.read_csv(out / "scores.csv")
    assert scores[scores.measure.isin(ARI)]["value"].isna().all()
    # The words of the config tell the true channel of each word, so that EAR is known all the same.
    assert scores[(scores.measure == "EAR") & (scores.method == "proposed")]["value"].notna().all()
    assert "–" in (out / "tables" / "own_csl.md").read_text()


@pytest.mark.parametrize(
    ("file", "row", "column", "value", "says"),
    [
        ("trials", 3, "words", ["no-such-word"], "no-such-word"),
        ("trials", 3, "words", ["reach", "touch", "grasp", "look-at", "front"], "5 words"),
        ("trials", 3, "attended_object", 7, "attended_object"),
        ("objects", 3, "position", [0.1, float("nan")], "position"),
    ],
)
def test_a_broken_table_stops_before_any_job(
    tmp_path: Path, file: str, row: int, column: str, value: object, says: str
) -> None:
    config = write_own_study(tmp_path)
    rows = dict(zip(("trials", "objects"), own_rows(), strict=True))
    rows[file][row][column] = value
    columns = {"trials": TRIALS_COLUMNS, "objects": OBJECTS_COLUMNS}[file]
    write_rows(rows[file], columns, tmp_path / f"{file}.parquet")
    printed = run(config, tmp_path / "out", succeeds=False)
    assert says in printed
    assert f"{file}.parquet" in printed
    assert "Traceback" not in printed
    assert not (tmp_path / "out").exists()


def test_more_trials_than_the_files_hold(tmp_path: Path) -> None:
    printed = run(write_own_study(tmp_path, D=[20, 21]), tmp_path / "out", succeeds=False)
    assert "experiments.own.D[1]: 21 is more than the 20 trials of" in printed


def test_fewer_trials_are_the_first(tmp_path: Path) -> None:
    config, out = write_own_study(tmp_path, D=[5], **QUICK), tmp_path / "out"
    run(config, out)
    trials = pd.read_parquet(out / "features/own/D5/train_trials.parquet")
    assert trials["trial"].tolist() == [1, 2, 3, 4, 5]


@pytest.mark.slow
def test_what_names_of_parts_tell_is_part_of_the_key(tmp_path: Path) -> None:
    """The same files in a folder of another name tell of other values."""
    config = write_own_study(tmp_path, features={"trials": "trials", "objects": "objects.parquet"}, D=[2], **QUICK)
    (tmp_path / "trials.parquet").unlink()
    folder, out = tmp_path / "trials", tmp_path / "out"
    columns = {name: kind for name, kind in TRIALS_COLUMNS.items() if name != "truth_action"}
    (folder / "truth_action=grasp").mkdir(parents=True)
    write_rows(own_rows()[0], columns, folder / "truth_action=grasp" / "part.parquet")
    wanted = "features/own/D2/train_trials.parquet"
    run(config, out, wanted)
    assert pd.read_parquet(out / wanted)["truth_action"].tolist() == ["grasp", "grasp"]
    (folder / "truth_action=grasp").rename(folder / "truth_action=reach")
    run(config, out, wanted)
    assert pd.read_parquet(out / wanted)["truth_action"].tolist() == ["reach", "reach"]


@pytest.mark.slow
@pytest.mark.parametrize("truth", [True, False])
def test_own_instructions_are_answered(tmp_path: Path, truth: bool) -> None:
    """Also those of missing, unknown and contradictory words, and where nobody knows which object is meant."""
    trials, objects = own_rows(trials=6, truth=truth)
    trials[0]["words"], trials[1]["words"], trials[2]["words"] = [], ["red"], ["red", "blue", "cup", "cup", "left"]
    if not truth:
        trials = [row | {"attended_object": None} for row in trials]
    write_rows(trials, TRIALS_COLUMNS, tmp_path / "asked_trials.parquet")
    write_rows(objects, OBJECTS_COLUMNS, tmp_path / "asked_objects.parquet")
    features = {"trials": "trials.parquet", "objects": "objects.parquet"}
    asked = {"trials": "asked_trials.parquet", "objects": "asked_objects.parquet"}
    config, out = write_own_study(tmp_path, features=features | {"generation": asked}, **QUICK), tmp_path / "out"
    run(config, out)
    answered = pd.read_csv(out / "uncertain/own_D20.csv")
    assert answered["fitting"].notna().all() == truth
    assert answered["entropy"].notna().all()
    assert "contradicts" in (out / "tables/own_uncertain.md").read_text()
    for figure in ("uncertain", "instructions"):
        assert (out / f"figures/own_{figure}.png").read_bytes().startswith(b"\x89PNG")
        assert (out / f"figures/own_{figure}.pdf").read_bytes().startswith(b"%PDF")
