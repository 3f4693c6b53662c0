"""Features in another unit than the prior expects stand out, and folders of parts are tables of a study."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml

from features.table import read_table
from tests.synthetic import write_own_study
from workflow.plan.config import ConfigError
from workflow.plan.loading import load_study
from workflow.plan.out_folder import ROOT, refuse_sources
from workflow.plan.study import feature_files
from workflow.plan.units import unlikely_units


def study_with(folder: Path, column: str, change: Any, **experiment: Any) -> tuple[Path, list[str]]:
    """A study of one's own with a changed column, and what stands out in it."""
    config = write_own_study(folder)
    name = "trials" if column == "action" else "objects"
    path = folder / f"{name}.parquet"
    table = pq.read_table(path)
    values = [change(np.array(row)).tolist() for row in table[column].to_pylist()]
    pq.write_table(table.set_column(table.column_names.index(column), column, pa.array(values)), path)
    if experiment:
        data = yaml.safe_load(config.read_text(encoding="utf-8"))
        data["experiments"]["own"] |= experiment
        config.write_text(yaml.safe_dump(data), encoding="utf-8")
    study = load_study(config)
    own = study.experiments["own"]
    paths = feature_files(study, "own")
    table = read_table(**paths, need_attention=True)
    assert tuple(unlikely_units(study, own, table, paths)) == study.notes
    return config, list(study.notes)


@pytest.mark.parametrize(
    ("column", "change", "says"),
    [
        ("position", lambda row: 100 * row, "centimetres"),
        ("position", lambda row: 1000 * row, "millimetres"),
        ("position", lambda row: row / 1000, "in another unit or frame"),
        ("position", lambda row: row + np.array([12.0, 3.0]), "in another unit or frame"),
        ("object_feature", lambda row: 255 * row, "channel object"),
        ("action", lambda row: row / 1000, "channel action"),
    ],
    ids=["centimetres", "millimetres", "kilometres", "another frame", "bytes", "thousandths"],
)
def test_numbers_in_another_unit_stand_out(tmp_path: Path, column: str, change: Any, says: str) -> None:
    _, (note,) = study_with(tmp_path, column, change)
    assert f"column {column!r}: the numbers spread by " in note
    assert says in note


def test_usual_numbers_and_a_fitting_prior_say_nothing(tmp_path: Path) -> None:
    assert study_with(tmp_path, "position", lambda row: row)[1] == []
    variants = {"default": {"scale": {"position": 100.0}}, "plain": {}}
    assert study_with(tmp_path, "position", lambda row: 100 * row, variants=variants)[1] == []


def test_notes_are_told_once_by_the_check(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    config, notes = study_with(tmp_path, "position", lambda row: 100 * row)
    caplog.clear()
    with caplog.at_level(logging.WARNING):
        load_study(config)
    assert [record.getMessage() for record in caplog.records] == [f"note: {note}" for note in notes]


def test_a_study_checks_a_folder_of_parts(tmp_path: Path) -> None:
    config = write_own_study(tmp_path)
    objects = tmp_path / "objects.parquet"
    table = pq.read_table(objects)
    objects.unlink()
    objects.mkdir()
    for part in range(2):
        pq.write_table(table[20 * part : 20 * (part + 1) if part == 0 else None], objects / f"part-{part}.parquet")
    assert load_study(config).notes == ()


@pytest.mark.bad_input
@pytest.mark.parametrize("silent", ["training", "description"])
def test_a_description_without_words_is_found_by_the_check(tmp_path: Path, silent: str) -> None:
    files = {"trials": "trials.parquet", "objects": "objects.parquet"}
    mute = tmp_path / "mute.parquet"
    config = write_own_study(tmp_path, features={**files, "description": {**files, "trials": "mute.parquet"}})
    trials = pq.read_table(tmp_path / "trials.parquet")
    words = pa.array([[]] * trials.num_rows, pa.list_(pa.string()))
    pq.write_table(trials.set_column(trials.column_names.index("words"), "words", words), mute)
    if silent == "training":
        (tmp_path / "said.parquet").write_bytes((tmp_path / "trials.parquet").read_bytes())
        mute.replace(tmp_path / "trials.parquet")
        (tmp_path / "said.parquet").replace(mute)
    says = "none of the first 20 trials" if silent == "training" else "nothing to compare descriptions with"
    with pytest.raises(ConfigError, match=says):
        load_study(config)


@pytest.mark.bad_input
@pytest.mark.parametrize(
    "out", [".", "..", "features", "docs/../model/x", "results/reference", ".venv/x", "/", ".git"]
)
def test_results_do_not_go_among_the_sources(out: str) -> None:
    with pytest.raises(ValueError, match="results would stand among the sources"):
        refuse_sources(ROOT / out)


@pytest.mark.parametrize("out", ["results", "results/smoke", "my_study/results", "/tmp/out", "features_2"])
def test_results_go_anywhere_else(out: str) -> None:
    refuse_sources(ROOT / out)
