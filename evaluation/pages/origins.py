"""The sections of a study's report that say how its results were made."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

import pandas as pd
import yaml

from evaluation.pages.page import Part, Section, table
from evaluation.templates import render


def settings(config: str, experiments: Mapping[str, Mapping[str, Any]]) -> Section:
    """Every setting of every experiment, defaults included.

    Args:
        config: Name of the config file.
        experiments: The settings by experiment, plain data.
    """
    # As YAML that reads like a config: lists and innermost mappings on one line.
    style: Any = {"sort_keys": False, "allow_unicode": True, "width": 100, "default_flow_style": None}
    told = {name: str(yaml.safe_dump(dict(own), **style)) for name, own in experiments.items()}
    parts = tuple(Part(f"settings_{name}", name, f"<pre>{escape(text)}</pre>") for name, text in told.items())
    return Section(
        "settings",
        "Settings",
        f"<p>What <code>{escape(config)}</code> says, and the defaults of what it leaves open.</p>",
        folded=True,
        parts=parts,
    )


def versions(python: str, packages: Mapping[str, str], hashes: Mapping[str, str]) -> Section:
    """What the numbers were computed with.

    Args:
        python: The version of Python.
        packages: The pinned version of each package that the project asks for.
        hashes: sha256 of what else decides about the results, by what it is.
    """
    pinned = pd.DataFrame([("Python", python), *packages.items()], columns=["package", "version"])
    digests = pd.DataFrame(list(hashes.items()), columns=["of", "sha256"])
    return Section("versions", "Versions", table(pinned) + table(digests, _code), folded=True)


def _code(column: str, value: object) -> str:
    return f"<code>{escape(str(value))}</code>" if column == "sha256" else escape(str(value))


def reproduction(config: str) -> Section:
    """How to get all this again.

    Args:
        config: The config file, as `make` is told.
    """
    return Section("reproduction", "How to reproduce it", render("reproduction.html", config=config))
