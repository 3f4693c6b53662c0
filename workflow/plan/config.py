"""Read a study's config file as plain data, of bounded size."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import yaml

from data_collection.files import replacing
from workflow.plan.typing_slips import not_utf8, odd_characters, read_as_else

MAX_CONFIG_BYTES = 250_000
"""Size of a config file; the largest vocabulary that is allowed fits."""
MAX_CONFIG_VALUES = 20_000
"""Values in a config file: scalars, lists and mappings."""
MAX_NUMBER_LENGTH = 100
"""Characters of a number in a config file."""
MOST_PROBLEMS = 100
"""So many problems are told; the rest is counted."""
COPY = ".config.yaml"  # in the output folder


class ConfigError(ValueError):
    """The config cannot be run; `problems` lists everything that is wrong with it."""

    def __init__(self, source: str, problems: Iterable[str]) -> None:
        self.problems = tuple(problems)
        count = len(self.problems)
        if count > MOST_PROBLEMS:
            self.problems = (*self.problems[:MOST_PROBLEMS], f"and {count - MOST_PROBLEMS} more")
        head = f"{source}: {count} problem{'s' if count > 1 else ''}, nothing was started:"
        super().__init__("\n".join([head, *(f"  {problem}" for problem in self.problems)]))


def read_config(path: Path) -> dict[str, Any]:
    """Read a YAML config as plain data.

    Raises:
        ConfigError: The file is missing, too large, not YAML, not a mapping, has tags or aliases, or has a key twice.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MAX_CONFIG_BYTES + 1)
    except OSError as error:
        raise ConfigError(str(path), [f"cannot be read: {error}"]) from error
    if len(content) > MAX_CONFIG_BYTES:
        raise ConfigError(str(path), [f"larger than {MAX_CONFIG_BYTES:,} bytes, which no config is"])
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ConfigError(str(path), [not_utf8(content, error)]) from error
    try:
        data = yaml.load(text, Loader=_StrictLoader)
    # A number or a date that is none is a ValueError of the library's.
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        told = [f"is not plain YAML: {' '.join(str(error).split())}", *odd_characters(text)]
        raise ConfigError(str(path), told) from error
    if not isinstance(data, dict):
        raise ConfigError(str(path), ["must be a mapping that begins with keys such as `experiments:`"])
    return data


def keep_config(path: Path, out: Path) -> Path:
    """Copy a config into an output folder, so that all processes of a run read the same, whoever edits the file.

    Returns:
        The copy, of which `copied_from` tells where it came from.

    Raises:
        ConfigError: The file cannot be read, or is no plain YAML.
    """
    copy = out / COPY
    with replacing(copy, copy.with_suffix(".origin")) as (content, origin_file):
        content.write_bytes(path.read_bytes())
        origin_file.write_text(str(copied_from(path).resolve()), encoding="utf-8")
    read_config(copy)  # the file may have changed since it was checked
    return copy


def copied_from(path: Path) -> Path:
    """The file that a config was copied from, to whose folder its paths are relative; itself if it is no copy."""
    note = path.with_suffix(".origin")
    return Path(note.read_text(encoding="utf-8")) if path.name == COPY and note.is_file() else path


class _StrictLoader(yaml.SafeLoader):
    """Safe YAML of bounded size without tags, without duplicate keys, and without aliases, which blow a file up."""

    values = 0

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            problem = None
            if not isinstance(key_node, yaml.ScalarNode) or key_node.tag != "tag:yaml.org,2002:str":
                problem = "is not text (quote it)"
            elif key_node.value != key_node.value.strip():
                problem = "has blanks of another kind about it"
            elif key_node.value in seen:
                problem = "stands twice"
            if problem:
                told = f"key {key_node.value!r:.60} {problem}"
                raise yaml.constructor.ConstructorError(None, None, told, key_node.start_mark)
            seen.add(key_node.value)
        return super().construct_mapping(node, deep)

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        self.values += 1
        problem = None
        if isinstance(event, yaml.ScalarEvent) and event.value == "<<" and event.implicit[0]:
            problem = "merge keys (<<) are not used here: write the keys out"
        elif isinstance(event, yaml.AliasEvent):
            problem = "aliases are not used here"
        elif event.tag is not None:
            problem = "tags are not used here"
        elif self.values > MAX_CONFIG_VALUES:
            problem = f"more than {MAX_CONFIG_VALUES:,} values, which no config has"
        if problem:
            raise yaml.composer.ComposerError(None, None, problem, event.start_mark)
        node = super().compose_node(parent, index)
        if isinstance(node, yaml.ScalarNode) and node.tag != "tag:yaml.org,2002:str":
            is_long = len(node.value) > MAX_NUMBER_LENGTH
            problem = "a number that is too long" if is_long else read_as_else(node.tag, node.value)
            if problem:
                raise yaml.composer.ComposerError(None, None, problem, event.start_mark)
        return node
