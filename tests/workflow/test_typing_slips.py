"""What people type that YAML takes for something else: the message says what to write instead."""

from __future__ import annotations

import unicodedata
from pathlib import Path

import pytest
import yaml

from tests.docs.conditions import SMOKE, patched
from tests.synthetic import write_own_study
from workflow.plan.config import ConfigError, read_config
from workflow.plan.loading import load_study, plan

PLAIN = """experiments:
  own:
    features: {trials: trials.parquet, objects: objects.parquet}
    words:
      action: [push, lift]
      position: [left, right]
      object: [mug, plate]
      color: [red, blue]
    D: [12]
    seeds: 1
"""
SLIPS = [
    ("[left, right]", "[on, off]", "as in 'on'"),
    ("[left, right]", "[No, right]", "as in 'off'"),
    ("[left, right]", "[~, right]", "put the word in quotes"),
    ("[red, blue]", "[1, blue]", "a word has letters"),
    ("[red, blue]", "[2026-01-01, blue]", "put the word in quotes, as in '2026-01-01'"),
    ("[red, blue]", "[12:30, blue]", "12:30 is read as 750 by YAML"),
    ("D: [12]", "D: [012]", "012 is read as 10 by YAML (write 12, or 10;"),
    ("D: [12]", "D: [1_2]", "1_2 is read as 12 by YAML (write 12;"),
    ("D: [12]", "D: [0xC]", "0xC is read as 12 by YAML (write 12;"),
    ("D: [12]", "D: [1e1]", "write 10"),
    ("D: [12]", "D: [12.0]", "write 12"),
    ("D: [12]", "D: [\uff11\uff12]", "write 12"),
    ("    seeds: 1", "\u3000\u3000seeds: 1", "IDEOGRAPHIC SPACE as a blank"),
    ("    seeds: 1", "\u00a0\u00a0\u00a0\u00a0seeds: 1", "line 10 has NO-BREAK SPACE as a blank"),
    ("    words:", "\twords:", "a tab as a blank"),
    ("seeds: 1", "seeds\uff1a1", "a full-width colon"),
    ("seeds: 1", "seeds:1", "no blank after the colon"),
    ("    seeds: 1\n", "    <<: {seeds: 1}\n", "merge keys (<<) are not used here"),
]


@pytest.mark.bad_input
@pytest.mark.parametrize(("typed", "instead", "says"), SLIPS, ids=[slip[1].strip() for slip in SLIPS])
def test_a_slip_is_told_with_what_to_write(tmp_path: Path, typed: str, instead: str, says: str) -> None:
    path = tmp_path / "config.yaml"
    path.write_text(PLAIN.replace(typed, instead), encoding="utf-8")
    with pytest.raises(ConfigError) as refused:
        plan(read_config(path), path)
    assert says in str(refused.value)


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("encoding", "says"),
    [
        ("utf-16", "it is UTF-16; save it as UTF-8"),
        ("utf-32", "it is UTF-32"),
        ("latin-1", "it is not UTF-8 (line 8, byte 0xfc); save it as UTF-8"),
    ],
)
def test_another_encoding_is_named(tmp_path: Path, encoding: str, says: str) -> None:
    path = tmp_path / "config.yaml"
    path.write_bytes(PLAIN.replace("red", "gr\u00fcn").encode(encoding))
    with pytest.raises(ConfigError) as refused:
        read_config(path)
    assert says in str(refused.value)


def test_usual_numbers_are_read(tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    path.write_text("numbers: [0, -3, +4, 0.5, 1.5e+3, 10]\n", encoding="utf-8")
    assert read_config(path)["numbers"] == [0, -3, 4, 0.5, 1500.0, 10]


def test_words_of_a_config_have_one_normal_form(tmp_path: Path) -> None:
    apart = unicodedata.normalize("NFD", "gr\u00fcn")
    config = write_own_study(tmp_path)
    data = yaml.safe_load(config.read_text(encoding="utf-8"))
    data["experiments"]["own"]["words"]["color"].append(apart)
    assert plan(data, config).experiments["own"].words["color"][-1] == unicodedata.normalize("NFC", apart)
    data["experiments"]["own"]["words"]["color"].append("gr\u00fcn")
    with pytest.raises(ConfigError, match="stands twice"):
        plan(data, config)


def smoke_with(tmp_path: Path, **simulator: object) -> Path:
    config = patched(yaml.safe_load(SMOKE.read_text(encoding="utf-8")), {"experiments": {"simulator": simulator}})
    path = tmp_path / "config.yaml"
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    return path


def test_as_many_objects_are_plausible_as_are_simulated(tmp_path: Path) -> None:
    def most(**simulation: int) -> int:
        study = load_study(smoke_with(tmp_path, simulation=simulation))
        return study.experiments["simulator"].settings.feature_extraction.detection.most_objects

    assert most(objects_most=4) == 4
    assert most(objects_most=2) == 3


@pytest.mark.bad_input
@pytest.mark.parametrize(("key", "given"), [("most_objects", 2), ("fewest_objects", 2)])
def test_counts_that_seeing_would_refuse_are_refused(tmp_path: Path, key: str, given: int) -> None:
    path = smoke_with(tmp_path, feature_extraction={"detection": {key: given}})
    with pytest.raises(ConfigError, match=rf"detection\.{key}: 2 is (less|more) than the [13] objects"):
        load_study(path)
    load_study(smoke_with(tmp_path, feature_extraction={"detection": {key: given, "on_wrong_count": "drop"}}))
