"""Messages as ROS 2 bytes (CDR) and back, without ROS."""

import functools
import io
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
    """Return a PNG or JPEG as RGB (H, W, 3).

    Raises:
        ValueError: The bytes are no image, or one of more than `MAX_PIXELS`.
    """
    import cv2
    from PIL import Image as Pillow
    from PIL import UnidentifiedImageError

    # The size is read from the header first: a few bytes can claim gigabytes of pixels.
    try:
        with Pillow.open(io.BytesIO(data), formats=("PNG", "JPEG")) as header:
            width, height = header.size
    except (UnidentifiedImageError, Pillow.DecompressionBombError) as error:
        raise ValueError(f"no PNG or JPEG of at most {MAX_PIXELS:,} pixels") from error
    if width * height > MAX_PIXELS:
        raise ValueError(f"image of {width:,} × {height:,} pixels, at most {MAX_PIXELS:,} are read")
    image = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_COLOR)
    if image is None or image.shape[:2] != (height, width):
        raise ValueError("the image is damaged")
    return np.ascontiguousarray(image[:, :, ::-1])


def encode(type_name: str, value: Value, time: int, frame: str) -> bytes:
    """Return `value` as a CDR message of a type in `TOPICS`.

    Args:
        type_name: ROS 2 type.
        value: Decoded value, as `decode` gives it.
        time: Stamp of the header, nanoseconds.
        frame: Frame of the header.
    """
    store = _store()
    types = store.types

    def header(name: str = frame) -> Any:
        stamp = types["builtin_interfaces/msg/Time"](sec=time // NANOSECONDS, nanosec=time % NANOSECONDS)
        return types["std_msgs/msg/Header"](stamp=stamp, frame_id=name)

    def point(numbers: Floats) -> Any:
        x, y, z = (float(number) for number in numbers)
        return types["geometry_msgs/msg/Point"](x=x, y=y, z=z)

    def quaternion(numbers: Floats) -> Any:
        x, y, z, w = (float(number) for number in numbers)
        return types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w)

    def pose(numbers: Floats) -> Any:
        return types["geometry_msgs/msg/Pose"](position=point(numbers[:3]), orientation=quaternion(numbers[3:]))

    def transform(item: Transform) -> Any:
        x, y, z = (float(number) for number in item.pose[:3])
        inner = types["geometry_msgs/msg/Transform"](
            translation=types["geometry_msgs/msg/Vector3"](x=x, y=y, z=z), rotation=quaternion(item.pose[3:])
        )
        return types["geometry_msgs/msg/TransformStamped"](
            header=header(item.parent), child_frame_id=item.child, transform=inner
        )

    kind = types[type_name]
    message: Any
    if type_name == topics.TEXT:
        message = kind(data=str(value))
    elif type_name == topics.NUMBER:
        message = kind(data=float(value))  # type: ignore[arg-type]
    elif type_name == topics.NUMBERS:
        layout = types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
        message = kind(layout=layout, data=np.asarray(value, dtype=np.float64))
    elif type_name == topics.POINT:
        message = kind(header=header(), point=point(np.asarray(value)))
    elif type_name == topics.POSE:
        message = kind(header=header(), pose=pose(np.asarray(value)))
    elif type_name == topics.POSES:
        message = kind(header=header(), poses=[pose(row) for row in np.asarray(value).reshape(-1, 7)])
    elif type_name == topics.IMAGE:
        data = np.frombuffer(encode_png(np.asarray(value, dtype=np.uint8)), dtype=np.uint8)
        message = kind(header=header(), format="png", data=data)
    elif isinstance(value, JointState):
        empty = np.zeros(0)
        message = kind(
            header=header(), name=list(value.names), position=value.position, velocity=value.velocity, effort=empty
        )
    elif isinstance(value, CameraInfo):
        projection = np.hstack([value.K, np.zeros((3, 1))])
        region = types["sensor_msgs/msg/RegionOfInterest"](
            x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        message = kind(
            header=header(value.frame), height=value.height, width=value.width,
            distortion_model="plumb_bob", d=value.D, k=value.K.ravel(), r=np.eye(3).ravel(), p=projection.ravel(),
            binning_x=0, binning_y=0, roi=region,
        )  # fmt: skip
    elif type_name == topics.TRANSFORMS and isinstance(value, tuple):
        message = kind(transforms=[transform(item) for item in value])
    else:
        raise TypeError(f"a {type(value).__name__} is no {type_name}")
    return bytes(store.serialize_cdr(message, type_name))


def decode(type_name: str, data: bytes) -> Value:
    """Return the plain value of a CDR message; the inverse of `encode`.

    Raises:
        ValueError: An image cannot be decoded; damaged CDR raises errors of other types too.
    """
    message = _store().deserialize_cdr(data, type_name)
    if type_name == topics.TEXT:
        return str(message.data)
    if type_name == topics.NUMBER:
        return float(message.data)
    if type_name == topics.NUMBERS:
        return np.array(message.data, dtype=np.float64)
    if type_name == topics.POINT:
        return np.array([message.point.x, message.point.y, message.point.z])
    if type_name == topics.POSE:
        return _pose(message.pose.position, message.pose.orientation)
    if type_name == topics.POSES:
        rows = [_pose(item.position, item.orientation) for item in message.poses]
        return np.array(rows, dtype=np.float64).reshape(-1, 7)
    if type_name == topics.IMAGE:
        return decode_image(message.data.tobytes())
    if type_name == topics.JOINT_STATE:
        return JointState(
            tuple(message.name),
            np.array(message.position, dtype=np.float64),
            np.array(message.velocity, dtype=np.float64),
        )
    if type_name == topics.CAMERA_INFO:
        matrix = np.array(message.k, dtype=np.float64).reshape(3, 3)
        distortion = np.array(message.d, dtype=np.float64)
        return CameraInfo(int(message.width), int(message.height), matrix, distortion, str(message.header.frame_id))
    if type_name == topics.TRANSFORMS:
        return tuple(
            Transform(
                str(item.header.frame_id),
                str(item.child_frame_id),
                _pose(item.transform.translation, item.transform.rotation),
            )
            for item in message.transforms
        )
    raise ValueError(f"messages of type {type_name} cannot be decoded")


def _pose(position: Any, orientation: Any) -> Floats:
    return np.array(
        [position.x, position.y, position.z, orientation.x, orientation.y, orientation.z, orientation.w],
        dtype=np.float64,
    )
