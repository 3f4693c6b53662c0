"""Objects in an image of the table, by background subtraction against an image of the empty table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from features.extraction_settings import Detection

Image = NDArray[np.uint8]
Mask = NDArray[np.bool_]

CROP_SIZE = 64
"""Side of an object's crop in pixels (paper, section 4.2.1)."""
_DARK = 40.0
"""Background darker than this (norm of RGB) tells nothing of relative brightness."""
_LESSER_PART = 0.4
"""A part thinner than this share of the thickest is no object of its own (the handle of a cup)."""


@dataclass(frozen=True, eq=False)
class Found:
    """One object in an image.

    Attributes:
        mask: bool (H, W), its pixels, holes filled.
        box: (left, top, right, bottom) in pixels, right and bottom exclusive.
    """

    mask: Mask
    box: tuple[int, int, int, int]


def detect(image: Image, empty: Image, settings: Detection) -> tuple[Found, ...]:
    """Find the objects that `image` shows and `empty`, the same view of the empty table, does not.

    Args:
        image: uint8 (H, W, 3) RGB.
        empty: uint8 (H, W, 3) RGB.
        settings: Thresholds.

    Returns:
        The objects from left to right by the middle of their boxes; none if there are none.

    Raises:
        ValueError: The images differ in size or are not RGB.
    """
    import cv2

    if image.shape != empty.shape or image.ndim != 3 or image.shape[2] != 3:
        raise ValueError(f"images of shapes {image.shape} and {empty.shape}; expected two alike (H, W, 3)")
    foreground = _close(_foreground(image, empty, settings))
    foreground = _trim(foreground, image, empty)
    found = []
    for component in _components(foreground, settings.smallest_area):
        for part in _cut_apart(component, settings):
            left, top, width, height = cv2.boundingRect(part.astype(np.uint8))
            if part.sum() <= settings.largest_share * part.size:
                found.append(Found(part, (left, top, left + width, top + height)))
    return tuple(sorted(found, key=lambda one: (one.box[0] + one.box[2], one.box[1])))


def _foreground(image: Image, empty: Image, settings: Detection) -> Mask:
    """Tell object from table, shaded or lit, by brightness and color distortion.

    A shadow keeps the table's color and scales its brightness; an object changes the color, or the brightness
    more than a shadow or a reflection can (Horprasert, Harwood and Davis 1999).
    """
    import cv2

    now, table = image.astype(np.float32), empty.astype(np.float32)
    if settings.blur > 0:
        now, table = (cv2.GaussianBlur(part, (0, 0), settings.blur) for part in (now, table))
    light = np.median(now.reshape(-1, 3), axis=0) / np.maximum(np.median(table.reshape(-1, 3), axis=0), 1)
    table = table * np.clip(light, 0.5, 2).astype(np.float32)  # the light of the room changes between trials
    power = np.einsum("hwc,hwc->hw", table, table)
    brightness = np.einsum("hwc,hwc->hw", now, table) / np.maximum(power, 1)
    color = np.linalg.norm(now - brightness[..., None] * table, axis=2)
    threshold = max(settings.color_threshold, settings.noise_factor * float(np.median(color)))
    too_dark_or_bright = (brightness < settings.shadow) | (brightness > settings.highlight)
    return np.asarray((color > threshold) | (too_dark_or_bright & (power > _DARK**2)))


def _close(mask: Mask) -> Mask:
    """Remove specks and gaps of one pixel, and fill holes."""
    import cv2

    cross = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))
    whole = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, cross)
    whole = cv2.morphologyEx(whole, cv2.MORPH_CLOSE, cross, iterations=2)
    outlines, _ = cv2.findContours(whole, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.asarray(cv2.drawContours(np.zeros_like(whole), outlines, -1, 1, cv2.FILLED), dtype=bool)


def _trim(mask: Mask, image: Image, empty: Image) -> Mask:
    """Cut the rim where a pixel is less than half object: blur and shadow spread it over its edge."""
    import cv2

    difference = np.linalg.norm(image.astype(np.float32) - empty.astype(np.float32), axis=2)
    around = cv2.dilate(difference * mask, np.ones((5, 5), dtype=np.uint8))
    rim = mask & ~cv2.erode(mask.astype(np.uint8), np.ones((5, 5), dtype=np.uint8)).astype(bool)
    return np.asarray(mask & ~(rim & (difference < 0.5 * around)))


def _components(mask: Mask, smallest_area: int) -> list[Mask]:
    """Split a mask into its connected parts of at least `smallest_area` pixels."""
    import cv2

    count, labels, statistics, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=4)
    return [labels == i for i in range(1, count) if statistics[i, cv2.CC_STAT_AREA] >= smallest_area]


def _cut_apart(component: Mask, settings: Detection) -> list[Mask]:
    """Cut a component at its necks.

    A part is an object of its own if it hangs on the rest by a neck narrower than `settings.neck` times its
    own thickness, both read from the distance to the edge.
    """
    import cv2

    distance = cv2.distanceTransform(np.pad(component, 1).astype(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    thickest = float(distance.max())
    best: list[Mask] = []
    for level in np.arange(0.5, settings.neck * thickest, 0.5):
        parts = [part for part in _components(distance > level, 1)
                 if distance[part].max() * settings.neck >= level
                 and distance[part].max() >= _LESSER_PART * thickest]  # fmt: skip
        if len(parts) > max(1, len(best)):
            best = parts
    if not best:
        return [component]
    seeds = np.sum([(i + 1) * part for i, part in enumerate(best)], axis=0)
    _, nearest = cv2.distanceTransformWithLabels((seeds == 0).astype(np.uint8), cv2.DIST_L2, 5)
    owner = np.zeros(int(nearest.max()) + 1, dtype=np.int64)
    owner[nearest[seeds > 0]] = seeds[seeds > 0]
    cut = [component & (owner[nearest] == i + 1) for i in range(len(best))]
    return cut if all(part.sum() >= settings.smallest_area for part in cut) else [component]


def without_rim(found: Found, width: int) -> Found:
    """Cut a rim of some pixels off the mask of an object: it shows a mixture of object and table.

    An object that is nothing but rim keeps its mask.
    """
    import cv2

    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * width + 1, 2 * width + 1))
    inner = cv2.erode(found.mask.astype(np.uint8), kernel, borderValue=0).astype(bool)
    return Found(inner, found.box) if inner.any() else found


def crop(image: Image, found: Found, margin: float) -> tuple[Image, Mask]:
    """Cut out a square around an object, resampled to 64 × 64 pixels (paper, section 4.2.1).

    Args:
        image: uint8 (H, W, 3) RGB.
        found: The object.
        margin: Margin around the box on each side, relative to its longer side. Beyond the image's edge, its
            outermost pixels are repeated.

    Returns:
        The crop, uint8 (64, 64, 3), and the object's mask in it, bool (64, 64).
    """
    import cv2

    left, top, right, bottom = found.box
    side = (1 + 2 * margin) * max(right - left, bottom - top)
    scale = CROP_SIZE / side
    shift = CROP_SIZE / 2 - scale * np.array([(left + right) / 2, (top + bottom) / 2])
    to_crop = np.array([[scale, 0, shift[0] + (scale - 1) / 2], [0, scale, shift[1] + (scale - 1) / 2]])
    size = (CROP_SIZE, CROP_SIZE)
    method = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    part = cv2.warpAffine(image, to_crop, size, flags=method, borderMode=cv2.BORDER_REPLICATE)
    mask = cv2.warpAffine(found.mask.astype(np.float32), to_crop, size, flags=cv2.INTER_LINEAR)
    return np.asarray(part, dtype=np.uint8), np.asarray(mask >= 0.5)
