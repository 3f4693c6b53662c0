"""Files of strangers that call themselves logs: bad images, absurd sizes, bombs, damage, random bytes."""

from __future__ import annotations

import dataclasses
import functools
import re
import struct
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any

import lz4.frame
import numpy as np
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st

from data_collection.limits import MAX_LOG_BYTES
from data_collection.log import codec, topics
from data_collection.log.mcap_log import Log, LogError, Message, write_log
from data_collection.log.topics import BY_TOPIC, TOPICS
from data_collection.log.validation import problems
from data_collection.log_differences import differences
from tests.bounded import errors_within
from tests.data_collection.broken_logs import TIME, kind_with, messages, metadata, refusal, sound, use
from tests.data_collection.raw_mcap import (
    channel_record,
    chunk_record,
    log_file,
    message_record,
    record,
    schema_record,
    whole,
    zstd_of_zeros,
)
from tests.fuzz import FEW, MANY, MUTATIONS, Mutation, examples, mutated


def png(width: int, height: int) -> bytes:
    """A PNG that is nothing but its header."""
    header = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    pixels = b"IDAT" + zlib.compress(bytes(1000))
    chunks = [
        struct.pack(">I", len(part) - 4) + part + struct.pack(">I", zlib.crc32(part)) for part in (header, pixels)
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def jpeg(width: int, height: int) -> bytes:
    size = struct.pack(">HBHHB", 11, 8, height, width, 1) + b"\1\x11\0"
    return b"\xff\xd8\xff\xc0" + size + b"\xff\xda\0\x08\1\1\0\0\x3f\0" + bytes(100) + b"\xff\xd9"


IMAGES = {
    "nothing": b"",
    "text": b"no image",
    "png of 100,000 × 100,000": png(100_000, 100_000),
    "png of 2,147,483,647 × 1": png(2**31 - 1, 1),
    "png of 5,000 × 5,000": png(5000, 5000),
    "png that ends early": png(64, 64),
    "png of no size": png(0, 0),
    "jpeg of 65,500 × 65,500": jpeg(65_500, 65_500),
    "bmp": b"BM"
    + struct.pack("<IHHIIiiHHIIiiII", 4000, 0, 0, 54, 40, 32, 32, 1, 24, 0, 3072, 0, 0, 0, 0)
    + bytes(3072),
    "gif": b"GIF89a" + struct.pack("<HHBBB", 40, 40, 0, 0, 0),
}


def with_image(data: bytes) -> bytes:
    """A log whose picture before the action is these bytes."""
    store: Any = codec._store()
    message = store.deserialize_cdr(messages("trial")[0].data, topics.IMAGE)
    message.data = np.frombuffer(data, dtype=np.uint8)
    raw = dataclasses.replace(messages("trial")[0], data=bytes(store.serialize_cdr(message, topics.IMAGE)))
    assert raw.topic == topics.IMAGE_BEFORE
    return log_file([raw, *messages("trial")[1:]], metadata("trial"))


@pytest.mark.bad_input
@pytest.mark.parametrize("name", IMAGES)
def test_a_bad_image_is_refused(tmp_path: Path, name: str) -> None:
    says = refusal(tmp_path, with_image(IMAGES[name]))
    assert f"{topics.IMAGE_BEFORE} at {TIME} ns cannot be decoded" in says


DEFINED = schema_record(1, topics.TEXT) + channel_record(1, 1, topics.SENTENCE)
FOREIGN = channel_record(7, 0, "/" + "x" * 2**24)
PACKED = chunk_record(zstandard.compress(FOREIGN), "zstd", len(FOREIGN))
NESTED = chunk_record(DEFINED, "", len(DEFINED))
BOMB = zstd_of_zeros(2**32)
FRAMES: dict[str, tuple[bytes, str]] = {
    "a channel that is not defined": (whole(message_record(9, TIME, b"")), f"{TIME} ns is on channel 9"),
    "a channel that is defined twice": (whole(DEFINED, channel_record(1, 1, topics.TF)), "channel 1 is defined"),
    "a schema that is defined twice": (whole(DEFINED, schema_record(1, "x/msg/Y")), "schema 1 is defined twice"),
    "a channel without a schema": (
        whole(channel_record(1, 0, topics.SENTENCE), message_record(1, TIME, b"")),
        f"{topics.SENTENCE} at {TIME} ns is of type unknown",
    ),
    "a topic that is no UTF-8": (whole(channel_record(1, 0, "").replace(b"cdr", b"\xff\xff\xff")), "damaged"),
    "a record of 4 GiB": (whole(record(5, b"", 2**32)), "damaged"),
    "a record of 16 EiB": (whole(record(5, b"", 2**64 - 1)), "damaged"),
    "a message shorter than its header": (whole(DEFINED, record(5, b"\1\0")), "damaged"),
    "a record longer than it holds": (whole(DEFINED, record(4, b"\1\0", 50)), "damaged"),
    "an end inside a chunk": (whole(chunk_record(record(2, bytes(20)), "", 29)), "a chunk holds a Footer"),
    "a chunk inside a chunk": (
        whole(chunk_record(NESTED, "", len(NESTED))),
        "a chunk holds a Chunk",
    ),
    "a compression of its own": (whole(chunk_record(b"x", "brotli", 1)), "compressed by 'brotli'"),
    "a zstd chunk that is none": (whole(chunk_record(b"no zstd", "zstd", 7)), "damaged"),
    "an lz4 chunk that is none": (whole(chunk_record(b"no lz4!", "lz4", 7)), "damaged"),
    "a chunk that says too little": (whole(chunk_record(DEFINED, "", 3)), "does not unpack to the 3 bytes"),
    "a chunk that says too much": (whole(chunk_record(zstd_of_zeros(9), "zstd", 10)), "does not unpack to the 10"),
    "a chunk of 16 EiB": (whole(chunk_record(b"", "zstd", 2**64 - 1)), "unpack to more than"),
    "a zstd bomb that says its size": (whole(chunk_record(BOMB, "zstd", 2**32)), "unpack to more than"),
    "a zstd bomb that lies in the chunk": (whole(chunk_record(BOMB, "zstd", 100)), "does not unpack"),
    "a zstd bomb that lies twice": (whole(chunk_record(zstd_of_zeros(2**32, 100), "zstd", 100)), "a.mcap"),
    "an lz4 bomb": (whole(chunk_record(lz4.frame.compress(bytes(2**27)), "lz4", 100)), "does not unpack"),
    "many chunks": (whole(*[PACKED] * 5), "unpack to more than"),
    "a million channels": (
        whole(*(channel_record(i % 2**16, 0, f"/topic{i}") for i in range(1_000_000))),
        "is defined twice",
    ),
    "a million messages": (
        whole(schema_record(1, topics.JOINT_STATE), channel_record(1, 1, topics.JOINT_STATES),
              message_record(1, TIME, b"") * 1_000_000),
        f"{topics.JOINT_STATES} at {TIME} ns is one of more than",
    ),
    "100 pictures": (
        log_file(
            [
                dataclasses.replace(messages("trial")[0], data=messages("trial")[0].data + bytes(i % 3))
                for i in range(100)
            ],
            metadata("trial"),
        ),
        "comes again with another value",
    ),
    "an image of 10^10 pixels": (with_image(IMAGES["png of 100,000 × 100,000"]), "no PNG or JPEG of at most"),
    "more than the largest file": (bytes(MAX_LOG_BYTES + 1), "larger than"),
}  # fmt: skip


@pytest.mark.bad_input
@pytest.mark.parametrize("name", list(FRAMES))
def test_a_bad_file_is_refused_within_bounded_memory(tmp_path_factory: Any, name: str) -> None:
    assert FRAMES[name][1] in frame_errors(str(tmp_path_factory.getbasetemp()))[name]


@functools.cache
def frame_errors(base: str) -> dict[str, str]:
    """The error of each bad file, read in one process that may take 512 MiB more than its imports."""
    folder = Path(base) / "frames"
    folder.mkdir(exist_ok=True)
    paths = {}
    for name, (content, _) in FRAMES.items():
        paths[name] = folder / f"{name.replace('/', '')}.a.mcap"
        paths[name].write_bytes(content)
    return errors_within(
        2**29, "from data_collection.log.mcap_log import LogError, read_log", "read_log(path)", "LogError", paths
    )


def small() -> Log:
    """A sound log of few bytes, so that damages hit all of it."""
    return Log(
        metadata("trial"),
        tuple(Message(raw.topic, raw.time, sound(BY_TOPIC[raw.topic])) for raw in messages("trial")),
    )


def outcome(folder: Path, content: bytes) -> Log | None:
    """What a file holds if it is accepted; no error but the documented one, which names the file."""
    path = folder / "a.mcap"
    path.write_bytes(content)
    with suppress(LogError):
        return use(path)
    with pytest.raises(LogError, match=re.escape(str(path))):
        use(path)
    return None


def damage_of_a_log_with_checksums(folder: Path, mutations: list[Mutation]) -> None:
    """It is refused, or says what it said."""
    path, original = folder / "whole.mcap", small()
    if not path.exists():
        write_log(path, original)
    log = outcome(folder, mutated(path.read_bytes(), mutations))
    assert log is None or differences(original, log) == []


def damage_of_a_log_without_checksums(folder: Path, mutations: list[Mutation]) -> None:
    """It is refused, or it is sound, whatever it says then."""
    for kind in ("trial", "calibration"):
        log = outcome(folder, mutated(log_file(messages(kind), metadata(kind)), mutations))
        assert log is None or problems(log) == []


@examples(FEW)
@given(mutations=MUTATIONS)
def test_fuzz_checksums(shared_folder: Path, mutations: list[Mutation]) -> None:
    damage_of_a_log_with_checksums(shared_folder, mutations)


@pytest.mark.slow
@examples(MANY)
@given(mutations=MUTATIONS)
def test_fuzz_checksums_much(shared_folder: Path, mutations: list[Mutation]) -> None:
    damage_of_a_log_with_checksums(shared_folder, mutations)


@examples(FEW)
@given(mutations=MUTATIONS)
def test_fuzz_without_checksums(shared_folder: Path, mutations: list[Mutation]) -> None:
    damage_of_a_log_without_checksums(shared_folder, mutations)


@pytest.mark.slow
@examples(MANY)
@given(mutations=MUTATIONS)
def test_fuzz_without_checksums_much(shared_folder: Path, mutations: list[Mutation]) -> None:
    damage_of_a_log_without_checksums(shared_folder, mutations)


@examples(FEW)
@given(content=st.binary(max_size=200))
def test_fuzz_any_bytes(shared_folder: Path, content: bytes) -> None:
    assert outcome(shared_folder, content) is None
    assert outcome(shared_folder, whole(content)) is None


@examples(FEW)
@given(topic=st.sampled_from([topic.name for topic in TOPICS]), content=st.binary(max_size=200))
def test_fuzz_any_message(shared_folder: Path, topic: str, content: bytes) -> None:
    kind = kind_with(BY_TOPIC[topic])
    changed = [dataclasses.replace(raw, data=content) if raw.topic == topic else raw for raw in messages(kind)]
    log = outcome(shared_folder, log_file(changed, metadata(kind)))
    assert log is None or problems(log) == []
