"""MCAP files byte by byte, so that tests can say in them what no library would write."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from dataclasses import dataclass

from data_collection.log import codec, topics
from data_collection.log.mcap_log import METADATA_NAME, Message
from data_collection.log.topics import BY_TOPIC

MAGIC = b"\x89MCAP0\r\n"


@dataclass(frozen=True)
class Raw:
    """One message as it stands in a file: what it claims to be, and its bytes."""

    topic: str
    time: int
    data: bytes
    type: str
    encoding: str = "cdr"
    schema_encoding: str = "ros2msg"

    @classmethod
    def of(cls, message: Message) -> Raw:
        """The message as it should stand."""
        form = BY_TOPIC[message.topic].value
        data = codec.encode(form.type, message.value, message.time, form.frame or topics.ROOT_FRAME)
        return cls(message.topic, message.time, data, form.type)


def record(opcode: int, payload: bytes, length: int | None = None) -> bytes:
    """A record; it may claim another length than it has."""
    return struct.pack("<BQ", opcode, len(payload) if length is None else length) + payload


def text(value: str | bytes) -> bytes:
    """Text with its length before it."""
    value = value.encode() if isinstance(value, str) else value
    return struct.pack("<I", len(value)) + value


def schema_record(number: int, name: str, encoding: str = "ros2msg") -> bytes:
    return record(3, struct.pack("<H", number) + text(name) + text(encoding) + text(b""))


def channel_record(number: int, schema: int, topic: str, encoding: str = "cdr") -> bytes:
    return record(4, struct.pack("<HH", number, schema) + text(topic) + text(encoding) + struct.pack("<I", 0))


def message_record(channel: int, time: int, data: bytes) -> bytes:
    return record(5, struct.pack("<HIQQ", channel, 0, time, time) + data)


def chunk_record(data: bytes, compression: str, size: int) -> bytes:
    return record(6, struct.pack("<QQQI", 0, 0, size, 0) + text(compression) + struct.pack("<Q", len(data)) + data)


def metadata_record(metadata: dict[str, str]) -> bytes:
    pairs = b"".join(text(key) + text(value) for key, value in metadata.items())
    return record(12, text(METADATA_NAME) + struct.pack("<I", len(pairs)) + pairs)


def whole(*records: bytes) -> bytes:
    """A file of these records, without checksums."""
    end = record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0))
    return MAGIC + record(1, text("ros2") + text("test")) + b"".join(records) + end + MAGIC


def log_file(messages: Iterable[Raw], metadata: dict[str, str]) -> bytes:
    """A file of messages, each kind of them with a channel and a schema of its own."""
    numbers: dict[tuple[str, ...], int] = {}
    parts = []
    for raw in messages:
        kind = (raw.topic, raw.type, raw.encoding, raw.schema_encoding)
        if kind not in numbers:
            number = numbers[kind] = len(numbers) + 1
            parts += [schema_record(number, raw.type, raw.schema_encoding)]
            parts += [channel_record(number, number, raw.topic, raw.encoding)]
        parts.append(message_record(numbers[kind], raw.time, raw.data))
    return whole(*parts, metadata_record(metadata))


def zstd_of_zeros(size: int, says: int | None = None) -> bytes:
    """A zstd frame of about 32 bytes a MiB that unpacks to zeros; its header may say another size."""
    block = 2**17
    frame = struct.pack("<IBBQ", 0xFD2FB528, 0b11000000, 0x58, size if says is None else says)
    left = size
    while left > 0:
        now = min(left, block)
        left -= now
        frame += struct.pack("<I", (left == 0) | (1 << 1) | (now << 3))[:3] + b"\0"
    return frame
