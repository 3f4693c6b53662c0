"""The settings of the feature extraction: defaults, descriptions, and what is refused."""

import json
from typing import Any

import pytest
from pydantic import ValidationError

from features.extraction_settings import Detection, FeatureSettings


def settings() -> list[tuple[str, dict[str, Any]]]:
    schema = FeatureSettings.model_json_schema()
    named = schema["$defs"]["FilePath"]
    top = {key: (named if "$ref" in entry else {}) | entry for key, entry in schema["properties"].items()}
    nested = Detection.model_json_schema()["properties"].items()
    return [(key, entry) for key, entry in top.items() if key != "detection"] + [
        (f"detection.{key}", entry) for key, entry in nested
    ]


def test_defaults_are_valid_and_complete() -> None:
    assert FeatureSettings.model_validate({}) == FeatureSettings()
    assert FeatureSettings.model_validate(FeatureSettings().model_dump(mode="json")) == FeatureSettings()
    assert FeatureSettings.model_validate(json.loads(FeatureSettings().to_json())) == FeatureSettings()


def test_every_setting_is_described_and_limited() -> None:
    for key, entry in settings():
        assert len(entry["description"]) > 10, key
        assert {"enum", "minimum", "pattern"} & set(entry), key


def mapping(key: str, value: Any) -> dict[str, Any]:
    first, _, last = key.partition(".")
    return {first: {last: value}} if last else {first: value}


def bad_values(entry: dict[str, Any]) -> list[Any]:
    values: list[Any] = [None, [], {}]
    if "minimum" in entry:
        values += ["1", True, float("nan"), float("inf"), entry["minimum"] - 1, entry["maximum"] + 1]
        return [*values, 1.5] if entry["type"] == "integer" else values
    return [*values, 1, "", "typo"] if "enum" in entry else [*values, 1, ""]


BAD = [pytest.param(key, value, id=f"{key}={value!r}") for key, entry in settings() for value in bad_values(entry)]


def refused(given: dict[str, Any]) -> list[str]:
    """The keys that are refused."""
    with pytest.raises(ValidationError) as caught:
        FeatureSettings.model_validate(given)
    return [".".join(map(str, error["loc"])) for error in caught.value.errors()]


@pytest.mark.parametrize(("key", "value"), BAD)
def test_bad_values_are_refused_by_name(key: str, value: Any) -> None:
    assert refused(mapping(key, value)) == [key]


@pytest.mark.parametrize("key", ["componants", "detection.bluur"])
def test_unknown_keys_are_refused(key: str) -> None:
    assert refused(mapping(key, 1)) == [key]


def test_all_problems_at_once() -> None:
    wrong = {"components": 0, "scale": "big", "detection": {"blur": -1}}
    assert refused(wrong) == ["detection.blur", "components", "scale"]


def test_fewest_objects_is_not_above_most() -> None:
    with pytest.raises(ValueError, match=r"fewest_objects: 5 is more than most_objects \(3\)"):
        FeatureSettings.model_validate({"detection": {"fewest_objects": 5}})


def test_canonical_text_tells_settings_apart() -> None:
    assert FeatureSettings().to_json() == FeatureSettings.model_validate({"components": 30}).to_json()
    assert FeatureSettings().to_json() != FeatureSettings.model_validate({"components": 31}).to_json()
