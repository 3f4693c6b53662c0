"""Logs of strangers: every topic and every field of its messages, broken in every way; absurd sizes; random bytes.

The cases are made from the table of channels, so that a new signal is broken too.
"""

from __future__ import annotations

import dataclasses
import functools
import json
import re
import struct
import zlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import lz4.frame
import numpy as np
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st

from data_collection.comparison import differences
from data_collection.joints import JOINT_NAMES
from data_collection.limits import MAX_LOG_BYTES, MAX_MESSAGE_BYTES, MAX_SENTENCE
from data_collection.log import channels, codec
from data_collection.log.channels import BY_TOPIC, CHANNELS, Channel, LogKind
from data_collection.log.mcap_log import Log, LogError, Message, read_log, write_log
from data_collection.log.messages import CameraInfo, JointState, Transform, Value
from data_collection.log.trial import calibration, observation, truth
from data_collection.log.validation import kind_of, problems
from tests.bounded import errors_within
from tests.data_collection.raw_mcap import (
    Raw,
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

NAN, INF = float("nan"), float("inf")
TIME = 1_000_000_007
SCENE: dict[str, Any] = {
    "attended": 0,
    "objects": [{"object": "cup", "color": "red", "place": "left", "position": [0.3, 0.1]}],
}
TEXTS = {
    channels.SENTENCE: "grasp red cup",
    channels.ROBOT_DESCRIPTION: "<robot/>",
    channels.TRUTH_SCENE: json.dumps(SCENE),
    channels.TRUTH_OUTCOME: json.dumps({"word": "grasp", "action": "grasp"}),
    channels.CALIBRATION_PATTERN: json.dumps({"rows": 2, "columns": 2}),
}
POSES = np.tile([0.3, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0], (4, 1))


def sound(channel: Channel) -> Value:
    """A value that a channel accepts."""
    made: dict[str, Callable[[], Value]] = {
        channels.IMAGE: lambda: np.arange(32 * 40 * 3).astype(np.uint8).reshape(32, 40, 3),
        channels.CAMERA_INFO: lambda: CameraInfo(40, 32, np.diag([50.0, 51.0, 1.0]), np.zeros(5), "eye"),
        channels.JOINT_STATE: lambda: JointState(JOINT_NAMES, np.zeros(25), np.zeros(25)),
        channels.NUMBER: lambda: 0.5,
        channels.NUMBERS: lambda: np.full(channel.value.length or 0, 0.5),
        channels.POINT: lambda: POSES[0, :3],
        channels.POSE: lambda: POSES[0],
        channels.POSES: lambda: POSES,
        channels.TRANSFORMS: lambda: (Transform("root", "hand", POSES[0]),),
        channels.TEXT: lambda: TEXTS[channel.topic],
    }
    return made[channel.value.type]()


@functools.cache
def messages(kind: LogKind) -> tuple[Raw, ...]:
    """A sound log of a kind, with all that it may hold."""
    held = [channel for channel in CHANNELS if kind in channel.required + channel.optional]
    return tuple(Raw.of(Message(channel.topic, TIME + i, sound(channel))) for i, channel in enumerate(held))


def metadata(kind: LogKind) -> dict[str, str]:
    return {"trial": "1", "set": "generation" if kind == "instruction" else "train"}


def kind_with(channel: Channel) -> LogKind:
    return (channel.required + channel.optional)[0]


def use(path: Path) -> Log:
    """Read a log as the study does, to the last field."""
    log = read_log(path)
    if kind_of(log) == "calibration":
        calibration(log)
    else:
        observation(log)
        truth(log)
    return log


Broken = tuple[str, Callable[[Raw], list[Raw]]]


def wrong_envelopes(channel: Channel) -> Iterator[Broken]:
    """What can be wrong with any message, whatever it holds."""

    def changed(**change: Any) -> Callable[[Raw], list[Raw]]:
        return lambda raw: [dataclasses.replace(raw, **change)]

    def cut(part: float) -> Callable[[Raw], list[Raw]]:
        return lambda raw: [dataclasses.replace(raw, data=raw.data[: int(part * len(raw.data))])]

    others = sorted({other.value.type for other in CHANNELS} - {channel.value.type})
    for other in (*others, "std_msgs/msg/Nonsense", ""):
        yield f"type {other}", changed(type=other)
    for encoding in ("json", "ros1", "protobuf", ""):
        yield f"encoding {encoding!r}", changed(encoding=encoding)
        yield f"schema encoding {encoding!r}", changed(schema_encoding=encoding)
    yield "no bytes", changed(data=b"")
    yield "half the bytes", cut(0.5)
    yield "four bytes", changed(data=b"\0\1\0\0")
    yield (
        "lengths of 4 GiB",
        lambda raw: [dataclasses.replace(raw, data=raw.data[:4] + b"\xff" * (len(raw.data) - 4))],
    )
    if channel.value.type != channels.IMAGE:
        yield "too many bytes", changed(data=bytes(MAX_MESSAGE_BYTES + 1))
    if channel.once:
        yield "twice", lambda raw: [raw, raw]


def wrong_values(channel: Channel) -> Iterator[tuple[str, Value]]:
    """Every field of a value, broken in every way that it can be written."""
    value = sound(channel)
    if channel.value.type == channels.IMAGE:
        yield "8 × 8 pixels", np.zeros((8, 8, 3), np.uint8)
        yield "one row", np.zeros((1, 400, 3), np.uint8)
    elif channel.value.type == channels.TEXT:
        yield from wrong_texts(channel)
    elif isinstance(value, CameraInfo):
        for change in ({"width": 0}, {"height": 0}, {"width": 100_000, "height": 100_000}):
            yield f"size {change}", dataclasses.replace(value, **change)
        for at in np.ndindex(3, 3):
            for bad in (NAN, INF, -INF):
                yield f"K{list(at)} {bad}", dataclasses.replace(value, K=put(value.K, at, bad))
        for at in ((0, 0), (1, 1)):
            for bad in (0.0, -1.0):
                yield f"K{list(at)} {bad}", dataclasses.replace(value, K=put(value.K, at, bad))
        for index in range(5):
            for bad in (NAN, INF, -INF):
                yield f"D[{index}] {bad}", dataclasses.replace(value, D=put(value.D, index, bad))
        for size in (1, 6, 1000):
            yield f"D of {size}", dataclasses.replace(value, D=np.zeros(size))
    elif isinstance(value, JointState):
        yield from wrong_joints(value)
    elif isinstance(value, tuple):
        for index in range(7):
            for bad in (NAN, INF, -INF):
                yield f"pose[{index}] {bad}", (Transform("root", "hand", put(POSES[0], index, bad)),)
    else:
        numbers = np.asarray(value, dtype=np.float64)
        for at in (at for at in np.ndindex(numbers.shape) if channel.value.type != channels.POSES or at[0] == 1):
            for bad in (NAN, INF, -INF, (channel.value.lowest or 0) - 1e-6, (channel.value.highest or 0) + 1e-6):
                yield f"{list(at)} {bad}", put(numbers, at, bad)
        if channel.value.type == channels.NUMBERS:
            for size in (0, channel.value.length - 1, channel.value.length + 1, 100_000):
                yield f"{size} numbers", np.zeros(size)


def wrong_joints(value: JointState) -> Iterator[tuple[str, Value]]:
    for j, name in enumerate(JOINT_NAMES):
        yield f"{name} unknown", dataclasses.replace(value, names=(*JOINT_NAMES[:j], "tail", *JOINT_NAMES[j + 1 :]))
        for bad in (NAN, INF, 90.0):
            yield f"{name} at {bad}", dataclasses.replace(value, position=put(value.position, j, bad))
        yield f"{name} moves nan", dataclasses.replace(value, velocity=put(value.velocity, j, NAN))
    yield "a name missing", dataclasses.replace(value, names=JOINT_NAMES[:-1])
    yield "a name twice", dataclasses.replace(value, names=(*JOINT_NAMES, JOINT_NAMES[0]))
    yield "a velocity of -inf", dataclasses.replace(value, velocity=put(value.velocity, 3, -INF))
    for size in (0, 24, 26, 10_000):
        yield f"{size} positions", dataclasses.replace(value, position=np.zeros(size))
    for size in (1, 24, 26, 10_000):
        yield f"{size} velocities", dataclasses.replace(value, velocity=np.zeros(size))
    yield "another order", dataclasses.replace(value, names=JOINT_NAMES[::-1])
    yield "no names", dataclasses.replace(value, names=())


BAD_WORDS = ("x" * 41, "=1+1", "+1", "-1", "@cmd", "a\0b", "\x1b[31m", "a\u200bb", "\u202eb", "a\ufeff", "NA", "12")


def wrong_texts(channel: Channel) -> Iterator[tuple[str, Value]]:
    if channel.topic == channels.SENTENCE:
        for word in BAD_WORDS:
            yield f"word {word[:9]!r}", f"grasp {word}"
        yield "many words", "red " * (MAX_SENTENCE + 1)
        return
    if channel.topic == channels.ROBOT_DESCRIPTION:
        return
    yield from {"empty": "", "half": "{", "deep": "[" * 100_000, "no mapping": "3", "null": "null"}.items()
    valid: dict[str, Any] = json.loads(TEXTS[channel.topic])
    bad: Any
    if channel.topic == channels.CALIBRATION_PATTERN:
        for key in valid:
            for bad in (None, "2", 2.0, True, [2], 0, -2, 1, 3, 1001, 10**30, NAN, INF):
                yield f"{key} {bad!r}", json.dumps(valid | {key: bad})
            yield f"no {key}", json.dumps({other: valid[other] for other in valid if other != key})
    elif channel.topic == channels.TRUTH_OUTCOME:
        for bad in (None, 3, ["grasp"], "", "two words", *BAD_WORDS):
            yield f"word {bad!r}", json.dumps({"word": bad})
        yield "no word", "{}"
    else:
        for bad in (None, "0", 0.5, [0], -1, 1, 10**30, NAN, INF):
            yield f"attended {bad!r}", json.dumps(valid | {"attended": bad})
        for bad in (None, 3, "text", {}, [], [3], [None]):
            yield f"objects {bad!r}", json.dumps(valid | {"objects": bad})
        for key in valid:
            yield f"no {key}", json.dumps({other: valid[other] for other in valid if other != key})
        only = valid["objects"][0]
        for key in only:
            yield (
                f"objects[0] without {key}",
                json.dumps(valid | {"objects": [{other: only[other] for other in only if other != key}]}),
            )
            wrong = (None, 3, "x", [0.3], [0.3, 0.1, 0.0], [0.3, NAN], [INF, 0.1], [[0.3], 0.1], ["a", "b"])
            for bad in wrong if key == "position" else (None, 3, ["cup"], "", "two words", *BAD_WORDS):
                yield f"objects[0].{key} {bad!r}", json.dumps(valid | {"objects": [only | {key: bad}]})


def put(values: Any, at: Any, value: float) -> Any:
    """A copy with one number replaced; a number by itself is replaced whole."""
    changed = np.array(values, dtype=np.float64)
    changed[at] = value
    return float(changed) if changed.ndim == 0 else changed


def cases() -> Iterator[Any]:
    for channel in CHANNELS:
        for label, change in wrong_envelopes(channel):
            yield pytest.param(channel, change, id=f"{channel.topic}-{label}")
        for label, value in wrong_values(channel):

            def remade(raw: Raw, value: Value = value) -> list[Raw]:
                return [Raw.of(Message(raw.topic, raw.time, value))]

            yield pytest.param(channel, remade, id=f"{channel.topic}-{label!s:.60}")


CASES = list(cases())


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("hostile_logs")


def refusal(folder: Path, content: bytes) -> str:
    """The error that a file is refused by; it names the file."""
    path = folder / "trial_0007.mcap"
    path.write_bytes(content)
    with pytest.raises(LogError) as caught:
        use(path)
    assert str(path) in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("kind", ["trial", "instruction", "calibration"])
def test_the_logs_that_are_broken_below_are_sound(tmp_path: Path, kind: LogKind) -> None:
    (tmp_path / "a.mcap").write_bytes(log_file(messages(kind), metadata(kind)))
    log = use(tmp_path / "a.mcap")
    assert (kind_of(log), problems(log)) == (kind, [])


def test_every_topic_is_broken_somehow() -> None:
    assert {case.values[0] for case in CASES} == set(CHANNELS)


@pytest.mark.bad_input
@pytest.mark.parametrize(("channel", "change"), CASES)
def test_a_bad_message_is_refused(shared_folder: Path, channel: Channel, change: Callable[[Raw], list[Raw]]) -> None:
    kind = kind_with(channel)
    changed = [one for raw in messages(kind) for one in (change(raw) if raw.topic == channel.topic else [raw])]
    says = refusal(shared_folder, log_file(changed, metadata(kind)))
    assert channel.topic in says
    if (
        "missing" not in says
        and "as documented" not in says
        and "attended is" not in says
        and "positions, but" not in says
    ):
        assert " ns" in says


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("kind", "topic"), [(kind, channel.topic) for channel in CHANNELS for kind in channel.required]
)
def test_a_missing_topic_is_refused(tmp_path: Path, kind: LogKind, topic: str) -> None:
    kept = [raw for raw in messages(kind) if raw.topic != topic]
    data = metadata(kind) | ({"set": "train"} if topic == channels.IMAGE_AFTER else {})
    says = refusal(tmp_path, log_file(kept, data))
    assert f"{topic} is missing" in says or kind == "calibration"


@pytest.mark.parametrize(
    ("kind", "topic"), [(kind, channel.topic) for channel in CHANNELS for kind in channel.optional]
)
def test_an_optional_topic_may_be_missing(tmp_path: Path, kind: LogKind, topic: str) -> None:
    kept = [raw for raw in messages(kind) if raw.topic != topic and not raw.topic.startswith(channels.TRUTH_PREFIX)]
    (tmp_path / "a.mcap").write_bytes(log_file(kept, metadata(kind)))
    assert topic not in {message.topic for message in use(tmp_path / "a.mcap").messages}


@pytest.mark.parametrize("kind", ["trial", "instruction", "calibration"])
def test_order_in_the_file_and_unknown_topics_make_no_difference(tmp_path: Path, kind: LogKind) -> None:
    (tmp_path / "a.mcap").write_bytes(log_file(messages(kind), metadata(kind)))
    foreign = Raw("/diagnostics", 5, b"anything", "foreign/msg/Thing", "json", "jsonschema")
    (tmp_path / "b.mcap").write_bytes(log_file([foreign, *messages(kind)[::-1]], metadata(kind)))
    assert differences(use(tmp_path / "a.mcap"), use(tmp_path / "b.mcap")) == []


TRIALS = ("", "0", "-1", "one", "1.5", "1e3", "٣", "²", " 1", "1\n", "1000001", "9" * 5000, "0x1", "../1", "1;ls")


@pytest.mark.bad_input
@pytest.mark.parametrize("number", TRIALS)
def test_a_bad_trial_number_is_refused(tmp_path: Path, number: str) -> None:
    says = refusal(tmp_path, log_file(messages("trial"), {"trial": number}))
    assert "metadata: trial is" in says
    assert len(says) < 300


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
    message = store.deserialize_cdr(messages("trial")[0].data, channels.IMAGE)
    message.data = np.frombuffer(data, dtype=np.uint8)
    raw = dataclasses.replace(messages("trial")[0], data=bytes(store.serialize_cdr(message, channels.IMAGE)))
    assert raw.topic == channels.IMAGE_BEFORE
    return log_file([raw, *messages("trial")[1:]], metadata("trial"))


@pytest.mark.bad_input
@pytest.mark.parametrize("name", IMAGES)
def test_a_bad_image_is_refused(tmp_path: Path, name: str) -> None:
    says = refusal(tmp_path, with_image(IMAGES[name]))
    assert f"{channels.IMAGE_BEFORE} at {TIME} ns cannot be decoded" in says


DEFINED = schema_record(1, channels.TEXT) + channel_record(1, 1, channels.SENTENCE)
FOREIGN = channel_record(7, 0, "/" + "x" * 2**24)
PACKED = chunk_record(zstandard.compress(FOREIGN), "zstd", len(FOREIGN))
NESTED = chunk_record(DEFINED, "", len(DEFINED))
BOMB = zstd_of_zeros(2**32)
FRAMES: dict[str, tuple[bytes, str]] = {
    "a channel that is not defined": (whole(message_record(9, TIME, b"")), f"{TIME} ns is on channel 9"),
    "a channel that is defined twice": (whole(DEFINED, channel_record(1, 1, channels.TF)), "channel 1 is defined"),
    "a schema that is defined twice": (whole(DEFINED, schema_record(1, "x/msg/Y")), "schema 1 is defined twice"),
    "a channel without a schema": (
        whole(channel_record(1, 0, channels.SENTENCE), message_record(1, TIME, b"")),
        f"{channels.SENTENCE} at {TIME} ns is of type unknown",
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
        whole(schema_record(1, channels.JOINT_STATE), channel_record(1, 1, channels.JOINT_STATES),
              message_record(1, TIME, b"") * 1_000_000),
        f"{channels.JOINT_STATES} at {TIME} ns is one of more than",
    ),
    "100 pictures": (log_file([messages("trial")[0]] * 100, metadata("trial")), "comes again, once is expected"),
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
@given(topic=st.sampled_from([channel.topic for channel in CHANNELS]), content=st.binary(max_size=200))
def test_fuzz_any_message(shared_folder: Path, topic: str, content: bytes) -> None:
    kind = kind_with(BY_TOPIC[topic])
    changed = [dataclasses.replace(raw, data=content) if raw.topic == topic else raw for raw in messages(kind)]
    log = outcome(shared_folder, log_file(changed, metadata(kind)))
    assert log is None or problems(log) == []
