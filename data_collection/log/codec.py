"""Messages as ROS 2 bytes (CDR) and back, without ROS."""

import functools
import io
import warnings
from collections.abc import Callable
from operator import attrgetter
from typing import Any

import numpy as np

from data_collection.limits import MAX_PIXELS
from data_collection.log import topics
from data_collection.log.messages import CameraInfo, Floats, Image, JointState, Transform, Value

NANOSECONDS = 1_000_000_000


@functools.cache
def _store() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_HUMBLE)


def definition(type_name: str) -> bytes:
    """Return the full message definition (`ros2msg` schema) of a type."""
    text, _ = _store().generate_msgdef(type_name, ros_version=2)
    return str(text).encode()


def encode_png(image: Image) -> bytes:
    """Return an RGB image (H, W, 3) as PNG."""
    import cv2

    done, data = cv2.imencode(".png", np.ascontiguousarray(image[:, :, ::-1]), [cv2.IMWRITE_PNG_COMPRESSION, 4])
    if not done:
        raise ValueError(f"image of shape {image.shape} cannot be encoded")
    return bytes(data.tobytes())


def decode_image(data: bytes) -> Image:
    """Return a PNG or JPEG as RGB (H, W, 3), turned as its EXIF data say, as every viewer shows it.

    Raises:
        ValueError: The bytes are no image, or one of more than `MAX_PIXELS`.
    """
    import cv2
    from PIL import Image as Pillow
    from PIL import UnidentifiedImageError

    # The size is read from the header first: a few bytes can claim gigabytes of pixels.
    try:
        with (
            warnings.catch_warnings(action="ignore"),  # of EXIF data that are damaged
            Pillow.open(io.BytesIO(data), formats=("PNG", "JPEG")) as header,
        ):
            width, height = header.size
            turned = _orientation(header, data) if width * height <= MAX_PIXELS else _UPRIGHT
    except (UnidentifiedImageError, Pillow.DecompressionBombError) as error:
        raise ValueError(f"no PNG or JPEG of at most {MAX_PIXELS:,} pixels") from error
    if width * height > MAX_PIXELS:
        raise ValueError(f"image of {width:,} × {height:,} pixels, at most {MAX_PIXELS:,} are read")
    how = cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION  # which of the formats OpenCV turns depends on its version
    image = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), how)
    if image is None or image.shape[:2] != (height, width):
        raise ValueError("the image is damaged")
    return np.ascontiguousarray(_TURNS[turned](image)[:, :, ::-1])


_ORIENTATION, _UPRIGHT = 0x0112, 1  # EXIF's tag, and its value for a picture that is not turned
# By the number that EXIF has for it: from the picture as it is stored to the picture as it is meant.
_TURNS: dict[int, Callable[[Image], Image]] = {
    _UPRIGHT: lambda image: image,
    2: lambda image: image[:, ::-1],
    3: lambda image: image[::-1, ::-1],
    4: lambda image: image[::-1],
    5: lambda image: image.transpose(1, 0, 2),
    6: lambda image: image.transpose(1, 0, 2)[:, ::-1],
    7: lambda image: image.transpose(1, 0, 2)[::-1, ::-1],
    8: lambda image: image.transpose(1, 0, 2)[::-1],
}


def _orientation(header: Any, data: bytes) -> int:
    """Return how EXIF data say that a picture is turned, 1 where they do not."""
    if b"Exif" not in data and b"eXIf" not in data:  # to look for them, Pillow unpacks all pixels of a PNG
        return _UPRIGHT
    try:
        turned = header.getexif().get(_ORIENTATION, _UPRIGHT)
    except Exception:  # damaged EXIF data surface as struct, syntax, key, … errors; the picture may be sound
        return _UPRIGHT
    return turned if turned in _TURNS else _UPRIGHT


Header = Callable[..., Any]
"""Gives the header of a message, in the frame of its topic or in another one."""


def _new(name: str, *fields: Any) -> Any:
    """A message, whose fields stand in the order of its definition."""
    return _store().types[name.replace("/", "/msg/")](*fields)


def _vector(name: str, axes: str, numbers: Floats) -> Any:
    return _store().types[f"geometry_msgs/msg/{name}"](**dict(zip(axes, map(float, numbers), strict=True)))


def _pose(pose: Floats) -> Any:
    return _new("geometry_msgs/Pose", _vector("Point", "xyz", pose[:3]), _vector("Quaternion", "xyzw", pose[3:]))


def _transform(item: Transform, header: Header) -> Any:
    moved, turned = _vector("Vector3", "xyz", item.pose[:3]), _vector("Quaternion", "xyzw", item.pose[3:])
    inner = _new("geometry_msgs/Transform", moved, turned)
    return _new("geometry_msgs/TransformStamped", header(item.parent), item.child, inner)


def _camera_fields(value: CameraInfo, header: Header) -> tuple[Any, ...]:
    projection = np.hstack([value.K, np.zeros((3, 1))])
    no_region, no_binning = _new("sensor_msgs/RegionOfInterest", 0, 0, 0, 0, False), (0, 0)
    matrices = value.D, value.K.ravel(), np.eye(3).ravel(), projection.ravel()
    return (header(value.frame), value.height, value.width, value.model, *matrices, *no_binning, no_region)


def _camera(message: Any) -> CameraInfo:
    """Width, height and K are those of the whole sensor; the picture may be a region of it, and binned."""
    matrix, frame = _floats(message.k).reshape(3, 3), str(message.header.frame_id)
    region, binning = message.roi, np.array([max(1, message.binning_x), max(1, message.binning_y)])
    size = np.array([region.width or message.width, region.height or message.height]) // binning
    matrix[:2, 2] -= [region.x_offset, region.y_offset]
    matrix[:2] /= binning[:, None]
    model = str(message.distortion_model)
    return CameraInfo(int(size[0]), int(size[1]), matrix, _floats(message.d), frame, model)


def _floats(values: Any) -> Floats:
    return np.array(values, dtype=np.float64)


def _numbers(place: Any, turn: Any) -> Floats:
    return np.array([*attrgetter(*"xyz")(place), *attrgetter(*"xyzw")(turn)])


# By type: the fields of a message from a value, and the value from a message.
_CODECS: dict[str, tuple[Callable[[Any, Header], tuple[Any, ...]], Callable[[Any], Value]]] = {
    topics.TEXT: (lambda value, header: (str(value),), lambda message: str(message.data)),
    topics.NUMBER: (lambda value, header: (float(value),), lambda message: float(message.data)),
    topics.NUMBERS: (
        lambda value, header: (_new("std_msgs/MultiArrayLayout", [], 0), _floats(value)),
        lambda message: _floats(message.data),
    ),
    topics.POINT: (
        lambda value, header: (header(), _vector("Point", "xyz", value)),
        lambda message: np.array(attrgetter(*"xyz")(message.point)),
    ),
    topics.POSE: (
        lambda value, header: (header(), _pose(value)),
        lambda message: _numbers(message.pose.position, message.pose.orientation),
    ),
    topics.POSES: (
        lambda value, header: (header(), [_pose(row) for row in _floats(value).reshape(-1, 7)]),
        lambda message: _floats([_numbers(one.position, one.orientation) for one in message.poses]).reshape(-1, 7),
    ),
    topics.IMAGE: (
        lambda value, header: (header(), "png", np.frombuffer(encode_png(np.asarray(value, np.uint8)), np.uint8)),
        lambda message: decode_image(message.data.tobytes()),
    ),
    topics.JOINT_STATE: (
        lambda value, header: (header(), list(value.names), value.position, value.velocity, np.zeros(0)),
        lambda message: JointState(tuple(message.name), _floats(message.position), _floats(message.velocity)),
    ),
    topics.CAMERA_INFO: (_camera_fields, _camera),
    topics.TRANSFORMS: (
        lambda value, header: ([_transform(one, header) for one in value],),
        lambda message: tuple(
            Transform(
                str(one.header.frame_id),
                str(one.child_frame_id),
                _numbers(one.transform.translation, one.transform.rotation),
            )
            for one in message.transforms
        ),
    ),
}


def encode(type_name: str, value: Value, time: int, frame: str) -> bytes:
    """Return `value` as a CDR message of a type in `TOPICS`.

    Args:
        type_name: ROS 2 type.
        value: Decoded value, as `decode` gives it.
        time: Stamp of the header, nanoseconds.
        frame: Frame of the header.

    Raises:
        TypeError: The value is none of that type.
    """

    def header(name: str = frame) -> Any:
        return _new("std_msgs/Header", _new("builtin_interfaces/Time", *divmod(time, NANOSECONDS)), name)

    store = _store()
    try:
        message = store.types[type_name](*_CODECS[type_name][0](value, header))
    except (AttributeError, TypeError) as error:
        raise TypeError(f"a {type(value).__name__} is no {type_name}") from error
    return bytes(store.serialize_cdr(message, type_name))


def decode(type_name: str, data: bytes) -> Value:
    """Return the plain value of a CDR message; the inverse of `encode`.

    Raises:
        ValueError: An image cannot be decoded; damaged CDR raises errors of other types too.
    """
    return _CODECS[type_name][1](_store().deserialize_cdr(data, type_name))
