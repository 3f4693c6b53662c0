"""Each example of docs/conditions.md runs what the page says that it runs, and nothing else."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from model import Prior
from tests.docs.conditions import PAGE, Example, examples, in_words, patched, planned, prepare
from tests.workflow.runs import forget, jobs
from workflow.plan.variants import HYPERPARAMETERS

EXAMPLES = list(examples())
RUN = [sys.executable, "-m", "workflow", "run", "--config", "config/changed.yaml", "--out", "results"]
# Run for real, too; of each other example, which has jobs of the same kinds, the plan alone is compared.
REAL = {
    "A rate of omitted words",
    "A number of trials",
    "A method",
    "New objects, colors and words",
    "Logs of your own",
    "Features of your own",
}


def test_the_page_has_an_example_of_each_kind() -> None:
    assert len(EXAMPLES) == PAGE.read_text(encoding="utf-8").count("```yaml") == 13
    assert {example.name for example in EXAMPLES} >= REAL


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES, ids=[example.name.replace(" ", "-") for example in EXAMPLES])
def test_an_example_runs_what_the_page_says(
    example: Example, repository: Path, in_repository: Callable[..., str]
) -> None:
    prepare(repository, repository / "results", example.patch)
    in_repository(sys.executable, "-m", "workflow", "check", "--config", "config/changed.yaml")
    assert in_words(planned(in_repository(*RUN, "--", "--dry-run"))) == example.jobs
    if example.name in REAL:
        forget(repository / "results")
        in_repository(*RUN)
        assert in_words(jobs(repository / "results")) == example.jobs
        forget(repository / "results")
        in_repository(*RUN)
        assert jobs(repository / "results") == {}


def test_a_patch_merges_mappings_and_replaces_the_rest() -> None:
    config = {"seed": 1, "experiments": {"a": {"D": [6], "ROW": [0]}}}
    patch = {"experiments": {"a": {"D": [6, 9]}, "b": {"D": [3]}}}
    assert patched(config, patch) == {"seed": 1, "experiments": {"a": {"D": [6, 9], "ROW": [0]}, "b": {"D": [3]}}}


def test_hyperparameters_have_the_documented_defaults() -> None:
    rows = [line.split(" | ") for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    documented = {cells[0].strip("|` "): yaml.safe_load(cells[2]) for cells in rows}
    defaults = Prior().model_dump(mode="json")
    assert documented == {key: defaults[name] for key, name in HYPERPARAMETERS.items()}
