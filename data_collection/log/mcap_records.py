"""The records of an MCAP file from front to back, with every checksum and every size checked.

A reader that seeks misses most single-bit damage, and the library unpacks chunks to whatever size they claim. What
the format leaves to the writer may be missing: chunks, indexes, the summary, the end of the data, checksums.
"""

import io
import zlib
from collections.abc import Iterator

import lz4.frame
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, DataEnd, Footer, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader

from data_collection.limits import MAX_LOG_BYTES
from data_collection.log.file_kinds import CUT, foreign, is_cut

_TAIL = 12  # bytes: checksum of the summary, closing magic
_KNOWN = {int(opcode) for opcode in Opcode}


class DamageError(ValueError):
    """The bytes are no sound MCAP file, or unpack to more than is read."""


def records(content: bytes) -> Iterator[McapRecord]:
    """Yield every record, those inside chunks too; records of kinds that the format may get later are passed over.

    Raises:
        DamageError: The file is another one, truncated, damaged or too large; the library raises errors of many
            other types.
    """
    if says := foreign(content):
        raise DamageError(says)
    stream = io.BytesIO(content)
    left = MAX_LOG_BYTES
    footer = None
    begins = 0  # the summary: behind the end of the data, or, where this is not marked, at the footer
    # A damaged length must not be taken at its word: no record is larger than the file, chunks are inside one.
    reader = StreamReader(stream, emit_chunks=True, validate_crcs=True, record_size_limit=len(content))
    found = reader.records
    while True:
        before = stream.tell()
        try:
            record = next(found, None)
        except Exception as error:
            if is_cut(content):
                raise DamageError(f"{CUT} ({type(error).__name__} at byte {before:,} of {len(content):,})") from error
            raise
        match record:
            case None:
                break
            case Chunk():
                data = _unpacked(record, left)
                left -= len(data)
                yield from _inner_records(data)
                continue
            case DataEnd():
                begins = stream.tell()
            case Footer():
                footer = record
                begins = record.summary_start or begins or before
        yield record
    if footer is None:
        raise DamageError(CUT)
    if extra := len(stream.read()):
        raise DamageError(f"{extra:,} bytes follow the end of the MCAP file; cut them off, or record again")
    # The reader leaves out this one: from the start of the summary to the checksum itself.
    if footer.summary_crc and footer.summary_crc != zlib.crc32(content[begins:-_TAIL]):
        raise DamageError("damaged (checksum of the summary)")


def _unpacked(chunk: Chunk, limit: int) -> bytes:
    """Return the content of a chunk; never unpack more than it says, nor more than `limit`."""
    size = chunk.uncompressed_size
    if size > limit:
        raise DamageError(f"the chunks unpack to more than {MAX_LOG_BYTES:,} bytes, the most that is read")
    data: bytes
    match chunk.compression:
        case "" | "none":
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
    stream = ReadDataStream(io.BytesIO(data))
    while stream.count < len(data):
        opcode, length = stream.read1(), stream.read8()
        if length > len(data) - stream.count:
            raise DamageError("damaged: a record of a chunk is longer than the chunk")
        one = ReadDataStream(io.BytesIO(stream.read(length)))
        match opcode:
            case Opcode.SCHEMA:
                yield Schema.read(one)
            case Opcode.CHANNEL:
                yield Channel.read(one)
            case Opcode.MESSAGE:
                yield Message.read(one, length)
            case _ if opcode in _KNOWN:
                name = Opcode(opcode).name.title().replace("_", "")
                raise DamageError(f"a chunk holds a {name}; schema, channel or message is expected")
