"""The columns of the two Parquet files of a feature table: the one place that names and describes them.

The reader, the writer, the checks and the tables of docs/features.md derive from it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import pyarrow as pa

Kind = Literal["integer", "text", "words", "vector"]

EXPECTED: Mapping[Kind, Any] = {
    "integer": pa.int64(),
    "text": pa.string(),
    "words": pa.list_(pa.string()),
    "vector": pa.list_(pa.float64()),
}
"""Arrow type of each kind of column."""


Words = Mapping[str, Sequence[str]]
"""An experiment's words of each channel."""


@dataclass(frozen=True)
class Column:
    """One column of a file.

    Attributes:
        name: Its name in the file.
        kind: `integer` (int64), `text` (string), `words` (list of string) or `vector` (list of double).
        meaning: What it holds, for the documentation.
        required: Whether the file must have it; a column that is not required may also be all null.
        nullable: Whether a value may be null.
        length: Length of every vector; None if any length will do, as long as all rows agree.
        histogram: Whether a vector must be non-negative and sum to 1.
        channel: The channel whose words a text must be one of.
    """

    name: str
    kind: Kind
    meaning: str
    required: bool = True
    nullable: bool = False
    length: int | None = None
    histogram: bool = False
    channel: str | None = None


def _truth(channel: str) -> Column:
    return Column(
        f"truth_{channel}", "text", f"the true {channel} word", required=False, nullable=True, channel=channel
    )


FILES: Mapping[str, tuple[Column, ...]] = {
    "trials": (
        Column("trial", "integer", "unique"),
        Column(
            "attended_object",
            "integer",
            "index of the attended object in its trial, from 0; in instructions the instructed object "
            "(truth, not for the model); null if unknown, which training does not allow",
            nullable=True,
        ),
        Column("words", "words", "the sentence as uttered; may be empty"),
        Column("action", "vector", "one length in all rows; 38 here; zeros in instructions, where nothing was done"),
        _truth("action"),
    ),
    "objects": (
        Column("trial", "integer", "the trial that the object belongs to"),
        Column("object", "integer", "0 … M − 1 in each trial; here from left to right in the image"),
        Column("position", "vector", "metres on the table, robot frame: x ahead, y left", length=2),
        Column("object_feature", "vector", "one length in all rows"),
        Column(
            "color",
            "vector",
            "one length; not negative, sums to 1 (± 10⁻⁶; what rounding explains is divided by its sum, and noted)",
            histogram=True,
        ),
        _truth("position"),
        _truth("object"),
        _truth("color"),
    ),
}


def markdown(file: str) -> str:
    """The columns of a file as a Markdown table."""
    lines = [f"| {file} | type | meaning |", "| --- | --- | --- |"]
    for column in FILES[file]:
        length = f"{column.length} " if column.length else ""
        kind = {"integer": "int64", "text": "string", "words": "list of string", "vector": f"list of {length}double"}
        note = "" if column.required else "; may be null or absent"
        lines.append(f"| {column.name} | {kind[column.kind]} | {column.meaning}{note} |")
    return "\n".join(lines)
