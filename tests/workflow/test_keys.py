"""Keys: different work never shares one, equal work always does."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml
from snakemake.iocontainers import InputFiles

from tests.workflow.runs import copy_project
from workflow.artifacts.keys import job_key, output_key, plain
from workflow.artifacts.provenance import ROOT
from workflow.execution import engine
from workflow.execution.dag import Job, keys_of
from workflow.execution.roles import by_role

CONFIG = ROOT / "config" / "config.yaml"


def no_source(path: str) -> str:
    raise AssertionError(f"the study has no file from elsewhere, but {path}")


def identities(jobs: list[Job], known: dict[Any, int]) -> list[int]:
    """A number for each job, equal for equal work; found by comparing, without a hash."""
    made: dict[str, tuple[int, str]] = {}
    numbers = []
    for job in jobs:
        inputs = tuple(sorted((role, made[path]) for role, path in job.inputs.items()))
        parameters = json.dumps(plain(job.parameters), sort_keys=True)
        whole = (job.rule, tuple(sorted(job.wildcards.items())), parameters, inputs)
        numbers.append(known.setdefault(whole, len(known)))
        made |= {path: (numbers[-1], role) for role, path in job.outputs.items()}
    return numbers


def test_the_study_shares_keys_exactly_where_work_is_equal(tmp_path: Path) -> None:
    """The full study, in two output folders, and a larger one: same key if and only if same work."""
    config = yaml.safe_load(CONFIG.read_text(encoding="utf-8"))
    for experiment in config["experiments"].values():
        experiment["ROW"] = [*experiment["ROW"], 80]
    config["experiments"]["simulator"]["variants"] = {"default": {}, "few": {"K": 5}}
    larger = tmp_path / "larger.yaml"
    larger.write_text(yaml.safe_dump(config))
    known: dict[Any, int] = {}
    work_of_key: dict[str, set[int]] = {}
    key_of_work: dict[int, set[str]] = {}
    sizes = []
    for config_file, out in ((CONFIG, "a"), (CONFIG, "elsewhere/b"), (larger, "c")):
        (tmp_path / out).mkdir(parents=True)
        jobs = engine.planned(config_file, tmp_path / out)
        sizes.append(len(jobs))
        for key, number in zip(keys_of(jobs, no_source), identities(jobs, known), strict=True):
            work_of_key.setdefault(key, set()).add(number)
            key_of_work.setdefault(number, set()).add(key)
    assert sizes[0] == sizes[1] > 600
    assert sizes[2] > sizes[0]
    assert len(known) < sizes[0] + sizes[2]  # the larger study shares with the other
    assert {len(numbers) for numbers in work_of_key.values()} == {1}
    assert {len(keys) for keys in key_of_work.values()} == {1}


TRIALS, OBJECTS = output_key("features", "trials"), output_key("features", "objects")
BASE: dict[str, Any] = {
    "rule": "fit",
    "wildcards": {"seed": "1"},
    "parameters": {"code": "c", "iterations": 200, "priors": {"K": 10}},
    "inputs": {"trials": TRIALS, "objects": OBJECTS},
}


@pytest.mark.parametrize(
    "change",
    [
        {"wildcards": {"seed": "2"}},
        {"inputs": {"trials": OBJECTS, "objects": TRIALS}},
        {"inputs": {"trials": OBJECTS, "objects": OBJECTS}},
        {"parameters": {**BASE["parameters"], "code": "d"}},
        {"parameters": {**BASE["parameters"], "priors": {"K": 9}}},
        {"rule": "refit"},
    ],
    ids=["wildcard", "roles swapped", "another output of the same job", "code or packages", "config", "rule"],
)
def test_holes_of_snakemakes_own_cache_are_closed(change: dict[str, Any]) -> None:
    assert job_key(**{**BASE, **change}) != job_key(**BASE)


def test_order_of_names_does_not_matter() -> None:
    turned = {
        name: dict(reversed(value.items())) if isinstance(value, dict) else value for name, value in BASE.items()
    }
    assert job_key(**turned) == job_key(**BASE)


def test_outputs_of_one_job_differ() -> None:
    assert output_key("job", "trials") != output_key("job", "objects")


@dataclass(frozen=True)
class Table:
    title: str
    rows: tuple[int, ...]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ((1, 2), [1, 2]),
        (range(2), [0, 1]),
        (Table("t", (1,)), {"title": "t", "rows": [1]}),
        ({"a": None}, {"a": None}),
    ],
)
def test_plain(value: Any, expected: Any) -> None:
    assert plain(value) == expected


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ({"files": ["/home/somebody/x"]}, "params.files[0]: '/home/somebody/x' is an absolute path"),
        ({1: 2}, "key 1 is not text"),
        ({"a": {1, 2}}, "params.a: a set cannot be part of a key"),
        ({"a": Path("x")}, "cannot be part of a key"),
    ],
)
def test_what_cannot_be_part_of_a_key(value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        plain(value, "params")


def test_code_must_be_told() -> None:
    with pytest.raises(ValueError, match="rule fit has no parameter code=tracked"):
        job_key("fit", {}, {"seed": 1}, {})


def test_roles() -> None:
    files = InputFiles(["a", "b", "c", "d"])
    files._set_name("logs", 1, 3)
    files._set_name("fit", 3)
    assert by_role(files) == {"[0]": "a", "logs[0]": "b", "logs[1]": "c", "fit": "d"}


def test_files_from_elsewhere_count_by_content() -> None:
    def key(path: str, content: str) -> str:
        job = Job("take", {}, {"code": "c"}, {"trials": path}, {"table": "t"})
        return keys_of([job], {path: content}.__getitem__)[0]

    assert key("/here/x.parquet", "1") == key("/there/y.parquet", "1") != key("/here/x.parquet", "2")
    with pytest.raises(ValueError, match="rule take, input trials: x is made by no rule"):
        key("x", "1")


@dataclass
class Copy:
    """A copy of the project that a test may change."""

    folder: Path

    def plan(self, succeeds: bool = True) -> dict[str, str]:
        """The key of each job by its outputs; without success what was printed, as `error`."""
        code = (
            "import sys, json, pathlib\n"
            "from workflow.execution.dag import keys_of\n"
            "from workflow.execution.engine import planned\n"
            "jobs = planned(pathlib.Path('config/smoke.yaml'), pathlib.Path('out'))\n"
            "pairs = zip(jobs, keys_of(jobs, str), strict=True)\n"
            "print('KEYS', json.dumps({' '.join(job.outputs.values()): key for job, key in pairs}))"
        )
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=self.folder, capture_output=True, text=True, check=False
        )
        assert (done.returncode == 0) is succeeds, done.stdout + done.stderr
        if not succeeds:
            return {"error": done.stdout + done.stderr}
        found: dict[str, str] = json.loads(done.stdout.partition("KEYS ")[2])
        return found

    def changed(self, before: dict[str, str]) -> set[str]:
        """The first parts of the paths of artifacts that have another key now."""
        after = self.plan()
        return {path.partition("/")[0] for path in before if after[path] != before[path]}

    def edit(self, path: str, change: Callable[[str], str]) -> None:
        file = self.folder / path
        before = file.read_text(encoding="utf-8")
        assert change(before) != before
        file.write_text(change(before), encoding="utf-8")


@pytest.fixture
def project(tmp_path: Path) -> Copy:
    copy_project(tmp_path)
    (tmp_path / "out").mkdir()
    return Copy(tmp_path)


def other_formula(source: str) -> str:
    """The source of a module in which the first sum, difference or product is a quotient."""
    tree = ast.parse(source)
    arithmetic = ast.Add | ast.Sub | ast.Mult
    found = next(node for node in ast.walk(tree) if isinstance(node, ast.BinOp) and isinstance(node.op, arithmetic))
    found.op = ast.Div()
    return ast.unparse(tree)


def other_words(source: str) -> str:
    """The source of a module in another layout, without its comments, and with other docstrings."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        if isinstance(node, documented) and ast.get_docstring(node) is not None:
            node.body[0] = ast.Expr(ast.Constant("Other words."))
    return ast.unparse(tree) + "\n# A comment.\n"


def test_a_change_reruns_the_stages_that_use_it_and_what_follows(project: Copy) -> None:
    base = project.plan()
    project.edit("evaluation/metrics.py", lambda text: f"{text}\nMORE = 1\n")
    touched = project.changed(base)
    assert "scores" in touched
    assert touched.isdisjoint({"mcap", "percepts", "features", "fits"})
    base = project.plan()
    [sampler] = (project.folder / "model").rglob("blocked.py")
    project.edit(str(sampler), other_formula)
    touched = project.changed(base)
    assert {"fits", "scores", "tables"} <= {path.partition(".")[0] for path in touched}
    assert touched.isdisjoint({"mcap", "percepts", "features"})
    base = project.plan()
    project.edit("environment.lock", lambda text: f"{text}another-package==1.0\n")
    assert project.changed(base) == {path.partition("/")[0] for path in base}


def test_words_and_layout_rerun_nothing(project: Copy) -> None:
    """Comments and docstrings of all modules, and messages of what runs the jobs."""
    base = project.plan()
    for path in sorted(project.folder.rglob("*.py")):
        project.edit(str(path), other_words)
    for module in ("workflow/execution/turns.py", "workflow/artifacts/records.py", "workflow/plan/config.py"):
        project.edit(module, lambda text: re.sub(r"\bf'", "f'Reworded: ", text))
    assert project.changed(base) == set()


def test_messages_of_stages_count(project: Copy) -> None:
    """Such a string may be data."""
    base = project.plan()
    project.edit("features/table.py", lambda text: f'{text}\nMESSAGE = "words"\n')
    assert {"features", "fits"} <= project.changed(base)


def test_the_format_stands_in_every_key(project: Copy) -> None:
    base = project.plan()
    project.edit("workflow/artifacts/provenance.py", lambda text: re.sub(r"(?m)^FORMAT = ", "FORMAT = 1", text))
    assert project.changed(base) == {path.partition("/")[0] for path in base}


@pytest.mark.parametrize(
    ("file", "change", "message"),
    [
        (
            "workflow/rules/model.smk",
            lambda text: text.replace('tracked("fit.py")', 'tracked("scores.py")'),
            "rule fit: its parameter code must be tracked('fit.py')",
        ),
        (
            "workflow/rules/evaluation.smk",
            lambda text: text.replace(
                '    script:\n        "../scripts/scores.py"', '    shell:\n        "cat {input} > {output}"'
            ),
            "rule scores has no script",
        ),
    ],
)
def test_rules_that_keys_cannot_follow_are_refused(
    project: Copy, file: str, change: Callable[[str], str], message: str
) -> None:
    """A `run:` or `shell:` body, or the hash of another script's code."""
    project.edit(file, change)
    assert message in project.plan(succeeds=False)["error"]


def test_a_file_of_weights_counts_by_its_content(tmp_path: Path) -> None:
    """Of feature extraction; where it lies is in no key."""
    config = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text(encoding="utf-8"))
    config["experiments"]["simulator"]["feature_extraction"] = {"weights": "weights.pt"}
    found = []
    for folder, content in (("a", "1"), ("b", "1"), ("c", "2")):
        (tmp_path / folder / "out").mkdir(parents=True)
        (tmp_path / folder / "weights.pt").write_text(content)
        (tmp_path / folder / "config.yaml").write_text(yaml.safe_dump(config))
        jobs = engine.planned(tmp_path / folder / "config.yaml", tmp_path / folder / "out")
        keys = keys_of(jobs, lambda path: Path(path).read_text())
        found.append({job.rule: key for job, key in zip(jobs, keys, strict=True)})
    assert found[0] == found[1]
    changed = {rule for rule in found[0] if found[0][rule] != found[2][rule]}
    assert {"perceive", "features", "fit"} <= changed
    assert not any("collect" in rule for rule in changed)
