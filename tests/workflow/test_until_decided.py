"""Further data sets until every claim is decided, or there are as many as one will pay for."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
import yaml

from evaluation.claims.judging import HOLDS, OPEN
from tests.workflow.runs import run
from workflow.artifacts.provenance import ROOT
from workflow.command_line import main
from workflow.execution.until_decided import run_until_decided
from workflow.plan.config import ConfigError, copied_from, keep_config, read_config
from workflow.plan.further_sets import Open, more_sets, open_claims
from workflow.plan.loading import load_study

CLAIMS_CONFIG = ROOT / "config" / "claims.yaml"
COLUMNS = ("claim", "experiment", "verdict", "needed")
Row = tuple[int, str, str, str]


@pytest.mark.parametrize(
    ("sets", "undecided", "most", "further"),
    [
        ({"simulator": 3, "real": 3}, [], 30, {"simulator": 3, "real": 3}),
        ({"simulator": 3, "real": 3}, [Open("1", "simulator", 5)], 30, {"simulator": 5, "real": 3}),
        ({"simulator": 3}, [Open("1", "simulator", 9), Open("2", "simulator", 4)], 30, {"simulator": 4}),
        ({"simulator": 3}, [Open("1", "simulator", 900)], 30, {"simulator": 6}),
        ({"simulator": 3}, [Open("1", "simulator", 2)], 30, {"simulator": 4}),
        ({"simulator": 3}, [Open("1", "simulator", None)], 30, {"simulator": 6}),
        ({"simulator": 1}, [Open("1", "simulator", None)], 30, {"simulator": 2}),
        ({"simulator": 20}, [Open("1", "simulator", 38)], 30, {"simulator": 30}),
        ({"simulator": 30}, [Open("1", "simulator", 38)], 30, {"simulator": 30}),
        ({"simulator": 40}, [Open("1", "simulator", 60)], 30, {"simulator": 40}),
        ({"simulator": 3}, [Open("13", "real", 9)], 30, {"simulator": 3}),
    ],
)
def test_further_data_sets(
    sets: dict[str, int], undecided: list[Open], most: int, further: Mapping[str, int]
) -> None:
    assert more_sets(sets, undecided, most) == further


def _write(path: Path, rows: Sequence[Row]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([COLUMNS, *rows])


def test_open_claims(tmp_path: Path) -> None:
    rows = [
        (1, "simulator", HOLDS, ""),
        (2, "simulator", OPEN, "14"),
        (13, "real", OPEN, "more than 1000"),
        (14, "real", OPEN, ""),
        (15, "simulator", "not run", ""),
    ]
    _write(tmp_path / "claims.csv", rows)
    assert open_claims(tmp_path / "claims.csv") == [
        Open("2", "simulator", 14),
        Open("13", "real", None),
        Open("14", "real", None),
    ]


class Rounds:
    """Stands for running a study: notes what is run, and writes the claims that it is told to."""

    def __init__(self, out: Path, claims: Sequence[Sequence[Row]], status: int = 0) -> None:
        self.out, self.claims, self.status = out, list(claims), status
        self.run: list[tuple[dict[str, int], list[str]]] = []
        self.configs: list[dict[str, Any]] = []

    def __call__(self, config: Path, targets: Sequence[str]) -> int:
        content = read_config(config)
        assert copied_from(config) == CLAIMS_CONFIG
        sets = {name: own["datasets"] for name, own in content["experiments"].items()}
        self.run.append((sets, list(targets)))
        self.configs.append(content)
        if targets:
            _write(self.out / "claims.csv", self.claims.pop(0))
        return self.status


def test_rounds_go_on_until_all_is_decided(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = [(1, "simulator", OPEN, "14"), (13, "real", OPEN, "900"), (2, "simulator", HOLDS, "")]
    second = [(1, "simulator", HOLDS, ""), (13, "real", OPEN, "25")]
    rounds = Rounds(tmp_path, [first, second, [(1, "simulator", HOLDS, ""), (13, "real", HOLDS, "")]])
    assert run_until_decided(CLAIMS_CONFIG, tmp_path, 30, rounds) == 0
    assert rounds.run == [
        ({"simulator": 10, "real": 10}, ["claims.csv"]),
        ({"simulator": 14, "real": 20}, ["claims.csv"]),
        ({"simulator": 14, "real": 25}, ["claims.csv"]),
        ({"simulator": 14, "real": 25}, []),
    ]
    assert capsys.readouterr().err.splitlines() == [
        "data sets: simulator 10, real 10: 2 claims open: 1 (simulator, about 14 data sets), "
        "13 (real, about 900 data sets)",
        "data sets: simulator 14, real 20: 1 claim open: 13 (real, about 25 data sets)",
        "data sets: simulator 14, real 25: no claim is open",
    ]


def test_nothing_but_the_data_sets_is_changed(tmp_path: Path) -> None:
    rounds = Rounds(tmp_path, [[(1, "simulator", OPEN, "")], []])
    run_until_decided(CLAIMS_CONFIG, tmp_path, 11, rounds)
    given = read_config(CLAIMS_CONFIG)
    assert rounds.configs[0] == given
    given["experiments"]["simulator"]["datasets"] = 11
    assert rounds.configs[1] == given


def test_rounds_end_with_the_most_data_sets(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    still = [(1, "simulator", OPEN, "900")]
    rounds = Rounds(tmp_path, [still] * 2)
    assert run_until_decided(CLAIMS_CONFIG, tmp_path, 12, rounds) == 0
    assert [sets["simulator"] for sets, _ in rounds.run] == [10, 12, 12]
    assert rounds.run[-1][1] == []
    assert capsys.readouterr().err.splitlines()[-1] == (
        "data sets: simulator 12, real 10: 1 claim open: 1 (simulator, about 900 data sets); "
        "there are no further data sets for them"
    )


def test_a_round_that_fails_is_the_last(tmp_path: Path) -> None:
    rounds = Rounds(tmp_path, [[(1, "simulator", OPEN, "14")]], status=3)
    assert run_until_decided(CLAIMS_CONFIG, tmp_path, 30, rounds) == 3
    assert len(rounds.run) == 1


@pytest.mark.parametrize("most", [0, -1, 1001])
def test_a_number_of_data_sets_is_expected(tmp_path: Path, most: int) -> None:
    rounds = Rounds(tmp_path, [])
    with pytest.raises(ValueError, match=rf"--until-decided {most}: from 1 to 1,000"):
        run_until_decided(CLAIMS_CONFIG, tmp_path, most, rounds)
    assert rounds.run == []


def test_what_would_be_too_large_in_the_end_is_told_before_anything_runs(tmp_path: Path) -> None:
    rounds = Rounds(tmp_path, [])
    with pytest.raises(ConfigError, match=r"experiments\.simulator: asks for .*fewer data sets"):
        run_until_decided(CLAIMS_CONFIG, tmp_path, 1000, rounds)
    assert rounds.run == []


def test_arguments_for_snakemake_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["run", "--config", str(CLAIMS_CONFIG), "--out", str(tmp_path / "out"), "--until-decided", "3"]
    assert main([*line, "--", "--dry-run"]) == 2
    assert "--until-decided: takes no further arguments for Snakemake (--dry-run)" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_copy_of_a_copy_knows_where_the_config_came_from(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    copy = keep_config(keep_config(CLAIMS_CONFIG, tmp_path / "one"), tmp_path / "two")
    assert copied_from(copy) == CLAIMS_CONFIG


def _tiny(folder: Path) -> Path:
    """A study whose second claim is open with one data set, because one fit of each condition decides nothing."""
    config = yaml.safe_load(CLAIMS_CONFIG.read_text(encoding="utf-8"))
    own = config["experiments"]["simulator"]
    own |= {"D": [20], "ROW": [0, 60], "datasets": 1, "seeds": 1, "diagnostics": {"chains": 0}}
    own |= {"generation": {"sentences": 0}, "description": {"actions": 0}}
    tiny = {
        "methods": ["proposed", "no_mec2"],
        "samplers": {"published": {"kind": "blocked", "iterations": 20}},
        "experiments": {"simulator": own},
    }
    path = folder / "tiny.yaml"
    path.write_text(yaml.safe_dump(tiny), encoding="utf-8")
    load_study(path)
    return path


@pytest.mark.slow
def test_a_study_gets_a_second_data_set_and_keeps_its_first(tmp_path: Path) -> None:
    config, out = _tiny(tmp_path), tmp_path / "out"
    run(config, out)
    assert pd.read_csv(out / "claims.csv").set_index("claim").loc[2, "verdict"] == OPEN
    first = (out / "mcap" / "simulator" / "train" / "trial_0001.mcap").stat().st_mtime_ns
    printed = run(config, out, options=("--until-decided", "2"))
    told = [line for line in printed.splitlines() if line.startswith("data sets: ")]
    assert told[0] == "data sets: simulator 1: 1 claim open: 2 (simulator)"
    assert told[1].startswith("data sets: simulator 2: ")
    assert len(told) == 2
    claims = pd.read_csv(out / "claims.csv").set_index("claim")
    assert claims.loc[2, "datasets"] == 2
    assert (out / "mcap" / "simulator" / "train" / "trial_0001.mcap").stat().st_mtime_ns == first
    assert (out / "report.html").is_file()
    assert set(pd.read_csv(out / "scores.csv")["dataset"]) == {1, 2}
