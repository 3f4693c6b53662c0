"""Every setting of the feature extraction: the section `feature_extraction:` of an experiment in the config."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from data_collection.strict_model import FilePath, StrictModel

Share = Annotated[float, Field(ge=0, le=1)]
Objects = Annotated[int, Field(ge=1, le=1000)]


class Detection(StrictModel):
    """How objects are found against the empty table."""

    blur: float = Field(
        0.7, ge=0, le=10, description="standard deviation of the blur of both images, pixels; 0: none"
    )
    color_threshold: float = Field(
        14.0, ge=0, le=255, description="difference of color, in 8-bit values, from which a pixel is not the table"
    )
    noise_factor: float = Field(
        6.0, ge=0, le=100, description="the color threshold is at least so many times the noise of the two images"
    )
    shadow: Share = Field(0.4, description="darkest shadow, as brightness relative to the table's; darker is object")
    highlight: float = Field(
        1.25,
        ge=1,
        le=10,
        description="brightest reflection, as brightness relative to the table's; brighter is object",
    )
    smallest_area: int = Field(60, ge=1, le=10**6, description="smallest area of an object, pixels")
    largest_share: Share = Field(0.2, description="largest share of the image that an object may cover")
    neck: Share = Field(
        0.5,
        description="touching objects are cut at necks narrower than this share of the thinner one; 0: never",
    )
    fewest_objects: Objects = Field(1, description="fewest objects that are plausible in a trial")
    most_objects: Objects = Field(
        3, description="most objects that are plausible in a trial; by default as many as are simulated, if more"
    )
    on_wrong_count: Literal["error", "drop"] = Field(
        "error", description="a trial with an implausible number of objects: stop, or drop it with a warning"
    )

    @model_validator(mode="after")
    def _fewest_is_not_above_most(self) -> Self:
        if self.fewest_objects > self.most_objects:
            raise ValueError(f"fewest_objects: {self.fewest_objects} is more than most_objects ({self.most_objects})")
        return self


class FeatureSettings(StrictModel):
    """How features are extracted from logs; every key has a default."""

    detection: Detection = Detection()
    crop_margin: float = Field(
        0.1, ge=0, le=2, description="margin around an object's crop, relative to its longer side"
    )
    weights: FilePath = Field(
        "seeded",
        description="weights of AlexNet: seeded (random, needs no file), imagenet1k (published, downloaded once), "
        "or the path of a torchvision AlexNet state dict",
    )
    weights_seed: int = Field(0, ge=0, le=2**53, description="seed of the seeded weights")
    appearance: Literal["luminance", "rgb"] = Field(
        "luminance",
        description="what the network sees: luminance, normalised inside the mask on a flat background, or the crop",
    )
    components: int = Field(30, ge=1, le=4096, description="principal components kept of the 4096 numbers of fc6")
    scale: Literal["global", "per_component", "none"] = Field(
        "global",
        description="scaling of the components to [0, 1]: by one minimum and maximum over all (global), "
        "by each one's own (per_component), or none",
    )
    colors: int = Field(10, ge=1, le=256, description="bins of the color histogram, from training pixels")
    color_pixels: int = Field(
        500, ge=1, le=10**6, description="pixels that each training object lends to the color clusters, at most"
    )
    mask_edge: int = Field(
        1,
        ge=0,
        le=50,
        description="rim of a mask, in pixels, that does not count for shape and color: it mixes with the table",
    )
