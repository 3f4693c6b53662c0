"""The profiles: which one a run gets, and that the one for clusters knows every rule."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from evaluation.figures.catalogue import FIGURES
from workflow.artifacts.provenance import ROOT
from workflow.execution.engine import PROFILES, command_line

CONFIG = ROOT / "config" / "smoke.yaml"


def profile(name: str) -> dict[str, dict[str, object]]:
    """A profile, as it is written."""
    return yaml.safe_load((PROFILES / name / "config.yaml").read_text(encoding="utf-8"))  # type: ignore[no-any-return]


# A rule and its text; one that a loop makes is indented, and has its name below.
RULE = re.compile(r"^(?:    )?rule ?(\w*):(.+?)(?=^(?:    )?rule|\Z)", re.MULTILINE | re.DOTALL)


def rules() -> list[tuple[str, str]]:
    """The name and text of each rule of all rule files."""
    return [rule for path in (ROOT / "workflow" / "rules").glob("*.smk") for rule in RULE.findall(path.read_text())]


def test_every_rule_has_a_group_on_a_cluster() -> None:
    asked = profile("slurm")
    assert "groups" not in asked
    assert len(rules()) > 15
    for name, text in rules():
        group = re.search(r"^ +group:\n +(.+)$", text, flags=re.MULTILINE)
        assert group is not None, name
        assert set(re.findall(r'(?:^|else )"(\w+)"', group[1])) <= {"data", *asked["group-components"]}, name


def test_resources_are_those_of_rules() -> None:
    assert profile("slurm")["set-resources"].keys() <= {*dict(rules()), *(f"figure_{name}" for name in FIGURES)}


@pytest.mark.parametrize("name", ["slurm", str(PROFILES / "slurm")])
def test_a_profile_is_laid_over_the_default_one(name: str, tmp_path: Path) -> None:
    line = command_line(CONFIG, tmp_path, profile=name)
    given = [word for word in line if word.startswith("--profile=")]
    assert given == [f"--profile={PROFILES / each}" for each in ("default", "slurm")]


def test_cores_are_those_of_the_profile_unless_given(tmp_path: Path) -> None:
    assert "--cores" not in command_line(CONFIG, tmp_path)
    line = command_line(CONFIG, tmp_path, cores=3)
    assert line[line.index("--cores") + 1] == "3"


def test_an_unknown_profile_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"--profile slrum: neither one of default, slurm, nor a folder"):
        command_line(CONFIG, tmp_path, profile="slrum")
