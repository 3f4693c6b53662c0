"""The records of an MCAP file from front to back, with every checksum and every size checked.

A reader that seeks misses most single-bit damage, and the library unpacks chunks to whatever size they claim.
"""

import io
import zlib
from collections.abc import Iterator

import lz4.frame
import zstandard
from mcap.records import Channel, Chunk, DataEnd, Footer, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader

from data_collection.limits import MAX_LOG_BYTES

_TAIL = 12  # bytes: checksum of the summary, closing magic


class DamageError(ValueError):
    """The bytes are no sound MCAP file, or unpack to more than is read."""


def records(content: bytes) -> Iterator[McapRecord]:
    """Yield every record, those inside chunks too.

    Raises:
        DamageError: The file is truncated, damaged or too large; the library raises errors of many other types.
    """
    stream = io.BytesIO(content)
    left = MAX_LOG_BYTES
    ended, footer = False, None
    # A damaged length must not be taken at its word: no record is larger than the file, chunks are inside one.
    reader = StreamReader(stream, emit_chunks=True, validate_crcs=True, record_size_limit=len(content))
    for record in reader.records:
        match record:
            case Chunk():
                data = _unpacked(record, left)
                left -= len(data)
                yield from _inner_records(data)
                continue
            case DataEnd():
                ended = True
            case Footer():
                footer = record
        yield record
    if not ended or footer is None or stream.read(1):
        raise DamageError("the file is truncated, or something follows its end")
    # The reader leaves out this one: from the start of the summary to the checksum itself.
    if footer.summary_crc and footer.summary_crc != zlib.crc32(content[footer.summary_start : -_TAIL]):
        raise DamageError("damaged (checksum of the summary)")


def _unpacked(chunk: Chunk, limit: int) -> bytes:
    """Return the content of a chunk; never unpack more than it says, nor more than `limit`."""
    size = chunk.uncompressed_size
    if size > limit:
        raise DamageError(f"the chunks unpack to more than {MAX_LOG_BYTES:,} bytes, the most that is read")
    data: bytes
    match chunk.compression:
        case "":
            data = chunk.data
        case "zstd":
            with zstandard.ZstdDecompressor().stream_reader(chunk.data) as unpacking:
                data = unpacking.read(size + 1)
        case "lz4":
            data = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
        case _:
            raise DamageError(f"a chunk is compressed by {chunk.compression!r}; zstd, lz4 or none is expected")
    if len(data) != size:
        raise DamageError(f"a chunk does not unpack to the {size:,} bytes that it says")
    if chunk.uncompressed_crc and chunk.uncompressed_crc != zlib.crc32(data):
        raise DamageError("damaged (checksum of a chunk)")
    return data


def _inner_records(data: bytes) -> Iterator[McapRecord]:
    stream = io.BytesIO(data)
    found = StreamReader(stream, skip_magic=True, emit_chunks=True, record_size_limit=len(data)).records
    while stream.tell() < len(data):
        record = next(found)  # at the end it would raise: a chunk has no footer
        if not isinstance(record, Schema | Channel | Message):
            raise DamageError(f"a chunk holds a {type(record).__name__}; schema, channel or message is expected")
        yield record
