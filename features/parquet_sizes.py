"""How much a Parquet file unpacks to, from its footer and the headers of its pages, before anything is unpacked.

pyarrow tells what the footer says, but not what the pages say, which its reader goes by; and it ends the whole
process where statistics in a footer are damaged. Both are written in Thrift's compact protocol, of which a few lines
read all that is needed (https://parquet.apache.org/docs/file-format/metadata/).
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

MAGIC = b"PAR1"
MAX_FOOTER_BYTES = 2**22
"""Bytes of a footer: thousands of column chunks."""
MAX_PAGES = 100_000
"""Pages of a file."""
_HEADER_BYTES = 2**16  # of a page's header, which holds only numbers and statistics
_MAX_DEPTH = 16
_DICTIONARY = 2


@dataclass(frozen=True)
class Sizes:
    """What a file says to hold.

    Attributes:
        rows: its rows.
        unpacked: bytes of all pages unpacked.
        values: number of values of each of its columns, lists counted by what they hold.

    """

    rows: int
    unpacked: int
    values: tuple[int, ...]


def sizes(path: Path) -> Sizes:
    """Read the sizes of a file.

    Raises:
        ValueError: the file is no Parquet file, is damaged, or its pages and its footer say different things.

    """
    with path.open("rb") as file:
        try:
            return _sizes(file)
        except (KeyError, TypeError, IndexError, AttributeError, struct.error, RecursionError) as error:
            raise ValueError(f"damaged ({type(error).__name__}: {error})") from error


def _sizes(file: BinaryIO) -> Sizes:
    end = file.seek(0, io.SEEK_END)
    file.seek(max(0, end - 8))
    tail = file.read(8)
    length = int.from_bytes(tail[:4], "little")
    if tail[4:] != MAGIC or not 0 < length <= min(end - 12, MAX_FOOTER_BYTES):
        raise ValueError("no footer of a Parquet file, or one that is too long")
    file.seek(end - 8 - length)
    footer = _struct(io.BytesIO(file.read(length)))
    groups = [[column[3] for column in group[1]] for group in footer[4]]
    unpacked, left = 0, MAX_PAGES
    for chunk in (chunk for group in groups for chunk in group):
        values = 0
        for page_bytes, page_values in _pages(file, chunk, end):
            unpacked, values, left = unpacked + page_bytes, values + page_values, left - 1
            if left < 0:
                raise ValueError(f"more than {MAX_PAGES:,} pages")
        if values != chunk[5]:
            raise ValueError(f"a column's pages hold {values:,} values, but the footer says {chunk[5]:,}")
    rows = sum(group[3] for group in footer[4])
    if rows != footer[3]:
        raise ValueError("the parts of the file do not have as many rows as the whole")
    columns = zip(*groups, strict=True) if groups else ()
    return Sizes(rows, unpacked, tuple(sum(chunk[5] for chunk in column) for column in columns))


def _pages(file: BinaryIO, chunk: dict[int, Any], end: int) -> Iterator[tuple[int, int]]:
    """Yield the unpacked bytes of each page of a column chunk, and how many values it adds."""
    if not chunk[5] and not chunk[7]:
        return
    at = min(offset for offset in (chunk[9], chunk.get(11, 0)) if offset)  # of the data, of a dictionary
    stop = at + chunk[7]
    if not 4 <= at <= stop <= end:
        raise ValueError("a column lies outside the file")
    while at < stop:
        file.seek(at)
        stream = io.BytesIO(file.read(_HEADER_BYTES))
        page = _struct(stream)
        if min(page[2], page[3]) < 0:
            raise ValueError("a page has less than no bytes")
        kind = page.get(5) or page.get(8)
        yield page[2], 0 if page[1] == _DICTIONARY or kind is None else _count(kind[1])
        at += stream.tell() + page[3]


def _count(number: int) -> int:
    if number < 0:
        raise ValueError("a page has less than no values")
    return number


def _varint(stream: BinaryIO) -> int:
    number = shift = 0
    while True:
        byte = stream.read(1)[0]
        number |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            return number
        if shift > 63:
            raise ValueError("a number is too long")


def _zigzag(stream: BinaryIO) -> int:
    number = _varint(stream)
    return (number >> 1) ^ -(number & 1)


def _struct(stream: BinaryIO, depth: int = 0) -> dict[int, Any]:
    """The fields of a struct by their number."""
    fields: dict[int, Any] = {}
    number = 0
    while head := stream.read(1)[0]:
        number = number + (head >> 4) if head >> 4 else _zigzag(stream)
        kind = head & 15
        fields[number] = kind == 1 if kind in (1, 2) else _value(stream, kind, depth + 1)
    return fields


def _value(stream: BinaryIO, kind: int, depth: int) -> Any:
    if depth > _MAX_DEPTH:
        raise ValueError("nested too deep")
    match kind:
        case 1 | 2 | 3:
            return stream.read(1)[0]
        case 4 | 5 | 6:
            return _zigzag(stream)
        case 7:
            return struct.unpack("<d", stream.read(8))[0]
        case 8:
            return stream.read(_varint(stream))
        case 9 | 10:
            head = stream.read(1)[0]
            size = head >> 4 if head >> 4 < 15 else _varint(stream)
            return [_value(stream, head & 15, depth + 1) for _ in range(size)]
        case 12:
            return _struct(stream, depth + 1)
    raise ValueError(f"a field of unknown type {kind}")
