"""The examples of docs/conditions.md.

`python -m tests.docs.conditions OUT` writes into the page what each one would run, OUT being the folder of a finished
smoke study.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from tests.docs.pages import ROOT

PAGE = ROOT / "docs" / "conditions.md"
SMOKE = ROOT / "config" / "smoke.yaml"
_EXAMPLE = re.compile(
    r"^## (?P<name>.+?)$.*?```yaml\n(?P<patch>.*?)```\n\n(?P<jobs>\d+ jobs\b[^\n]*)\.$", re.M | re.S
)


@dataclass(frozen=True)
class Example:
    """One example: what it is about, the change of the config, and what the page says that it runs."""

    name: str
    patch: Mapping[str, Any]
    jobs: str


def examples() -> Iterator[Example]:
    """The examples of the page."""
    for found in _EXAMPLE.finditer(PAGE.read_text(encoding="utf-8")):
        yield Example(found["name"], yaml.safe_load(found["patch"]), found["jobs"])


def patched(config: Mapping[str, Any], patch: Mapping[str, Any]) -> dict[str, Any]:
    """A config with a change: mappings are merged, anything else is replaced."""
    both = {
        key: patched(config[key], value) if isinstance(value, Mapping) and key in config else value
        for key, value in patch.items()
    }
    return {**config, **both}


def prepare(place: Path, out: Path, patch: Mapping[str, Any]) -> Path:
    """Write the changed config and the data of one's own that examples name below a folder; return the config's path.

    The data are those of a finished smoke study.
    """
    if not (place / "my_logs").exists():
        shutil.copytree(out / "mcap" / "simulator", place / "my_logs")
        (place / "my_features").mkdir()
        for kind in ("trials", "objects"):
            source = out / "features" / "simulator" / "D6" / f"train_{kind}.parquet"
            shutil.copy(source, place / "my_features" / f"{kind}.parquet")
    config = place / "config" / "changed.yaml"
    config.parent.mkdir(exist_ok=True)
    merged = patched(yaml.safe_load(SMOKE.read_text(encoding="utf-8")), patch)
    config.write_text(yaml.safe_dump(merged, sort_keys=False), encoding="utf-8")
    return config


def in_words(jobs: Mapping[str, int]) -> str:
    """How the page says which jobs are run; the blocks of trials count as one rule, and the figures as well."""
    merged: Counter[str] = Counter()
    for rule, count in jobs.items():
        merged[re.sub("^(collect|figure)_.*", r"\1", rule)] += count
    ordered = sorted(merged.items(), key=lambda item: (-item[1], item[0]))
    return f"{sum(merged.values())} jobs: " + ", ".join(f"{count} {rule}" for rule, count in ordered)


def planned(printed: str) -> dict[str, int]:
    """The number of jobs of each rule in the table that a dry run prints."""
    rows = dict(re.findall(r"^([\w.]+) +(\d+)$", printed, flags=re.MULTILINE))
    return {rule: int(count) for rule, count in rows.items() if rule != "total"}


def main(out: Path) -> None:
    """Write the numbers of jobs into the page."""
    text = PAGE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        for example in examples():
            config = prepare(Path(folder), out, example.patch)
            run = [sys.executable, "-m", "workflow", "run", "--config", str(config), "--out", str(out.absolute())]
            done = subprocess.run([*run, "--", "--dry-run"], cwd=ROOT, capture_output=True, text=True, check=True)
            head, _, tail = text.partition(f"## {example.name}\n")
            now = in_words(planned(done.stdout + done.stderr))
            text = f"{head}## {example.name}\n{tail.replace(f'{example.jobs}.', f'{now}.', 1)}"
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
