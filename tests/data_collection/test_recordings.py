"""Logs as recorders write them: parts of the format left out, other files, pictures turned, several publishers."""

from __future__ import annotations

import bz2
import dataclasses
import gzip
import io
import itertools
import zlib
from pathlib import Path
from typing import Any

import lz4.frame
import numpy as np
import pytest
import zstandard
from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType, IndexType, Writer
from PIL import Image as Pillow
from PIL import ImageOps

from data_collection.__main__ import main
from data_collection.joints import JOINT_NAMES
from data_collection.log import codec, topics
from data_collection.log.codec import decode_image
from data_collection.log.joint_matching import matched, merged
from data_collection.log.mcap_log import METADATA_NAME, LogError, read_log
from data_collection.log.messages import CameraInfo, JointState
from data_collection.log.numbering import number_of, order_problems
from data_collection.log.trial import observation
from data_collection.log.validation import kind_of, problems
from data_collection.log_differences import differences
from tests.data_collection.broken_logs import messages, metadata
from tests.data_collection.raw_mcap import (
    MAGIC,
    Raw,
    channel_record,
    chunk_record,
    log_file,
    message_record,
    metadata_record,
    record,
    schema_record,
    text,
    whole,
)

SOUND = log_file(messages("trial"), metadata("trial"))
CRCS = [{"enable_crcs": crcs, "enable_data_crcs": data} for crcs in (False, True) for data in (False, True)]
SUMMARIES: list[dict[str, Any]] = [
    {},
    {"index_types": IndexType.NONE, "use_statistics": False, "repeat_channels": False, "repeat_schemas": False},
    {"index_types": IndexType.MESSAGE, "use_summary_offsets": False},
    {"index_types": IndexType.NONE, "use_statistics": False, "repeat_channels": False, "repeat_schemas": False,
     "use_summary_offsets": False},
]  # fmt: skip
CHUNKS: list[dict[str, Any]] = [{"use_chunking": False}] + [
    {"compression": compression, "chunk_size": size} for compression in CompressionType for size in (2000, 2**20)
]
OPTIONS = [a | b | c for a, b, c in itertools.product(CRCS, SUMMARIES, CHUNKS)]


def written(
    raws: tuple[Raw, ...], data: dict[str, str] | None = None, encoding: str = "ros2msg", **options: Any
) -> bytes:
    """A log as the format's own writer writes it."""
    stream = io.BytesIO()
    writer = Writer(stream, **options)
    writer.start(profile="ros2", library="recorder")
    channels: dict[str, int] = {}
    for raw in raws:
        if raw.topic not in channels:
            schema = writer.register_schema(raw.type, encoding, codec.definition(raw.type))
            channels[raw.topic] = writer.register_channel(raw.topic, "cdr", schema)
        writer.add_message(channels[raw.topic], raw.time, raw.data, raw.time)
    if data is not None:
        writer.add_metadata(METADATA_NAME, data)
    writer.finish()
    return stream.getvalue()


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("small")


def read(folder: Path, content: bytes, name: str = "a.mcap") -> Any:
    (folder / name).write_bytes(content)
    return read_log(folder / name)


def test_every_way_in_which_the_library_writes_is_read(small: Path) -> None:
    """112 combinations of what the format leaves to the writer: checksums, summary, indexes, chunks, compression."""
    expected = read(small, SOUND)
    for options in OPTIONS:
        content = written(messages("trial"), metadata("trial"), **options)
        assert len(list(NonSeekingReader(io.BytesIO(content), validate_crcs=True).iter_messages())) > 0
        assert differences(read(small, content), expected) == [], options


DEFINED = [
    part
    for number, raw in enumerate(messages("trial"), start=1)
    for part in (schema_record(number, raw.type), channel_record(number, number, raw.topic))
]
SAID = [message_record(number, raw.time, raw.data) for number, raw in enumerate(messages("trial"), start=1)]
META = metadata_record(metadata("trial"))
UNKNOWN = record(0x90, b"private")
END = record(2, bytes(20)) + MAGIC
INSIDE = b"".join([*DEFINED, UNKNOWN, *SAID, UNKNOWN])
FOOTER = record(2, bytes(16) + zlib.crc32(b"\x02" + bytes([20]) + bytes(7) + bytes(16)).to_bytes(4, "little"))
LEFT_OUT = {
    "no mark where the data end": MAGIC + record(1, text("") + text("")) + b"".join([*DEFINED, *SAID, META]) + END,
    "a checksum of a summary that is not there": SOUND[: -len(END)] + FOOTER + MAGIC,
    "records of kinds that are not known": whole(UNKNOWN, *DEFINED, UNKNOWN, *SAID, META, UNKNOWN),
    "such records in a chunk": whole(chunk_record(INSIDE, "", len(INSIDE)), META),
    "a chunk that says that it is not compressed": whole(chunk_record(INSIDE, "none", len(INSIDE)), META),
    "an empty chunk": whole(chunk_record(b"", "", 0), *DEFINED, *SAID, META),
    "an attachment": whole(record(9, bytes(16) + text("a") + text("b") + bytes(12)), *DEFINED, *SAID, META),
    "definitions again and again": whole(*DEFINED, *DEFINED, *SAID, *DEFINED, META),
    "definitions by IDL": log_file(
        [dataclasses.replace(raw, schema_encoding="ros2idl") for raw in messages("trial")], metadata("trial")
    ),
}


@pytest.mark.parametrize("name", LEFT_OUT)
def test_what_is_left_out_or_beside_is_no_fault(small: Path, name: str) -> None:
    assert differences(read(small, LEFT_OUT[name]), read(small, SOUND)) == []


OTHER = {
    "nothing": (b"", "is empty"),
    "zeros": (bytes(5000), "nothing but 5,000 zeros"),
    "a bag of ROS 1": (b"#ROSBAG V2.0\n" + bytes(100), "bag of ROS 1; convert it: `.venv/bin/rosbags-convert"),
    "a bag of SQLite": (b"SQLite format 3\0" + bytes(100), "in SQLite storage; convert it"),
    "zstd": (zstandard.compress(SOUND), "by zstd; unpack it first (`unzstd FILE`)"),
    "lz4": (lz4.frame.compress(SOUND), "by lz4; unpack it first"),
    "gzip": (gzip.compress(SOUND), "by gzip; unpack it first"),
    "bzip2": (bz2.compress(SOUND), "by bzip2; unpack it first"),
    "a pointer": (b"version https://git-lfs.github.com/spec/v1\noid", "git lfs pull"),
    "a description": (b"rosbag2_bagfile_information:\n  version: 9", "description of a bag of ROS 2"),
    "text": (b"hello", "is not an MCAP file: it begins with b'hello'"),
    "another version": (b"\x89MCAP1\r\n" + bytes(50), "of another version of the format"),
    "half": (SOUND[: len(SOUND) // 2], "without its end"),
    "all but a byte": (SOUND[:-1], "without its end"),
    "the beginning": (MAGIC, "without its end"),
    "an end in a chunk": (written(messages("trial"))[:-600], "`mcap recover FILE -o saved.mcap`"),
    "more behind its end": (SOUND + b"more", "4 bytes follow the end"),
}


@pytest.mark.bad_input
@pytest.mark.parametrize("name", OTHER)
def test_other_files_are_told_for_what_they_are(small: Path, name: str) -> None:
    content, says = OTHER[name]
    with pytest.raises(LogError) as caught:
        read(small, content)
    assert str(small / "a.mcap") in str(caught.value)
    assert says in str(caught.value)


def test_a_folder_as_a_recorder_makes_it_is_no_log(tmp_path: Path) -> None:
    (tmp_path / "trial_0001_0.mcap").write_bytes(SOUND)
    with pytest.raises(LogError, match=r"is a folder; the log is a file in it: trial_0001_0\.mcap"):
        read_log(tmp_path)


@pytest.mark.parametrize("kind", ["trial", "instruction"])
def test_a_recorder_needs_to_know_nothing_of_our_metadata(tmp_path: Path, kind: Any) -> None:
    """`ros2 bag record` writes a record of its own; file and topics say the rest."""
    log = read(tmp_path, written(messages(kind), {}), "trial_0012.mcap")
    assert (kind_of(log), problems(log), observation(log).trial) == (kind, [], 12)
    nameless = read(tmp_path, written(messages(kind), {}), "recording.mcap")
    assert any("trial is missing" in line and "trial_0001.mcap" in line for line in problems(nameless))


def test_the_log_says_its_number_before_its_file() -> None:
    assert number_of("a/trial_0003.mcap", {}) == 3
    assert number_of("a/trial_12345.mcap", {}) == 12345
    assert number_of("a/trial_0003.mcap", {"trial": "101"}) == 101
    for name, said in (("trial_3.mcap", {}), ("trial_0000.mcap", {}), ("trial_0003.mcap", {"trial": ""})):
        assert number_of(name, said) is None


def test_numbers_that_contradict_the_order_of_the_files() -> None:
    files = [f"train/trial_{i:04}.mcap" for i in (9998, 9999, 10000, 10001)]
    assert list(order_problems(zip(files, (7, 8, 101, 102), strict=True))) == []
    assert list(order_problems(zip(files[::-1], (102, 101, 8, 7), strict=True))) == []
    [line] = order_problems(zip(files, (7, 9, 8, 10), strict=True))
    assert line.startswith(f"{files[2]}: says that it is trial 8, and {files[1]} before it that it is 9")
    [line] = order_problems(zip(files, (7, 8, 7, 10), strict=True))
    assert line == f"{files[2]}: says that it is trial 7, and so does {files[0]}"


def state(names: tuple[str, ...], start: float) -> JointState:
    return JointState(names, start + np.arange(len(names)), np.full(len(names), start))


def test_several_publishers_make_one_state(tmp_path: Path) -> None:
    first, second = JOINT_NAMES[:13][::-1], (*JOINT_NAMES[13:], "wheel")
    states = [state(first, 0), state(second, 1), state(first, 2), state(first, 3), state(second, 4), state(first, 5)]
    found = merged(states)
    assert [one is not None for one in found] == [False, True, False, False, True, True]
    for one, left, right in zip([one for one in found if one], (0, 3, 5), (1, 4, 4), strict=True):
        assert one.names == JOINT_NAMES
        assert one.position.tolist() == [*(left + np.arange(13))[::-1], *(right + np.arange(12))]
        assert one.velocity.tolist() == [left] * 13 + [right] * 12
    assert merged(states[:1]) == states[:1]  # of which nobody knows the rest: refused by the checks
    raws = [raw for raw in messages("trial") if raw.topic != topics.JOINT_STATES]
    type_ = topics.BY_TOPIC[topics.JOINT_STATES].value.type
    for i, half in enumerate((first, second)):
        data = codec.encode(type_, JointState(half, np.full(len(half), 0.1), np.zeros(0)), i, "")
        raws.append(Raw(topics.JOINT_STATES, 2_000_000_000 + i, data, type_))
    log = read(tmp_path, log_file(raws, metadata("trial")))
    assert observation(log).joint_positions.tolist() == [0.1] * 25


def test_joints_are_matched_by_name() -> None:
    names = ("left_wheel", *JOINT_NAMES[::-1])
    found = matched(JointState(names, np.arange(26.0), np.zeros(0)))
    assert (found.names, found.position.tolist()) == (JOINT_NAMES, list(range(25, 0, -1)))
    for bad in (
        JointState(JOINT_NAMES[1:], np.zeros(24), np.zeros(0)),
        JointState((*JOINT_NAMES, JOINT_NAMES[3]), np.zeros(26), np.zeros(0)),
        JointState(JOINT_NAMES[::-1], np.zeros(24), np.zeros(0)),
    ):
        assert matched(bad) is bad


def test_at_most_ten_problems_of_a_file_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    type_ = topics.BY_TOPIC[topics.TACTILE].value.type
    bad = [Raw(topics.TACTILE, i, codec.encode(type_, np.full(9, np.nan), i, ""), type_) for i in range(59)]
    (tmp_path / "trial_0001.mcap").write_bytes(log_file([*messages("trial"), *bad], metadata("trial")))
    assert main(["check", str(tmp_path / "trial_0001.mcap")]) == 1
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 11
    assert lines[-1] == "and 49 more problems of this file"


@pytest.mark.parametrize("kind", ["JPEG", "PNG"])
@pytest.mark.parametrize("turned", range(10))
def test_pictures_are_turned_as_they_say(kind: str, turned: int) -> None:
    picture = Pillow.fromarray(np.arange(40 * 64 * 3).reshape(40, 64, 3).astype(np.uint8) // 4 * 4)
    exif = Pillow.Exif()
    exif[0x0112] = turned
    stream = io.BytesIO()
    picture.save(stream, kind, exif=exif)
    expected = ImageOps.exif_transpose(Pillow.open(stream)).convert("RGB")
    found = decode_image(stream.getvalue())
    assert found.shape == np.asarray(expected).shape
    np.testing.assert_allclose(found.astype(int), np.asarray(expected).astype(int), atol=0 if kind == "PNG" else 3)


def test_a_picture_with_damaged_exif_data_is_upright() -> None:
    stream = io.BytesIO()
    Pillow.new("RGB", (64, 40), "red").save(stream, "JPEG", exif=b"Exif\0\0MM\0*\xff\xff\xff\xff")
    assert decode_image(stream.getvalue()).shape == (40, 64, 3)


def camera_message(**change: Any) -> bytes:
    store: Any = codec._store()
    value = CameraInfo(400, 300, np.array([[240.0, 0, 200], [0, 250.0, 150], [0, 0, 1]]), np.zeros(5), "eye")
    message = store.deserialize_cdr(codec.encode(topics.CAMERA_INFO, value, 0, ""), topics.CAMERA_INFO)
    for name, one in change.items():
        *path, last = name.split("__")
        setattr(getattr(message, path[0]) if path else message, last, one)
    return bytes(store.serialize_cdr(message, topics.CAMERA_INFO))


def test_region_and_binning_are_taken_into_account() -> None:
    """As ROS has it: width, height and K are of the whole sensor, the picture is a region of it, binned."""
    found = codec.decode(
        topics.CAMERA_INFO,
        camera_message(binning_x=2, binning_y=5, roi__x_offset=40, roi__y_offset=50, roi__width=320, roi__height=200),
    )
    assert isinstance(found, CameraInfo)
    assert (found.width, found.height) == (160, 40)
    assert found.K.tolist() == [[120, 0, 80], [0, 50, 20], [0, 0, 1]]
    plain = codec.decode(topics.CAMERA_INFO, camera_message(binning_x=1, binning_y=1))
    assert isinstance(plain, CameraInfo)
    assert (plain.width, plain.height, plain.K[0, 2]) == (400, 300, 200)


@pytest.mark.parametrize("model", ["plumb_bob", "rational_polynomial", "equidistant", ""])
def test_the_model_of_distortion_is_kept(model: str) -> None:
    value = CameraInfo(400, 300, np.eye(3), np.array([0.1, 0.2, 0.3, 0.4]), "eye", model)
    found = codec.decode(topics.CAMERA_INFO, codec.encode(topics.CAMERA_INFO, value, 0, ""))
    assert isinstance(found, CameraInfo)
    assert (found.model, found.D.tolist()) == (model, value.D.tolist())
