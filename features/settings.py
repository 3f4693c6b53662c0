"""Every setting of the feature extraction: the section `feature_extraction:` of an experiment in the config."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from typing import Annotated, Any, Literal, cast, get_args, get_origin, get_type_hints

from data_collection.limits import PATH_PATTERN


@dataclass(frozen=True)
class About:
    """What a setting means and, for a number, its range; the JSON schema derives from it."""

    description: str
    lowest: float | None = None
    highest: float | None = None


@dataclass(frozen=True)
class Detection:
    """How objects are found against the empty table."""

    blur: Annotated[float, About("Standard deviation of the blur of both images, pixels; 0: none.", 0, 10)] = 0.7
    color_threshold: Annotated[
        float, About("Difference of color, in 8-bit values, from which a pixel is not the table.", 0, 255)
    ] = 14.0
    noise_factor: Annotated[
        float, About("The color threshold is at least so many times the noise of the two images.", 0, 100)
    ] = 6.0
    shadow: Annotated[
        float, About("Darkest shadow, as brightness relative to the table's; darker is object.", 0, 1)
    ] = 0.4
    highlight: Annotated[
        float,
        About("Brightest reflection, as brightness relative to the table's; brighter is object.", 1, 10),
    ] = 1.25
    smallest_area: Annotated[int, About("Smallest area of an object, pixels.", 1, 10**6)] = 60
    largest_share: Annotated[float, About("Largest share of the image that an object may cover.", 0, 1)] = 0.2
    neck: Annotated[
        float,
        About("Touching objects are cut at necks narrower than this share of the thinner one; 0: never.", 0, 1),
    ] = 0.5
    fewest_objects: Annotated[int, About("Fewest objects that are plausible in a trial.", 1, 1000)] = 1
    most_objects: Annotated[int, About("Most objects that are plausible in a trial.", 1, 1000)] = 3
    on_wrong_count: Annotated[
        Literal["error", "drop"],
        About("A trial with an implausible number of objects: stop, or drop it with a warning."),
    ] = "error"


@dataclass(frozen=True)
class FeatureSettings:
    """Settings of the features of one experiment; the defaults are the study's."""

    detection: Annotated[Detection, About("How objects are found against the empty table.")] = field(
        default_factory=Detection
    )
    crop_margin: Annotated[float, About("Margin around an object's crop, relative to its longer side.", 0, 2)] = 0.1
    weights: Annotated[
        str,
        About(
            "Weights of AlexNet: seeded (random, needs no file), imagenet1k (published, downloaded once), or "
            "the path of a torchvision AlexNet state dict."
        ),
    ] = "seeded"
    weights_seed: Annotated[int, About("Seed of the seeded weights.", 0, 2**53)] = 0
    appearance: Annotated[
        Literal["luminance", "rgb"],
        About("What the network sees: luminance, normalised inside the mask on a flat background, or the crop."),
    ] = "luminance"
    components: Annotated[int, About("Principal components kept of the 4096 numbers of fc6.", 1, 4096)] = 30
    scale: Annotated[
        Literal["global", "per_component", "none"],
        About(
            "Scaling of the components to [0, 1]: by one minimum and maximum over all (global), by each one's "
            "own (per_component), or none."
        ),
    ] = "global"
    colors: Annotated[int, About("Bins of the color histogram, from training pixels.", 1, 256)] = 10
    color_pixels: Annotated[
        int, About("Pixels that each training object lends to the color clusters, at most.", 1, 10**6)
    ] = 500
    mask_edge: Annotated[
        int,
        About("Rim of a mask, in pixels, that does not count for shape and color: it mixes with the table.", 0, 50),
    ] = 1

    @classmethod
    def from_mapping(cls, mapping: Mapping[str, Any] | None) -> FeatureSettings:
        """Make settings from the config section; keys left out take their defaults.

        Raises:
            ValueError: unknown keys, wrong types or values out of range; the message lists them all.

        """
        from jsonschema import Draft202012Validator

        values = dict(mapping or {})
        errors = sorted(Draft202012Validator(schema()).iter_errors(values), key=lambda error: error.json_path)
        problems = [f"feature_extraction{error.json_path[1:]}: {_explain(error)}" for error in errors]
        numbers = [*values.items(), *_nested(values.get("detection"))]
        problems += [f"feature_extraction.{key} is {value}; expected a finite number" for key, value in numbers
                     if isinstance(value, float) and not math.isfinite(value)]  # fmt: skip
        if problems:
            raise ValueError("\n".join(problems))
        settings = cls(**values | {"detection": Detection(**values.get("detection", {}))})
        if settings.detection.fewest_objects > settings.detection.most_objects:
            raise ValueError(
                "feature_extraction.detection.fewest_objects: above feature_extraction.detection.most_objects"
            )
        return settings

    def canonical(self) -> str:
        """Give the settings as JSON, the same text for the same settings."""
        return json.dumps(asdict(self), sort_keys=True, separators=(",", ":"))


def _nested(value: Any) -> list[tuple[str, Any]]:
    """Give the entries of the section `detection`, if it is one, with their paths."""
    return [(f"detection.{key}", entry) for key, entry in value.items()] if isinstance(value, Mapping) else []


def _explain(error: Any) -> str:
    """Say what is wrong and, for an unknown key, which are allowed."""
    if error.validator == "additionalProperties":
        return f"{error.message}; allowed: {', '.join(error.schema['properties'])}"
    return str(error.message)


def schema(cls: type[Any] = FeatureSettings) -> dict[str, Any]:
    """Give the closed JSON schema (draft 2020-12) of the settings, with defaults and ranges."""
    hints = get_type_hints(cls, include_extras=True)
    defaults = asdict(cls())
    properties = {}
    for item in fields(cls):
        kind, about = get_args(hints[item.name])
        entry: dict[str, Any] = {"description": about.description, "default": defaults[item.name]}
        if is_dataclass(kind):
            entry = {**schema(cast(type[Any], kind)), **entry}
        elif get_origin(kind) is Literal:
            entry["enum"] = list(get_args(kind))
        elif kind is str:
            entry |= {"type": "string", "minLength": 1, "maxLength": 4000, "pattern": PATH_PATTERN}
        else:
            number = {"type": "integer" if kind is int else "number"}
            entry |= number | {"minimum": about.lowest, "maximum": about.highest}
        properties[item.name] = entry
    return {
        "type": "object",
        "description": (cls.__doc__ or "").splitlines()[0],
        "additionalProperties": False,
        "properties": properties,
    }
