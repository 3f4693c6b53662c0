"""Reading and writing logs: MCAP files, ROS 2 profile, every byte under a checksum."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from mcap.records import Channel as ChannelRecord
from mcap.records import Message as MessageRecord
from mcap.records import Metadata, Schema
from mcap.writer import Writer

from data_collection.files import replacing
from data_collection.limits import MAX_IMAGE_BYTES, MAX_LOG_BYTES, MAX_MESSAGE_BYTES, MAX_MESSAGES
from data_collection.log import codec
from data_collection.log.joint_matching import matched, merged
from data_collection.log.mcap_records import DamageError, records
from data_collection.log.messages import JointState, Value, same
from data_collection.log.topics import BY_TOPIC, IMAGE, JOINT_STATES

METADATA_NAME = "cross_situational_learning"
_LIBRARY = "cross-situational-learning"
_SCHEMAS = ("ros2msg", "ros2idl")
"""How recorders note down the definitions of messages; the bytes of a message are the same."""


class LogError(ValueError):
    """A log is damaged, incomplete or holds a bad value; the text names file, topic, time and reason."""


@dataclass(frozen=True)
class Message:
    """One message.

    Attributes:
        topic: Topic in `TOPICS`.
        time: Log time, nanoseconds.
        value: Decoded value: number, array, text, `JointState`, `CameraInfo`, transforms.
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
    """Write `log`; the same log gives the same bytes, and the file appears only when it is complete.

    Raises:
        LogError: A message is on a topic that `TOPICS` has not, or out of time order.
    """
    times = [message.time for message in log.messages]
    if times != sorted(times):
        raise LogError(f"{path}: messages are not in time order")
    unknown = {message.topic for message in log.messages} - set(BY_TOPIC)
    if unknown:
        raise LogError(f"{path}: topics that are not in the table of topics: {sorted(unknown)}")
    with replacing(path) as (temporary,), temporary.open("wb") as stream:
        _write(stream, log)


def read_log(path: Path) -> Log:
    """Read a log with every checksum checked; topics that are not in `TOPICS` are passed over.

    Messages come in order of time, whatever their order in the file. Joints come in the order of `JOINT_NAMES`,
    without others. What may come once, and comes again with the same value, as from a recorder that hears it again
    and again, is there once.

    Raises:
        LogError: The file is missing, truncated, damaged, too large or no MCAP, or a topic is not of its type in
            `TOPICS`, or comes again with another value where it may come once.
    """
    try:
        if path.is_dir():
            inside = ", ".join(sorted(one.name for one in path.glob("*.mcap"))[:3])
            hint = f"; the log is a file in it: {inside}" if inside else ""
            raise LogError(f"{path}: is a folder{hint}")
        if not path.is_file():
            raise LogError(f"{path}: there is no such file")
        with path.open("rb") as stream:
            content = stream.read(MAX_LOG_BYTES + 1)
        if len(content) > MAX_LOG_BYTES:
            raise LogError(f"{path}: larger than {MAX_LOG_BYTES:,} bytes, the most that is read")
        return _read(content, str(path))
    except LogError:
        raise
    except DamageError as error:
        raise LogError(f"{path}: {error}") from error
    except Exception as error:  # damaged bytes surface as struct, zstd, unicode, key, memory, … errors
        raise LogError(f"{path}: damaged or not an MCAP log ({type(error).__name__}: {error})") from error


def _write(stream: IO[bytes], log: Log) -> None:
    writer = Writer(stream, enable_crcs=True, enable_data_crcs=True)
    writer.start(profile="ros2", library=_LIBRARY)
    ids: dict[str, int] = {}
    schemas: dict[str, int] = {}
    count: Counter[str] = Counter()
    for message in log.messages:
        topic, form = message.topic, BY_TOPIC[message.topic].value
        if form.type not in schemas:
            schemas[form.type] = writer.register_schema(form.type, "ros2msg", codec.definition(form.type))
        if topic not in ids:
            ids[topic] = writer.register_channel(topic, "cdr", schemas[form.type])
        data = codec.encode(form.type, message.value, message.time, form.frame)
        writer.add_message(ids[topic], message.time, data, publish_time=message.time, sequence=count[topic])
        count[topic] += 1
    writer.add_metadata(METADATA_NAME, dict(sorted(log.metadata.items())))
    writer.finish()


def _read(content: bytes, source: str) -> Log:
    schemas: dict[int, Schema] = {}
    channels: dict[int, ChannelRecord] = {}
    metadata: dict[str, str] = {}
    raw: list[tuple[int, str, bytes]] = []
    counts: Counter[str] = Counter()
    for record in records(content):
        match record:
            case Schema():
                if schemas.setdefault(record.id, record) != record:
                    raise LogError(f"{source}: schema {record.id} is defined twice, in different ways")
            case ChannelRecord():
                if channels.setdefault(record.id, record) != record:
                    raise LogError(f"{source}: channel {record.id} is defined twice, in different ways")
            case Metadata() if record.name == METADATA_NAME:
                metadata = dict(record.metadata)
            case MessageRecord():
                time, channel = record.log_time, channels.get(record.channel_id)
                if channel is None:
                    raise LogError(f"{source}: a message at {time} ns is on channel {record.channel_id}, not defined")
                if channel.topic in BY_TOPIC:
                    counts[channel.topic] += 1
                    schema = schemas.get(channel.schema_id)
                    if reason := _unfit(record.data, channel, schema, counts):
                        raise LogError(f"{source}: {channel.topic} at {time} ns {reason}")
                    raw.append((time, channel.topic, record.data))
    raw.sort(key=lambda item: item[0])
    return Log(metadata, tuple(_with_whole_joints(list(_decoded(source, raw)))), source)


def _decoded(source: str, raw: Iterable[tuple[int, str, bytes]]) -> Iterator[Message]:
    """Decode messages in order of time; of what may come once, the first."""
    first: dict[str, tuple[bytes, Message]] = {}
    for time, topic, data in raw:
        if BY_TOPIC[topic].once and topic in first:
            earlier, message = first[topic]
            is_picture = BY_TOPIC[topic].value.type == IMAGE  # compared by its bytes alone
            if data != earlier and (is_picture or not same(message.value, _decode(source, time, topic, data).value)):
                stream = " (one picture, not a stream of them)" if is_picture else ""
                raise LogError(
                    f"{source}: {topic} at {time} ns comes again with another value than at {message.time} ns, "
                    f"once is expected{stream}"
                )
            continue
        message = _decode(source, time, topic, data)
        if BY_TOPIC[topic].once:
            first[topic] = data, message
        yield message


def _with_whole_joints(messages: list[Message]) -> Iterator[Message]:
    """Yield the messages, and for the joint states of several publishers what they say together."""
    states = [one.value for one in messages if isinstance(one.value, JointState) and one.topic == JOINT_STATES]
    whole = iter(merged(states))
    for message in messages:
        if message.topic != JOINT_STATES:
            yield message
        elif (state := next(whole)) is not None:
            yield Message(JOINT_STATES, message.time, state)


def _unfit(data: bytes, record: ChannelRecord, schema: Schema | None, counts: Counter[str]) -> str | None:
    """Return why a message on a topic of `TOPICS` is not even decoded, or None."""
    topic = BY_TOPIC[record.topic]
    if schema is None or schema.name != topic.value.type:
        return f"is of type {schema.name if schema else 'unknown'}, {topic.value.type} is expected"
    if record.message_encoding != "cdr" or schema.encoding not in _SCHEMAS:
        hint = "; it is of ROS 1" if record.message_encoding == "ros1" else ""
        return (
            f"is encoded as {record.message_encoding!r} with schema {schema.encoding!r}, "
            f"cdr and {' or '.join(_SCHEMAS)} are expected{hint}"
        )
    limit = MAX_IMAGE_BYTES if topic.value.type == IMAGE else MAX_MESSAGE_BYTES
    if len(data) > limit:
        return f"has {len(data):,} bytes, at most {limit:,} are read"
    if counts.total() > MAX_MESSAGES:
        return f"is one of more than {MAX_MESSAGES:,} messages, the most that are read"
    return None


def _decode(source: str, time: int, topic: str, data: bytes) -> Message:
    try:
        value = codec.decode(BY_TOPIC[topic].value.type, data)
        return Message(topic, time, matched(value) if isinstance(value, JointState) else value)
    except Exception as error:
        reason = str(error) or type(error).__name__
        raise LogError(f"{source}: {topic} at {time} ns cannot be decoded ({reason})") from error
