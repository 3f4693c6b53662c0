"""Reading and writing logs: MCAP files, ROS 2 profile, every byte under a checksum.

The file has no summary-only shortcuts: it is read from front to back with the CRC of each chunk, of the whole data
section and of the summary checked, because a reader that seeks misses most single-bit damage.
"""

import io
import os
import tempfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from mcap.records import Channel as ChannelRecord
from mcap.records import DataEnd, Footer, Metadata, Schema
from mcap.records import Message as MessageRecord
from mcap.stream_reader import StreamReader
from mcap.writer import Writer

from data_collection import codec
from data_collection.channels import BY_TOPIC
from data_collection.messages import Value

METADATA_NAME = "cross_situational_learning"
_LIBRARY = "cross-situational-learning"
_TAIL = 12  # bytes: checksum of the summary, closing magic


class LogError(ValueError):
    """A log is damaged, incomplete or holds a bad value; the text names file, topic, time and reason."""


@dataclass(frozen=True)
class Message:
    """One message.

    Attributes:
        topic: Topic in ``CHANNELS``.
        time: Log time, nanoseconds.
        value: Decoded value: number, array, text, ``JointState``, ``CameraInfo``, transforms.
    """

    topic: str
    time: int
    value: Value


@dataclass(frozen=True)
class Log:
    """Content of a log file.

    Attributes:
        metadata: Text by key: seed, experiment, set, trial, settings, hashes, joint names, units.
        messages: In time order.
        source: Where it was read from, for messages of errors; not part of the content.
    """

    metadata: Mapping[str, str]
    messages: tuple[Message, ...]
    source: str = field(default="log", compare=False)


def write_log(path: Path, log: Log) -> None:
    """Write ``log``; the same log gives the same bytes, and the file appears only when it is complete.

    Raises:
        LogError: A message is on a topic that ``CHANNELS`` has not, or out of time order.
    """
    times = [message.time for message in log.messages]
    if times != sorted(times):
        raise LogError(f"{path}: messages are not in time order")
    unknown = {message.topic for message in log.messages} - set(BY_TOPIC)
    if unknown:
        raise LogError(f"{path}: topics that are not in the table of channels: {sorted(unknown)}")
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            _write(stream, log)
            stream.flush()
            os.fsync(stream.fileno())
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def read_log(path: Path) -> Log:
    """Read a log with every checksum checked; topics that are not in ``CHANNELS`` are passed over.

    Raises:
        LogError: The file is missing, truncated, damaged or no MCAP, or a topic is not of its type in ``CHANNELS``.
    """
    try:
        return _read(path.read_bytes(), str(path))
    except LogError:
        raise
    except FileNotFoundError as error:
        raise LogError(f"{path}: there is no such file") from error
    except Exception as error:  # damaged bytes surface as struct, zstd, unicode, key, memory, … errors
        raise LogError(f"{path}: damaged or not an MCAP log ({type(error).__name__}: {error})") from error


def _write(stream: IO[bytes], log: Log) -> None:
    writer = Writer(stream, enable_crcs=True, enable_data_crcs=True)
    writer.start(profile="ros2", library=_LIBRARY)
    ids: dict[str, int] = {}
    schemas: dict[str, int] = {}
    sequence: dict[str, int] = {}
    for message in log.messages:
        channel = BY_TOPIC[message.topic]
        if channel.type not in schemas:
            schemas[channel.type] = writer.register_schema(channel.type, "ros2msg", codec.definition(channel.type))
        if channel.topic not in ids:
            ids[channel.topic] = writer.register_channel(channel.topic, "cdr", schemas[channel.type])
        sequence[channel.topic] = sequence.get(channel.topic, -1) + 1
        writer.add_message(
            channel_id=ids[channel.topic],
            log_time=message.time,
            publish_time=message.time,
            sequence=sequence[channel.topic],
            data=codec.encode(channel.type, message.value, message.time, channel.frame),
        )
    writer.add_metadata(METADATA_NAME, dict(sorted(log.metadata.items())))
    writer.finish()


def _read(content: bytes, source: str) -> Log:
    schemas: dict[int, Schema] = {}
    channels: dict[int, ChannelRecord] = {}
    metadata: dict[str, str] = {}
    raw: list[tuple[int, str, str, bytes]] = []
    stream = io.BytesIO(content)
    ended, footer = False, None
    # A damaged length must not be taken at its word: no record is larger than the file, chunks are inside one.
    for record in StreamReader(stream, validate_crcs=True, record_size_limit=len(content)).records:
        match record:
            case Schema():
                schemas[record.id] = record
            case ChannelRecord():
                channels[record.id] = record
            case Metadata() if record.name == METADATA_NAME:
                metadata = dict(record.metadata)
            case MessageRecord():
                topic = channels[record.channel_id].topic
                if topic in BY_TOPIC:
                    schema = schemas[channels[record.channel_id].schema_id]
                    raw.append((record.log_time, topic, schema.name, record.data))
            case DataEnd():
                ended = True
            case Footer():
                footer = record
    if not ended or footer is None or stream.read(1):
        raise LogError(f"{source}: the file is truncated, or something follows its end")
    # The reader leaves out this one: from the start of the summary to the checksum itself.
    summary = content[footer.summary_start : -_TAIL]
    if footer.summary_crc and footer.summary_crc != zlib.crc32(summary):
        raise LogError(f"{source}: damaged (checksum of the summary)")
    raw.sort(key=lambda item: item[0])
    messages = tuple(_decode(source, *item) for item in raw)
    return Log(metadata, messages, source)


def _decode(source: str, time: int, topic: str, type_name: str, data: bytes) -> Message:
    expected = BY_TOPIC[topic].type
    if type_name != expected:
        raise LogError(f"{source}: {topic} at {time} ns is of type {type_name}, {expected} is expected")
    try:
        return Message(topic, time, codec.decode(type_name, data))
    except Exception as error:
        raise LogError(f"{source}: {topic} at {time} ns cannot be decoded ({error})") from error
