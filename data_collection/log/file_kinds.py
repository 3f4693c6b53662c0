"""What a file is that is no MCAP file, or only the beginning of one, and what helps."""

_CONVERT = (
    "convert it: `.venv/bin/rosbags-convert --src {} --dst converted --dst-storage mcap "
    "--dst-typestore ros2_humble`, and take the .mcap file in the folder `converted`"
)
_UNPACK = "unpack it first ({})"
MAGIC = b"\x89MCAP0\r\n"
_FOREIGN: tuple[tuple[bytes, str], ...] = (
    (b"#ROSBAG V", f"is a bag of ROS 1; {_CONVERT.format('THE_BAG')}"),
    (b"SQLite format 3\0", f"is a bag of ROS 2 in SQLite storage; {_CONVERT.format('ITS_FOLDER')}"),
    (b"(\xb5/\xfd", f"is compressed as a whole by zstd; {_UNPACK.format('`unzstd FILE`')}"),
    (b'\x04"M\x18', f"is compressed as a whole by lz4; {_UNPACK.format('`unlz4 FILE`')}"),
    (b"\x1f\x8b", f"is compressed as a whole by gzip; {_UNPACK.format('`gunzip FILE`')}"),
    (b"BZh", f"is compressed as a whole by bzip2; {_UNPACK.format('`bunzip2 FILE`')}"),
    (b"\xfd7zXZ\0", f"is compressed as a whole by xz; {_UNPACK.format('`unxz FILE`')}"),
    (b"PK\x03\x04", f"is a zip archive; {_UNPACK.format('`unzip FILE`')}"),
    (b"version https://git-lfs", "is a pointer of Git LFS and not the file itself; fetch it: `git lfs pull`"),
    (b"\x89HDF\r\n", "is an HDF5 file; write logs from its arrays, see docs/own_robot.md"),
    (b"PAR1", "is a Parquet file; feature tables go into a config by `features:`, see docs/own_features.md"),
    (b"rosbag2_bagfile_information", "is the description of a bag of ROS 2; its .mcap file beside it is meant"),
)


def foreign(content: bytes) -> str | None:
    """Return what a file is by its first bytes, and what helps; None where it begins as an MCAP file does."""
    if content.startswith(MAGIC):
        return None
    if not content.strip(b"\0"):
        return "is empty" if not content else f"holds nothing but {len(content):,} zeros: it was never written out"
    for start, says in _FOREIGN:
        if content.startswith(start):
            return says
    if content[257:262] == b"ustar":
        return f"is a tar archive; {_UNPACK.format('`tar xf FILE`')}"
    if content.startswith(MAGIC[:5]):
        return f"is an MCAP file of another version of the format ({content[:8]!r}; {MAGIC!r} is read)"
    return f"is not an MCAP file: it begins with {content[:8]!r}"


def is_cut(content: bytes) -> bool:
    """Whether an MCAP file lacks its end: its recorder was stopped, or it was copied in part."""
    return not content.endswith(MAGIC) or len(content) < 2 * len(MAGIC)


CUT = (
    "is an MCAP file without its end: its recorder was stopped before it could close the file, or the file was "
    "copied in part; copy it again, or save what is whole: `mcap recover FILE -o saved.mcap` (mcap.dev/guides/cli)"
)
