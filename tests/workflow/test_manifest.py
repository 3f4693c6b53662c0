"""The manifest of a study, its verification, and the lineage of an artifact."""

from __future__ import annotations

import errno
import json
import re
from pathlib import Path

import pytest

from tests.workflow.tiny import carry_out, plan
from workflow.artifacts.explain import explain, output_folder
from workflow.artifacts.manifest import read_manifest, verify
from workflow.artifacts.store import Store
from workflow.execution.dag import Plan
from workflow.execution.keeping import Keeper


@pytest.fixture
def out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The output folder of a finished tiny study."""
    (tmp_path / "out").mkdir()
    carry_out(Keeper(tmp_path / "out", Store(tmp_path / "none", limit=0)), tmp_path / "out", plan(), monkeypatch)
    return tmp_path / "out"


def test_it_names_every_artifact_and_what_made_it(out: Path) -> None:
    entries = json.loads((out / "manifest.json").read_text())["artifacts"]
    assert list(entries) == ["fits/1.npz", "fits/more", "mcap/a.mcap", "mcap/b.mcap", "scores.csv"]
    entry = entries["fits/1.npz"]
    assert (entry["rule"], entry["wildcards"], entry["role"]) == ("fit", {"seed": "1"}, "fit")
    assert entry["size"] == (out / "fits" / "1.npz").stat().st_size
    assert entry["inputs"]["x"] == {
        "path": "mcap/b.mcap",
        "sha256": entries["mcap/b.mcap"]["sha256"],
        "key": entries["mcap/b.mcap"]["key"],
        "artifact": True,
    }
    assert entries["mcap/a.mcap"]["parameters"]["seed"] == 1
    assert entries["fits/more"]["files"].keys() == {"one.txt", "two.txt"}


def test_it_has_the_same_bytes_again_and_elsewhere(
    out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "deep" / "other").mkdir(parents=True)
    keeper = Keeper(tmp_path / "deep" / "other", Store(tmp_path / "none", limit=0))
    carry_out(keeper, tmp_path / "deep" / "other", plan(), monkeypatch)
    text = (out / "manifest.json").read_text()
    assert text == (tmp_path / "deep" / "other" / "manifest.json").read_text()
    assert str(tmp_path) not in text


def test_a_sound_study_has_no_problem(out: Path) -> None:
    for beside in (".running", "joblogs/fit.log", "reference/old.csv", ".snakemake/x", "smoke/.artifacts/y"):
        (out / beside).parent.mkdir(exist_ok=True, parents=True)
        (out / beside).write_text("")
    (out / "smoke" / "scores.csv").write_text("of a study of its own")
    assert verify(out) == (5, [])


def test_what_is_wrong_is_named(out: Path) -> None:
    (out / "scores.csv").unlink()
    (out / "fits" / "1.npz").write_text("x")
    (out / "fits" / "more" / "two.txt").write_text("x")
    (out / "fits" / "more" / "three.txt").write_text("x")
    (out / "fits" / "2.npz").write_text("of an earlier config")
    (out / "notes.txt").write_text("x")
    count, problems = verify(out)
    assert count == 5
    kinds = [re.sub(r" \(sha256 .*?\)", "", problem) for problem in problems]
    assert kinds == [
        "changed: fits/1.npz",
        "changed: fits/more: three.txt, two.txt",
        "missing: scores.csv",
        "unexplained: fits/2.npz (not in the manifest)",
        "unexplained: notes.txt (not in the manifest)",
    ]


def test_a_manifest_must_explain_itself(out: Path) -> None:
    data = json.loads((out / "manifest.json").read_text())
    data["artifacts"]["fits/1.npz"]["parameters"]["seed"] = 7
    data["artifacts"]["scores.csv"]["inputs"]["fit"]["sha256"] = "0" * 64
    (out / "manifest.json").write_text(json.dumps(data))
    assert verify(out)[1] == [
        "unexplained: fits/1.npz (its key does not follow from what the manifest says of it)",
        "unexplained: scores.csv (made from another version of fits/1.npz, its input fit)",
    ]


def test_without_a_sound_manifest_nothing_is_verified(out: Path) -> None:
    for damage in ("{", '{"artifacts": {"a": {}}}', "[]"):
        (out / "manifest.json").write_text(damage)
        with pytest.raises(ValueError, match=r"manifest\.json is damaged"):
            read_manifest(out)
    (out / "manifest.json").unlink()
    with pytest.raises(ValueError, match="never run to its end"):
        verify(out)
    with pytest.raises(ValueError, match="there is no folder"):
        verify(out / "nowhere")


def test_a_manifest_that_may_not_be_read_is_not_a_missing_one(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> str:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "read_text", refuse)
    with pytest.raises(ValueError, match=r"manifest\.json cannot be read: Permission denied"):
        verify(out)


def test_an_unfinished_run_leaves_no_manifest(out: Path) -> None:
    Keeper(out, Store(out.parent / "none", limit=0)).decide(Plan(plan(seed=2), whole=False))
    assert not (out / "manifest.json").exists()


def test_lineage_goes_back_to_the_seed(out: Path) -> None:
    path = out / "scores.csv"
    assert output_folder(path) == out
    lines = [re.sub(r"  \[sha256 \w{12}… key \w{12}…\]", "", line) for line in explain(out, "scores.csv")]
    lines = [line for line in lines if "code:" not in line]
    assert lines == [
        "scores.csv",
        "   made by rule scores",
        "└─ fit: fits/1.npz",
        "      made by rule fit seed=1",
        "   └─ x: mcap/b.mcap",
        "         made by rule collect",
        "         seed: 1",
    ]


def test_what_has_no_lineage_is_named(out: Path, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"nothing.csv has no record"):
        list(explain(out, "nothing.csv"))
    with pytest.raises(ValueError, match="not in the output folder of a study"):
        output_folder(tmp_path / "scores.csv")
