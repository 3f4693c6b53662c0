"""The config section: its schema, its defaults, and what it refuses."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from features.extraction_settings import FeatureSettings, schema

SCHEMA = Path(__file__).parents[2] / "workflow" / "schemas" / "feature_extraction.schema.json"


def test_the_schema_file_is_the_settings_own_schema() -> None:
    stored = json.loads(SCHEMA.read_text(encoding="utf-8"))
    assert stored.pop("$schema") == "https://json-schema.org/draft/2020-12/schema"
    assert stored == schema()
    Draft202012Validator.check_schema(stored)


def defaults(part: dict[str, Any]) -> dict[str, Any]:
    return {key: defaults(entry) if entry["type"] == "object" else entry["default"]
            for key, entry in part["properties"].items()
            if "type" in entry} | {key: entry["default"] for key, entry in part["properties"].items()
                                   if "type" not in entry}  # fmt: skip


def test_defaults_of_schema_and_settings_agree() -> None:
    assert defaults(schema()) == asdict(FeatureSettings())
    assert FeatureSettings.model_validate({}) == FeatureSettings.model_validate(None) == FeatureSettings()
    assert FeatureSettings.model_validate(defaults(schema())) == FeatureSettings()


def test_every_setting_is_closed_and_described() -> None:
    for part in (schema(), schema()["properties"]["detection"]):
        assert part["additionalProperties"] is False
        for entry in part["properties"].values():
            assert len(entry["description"]) > 10
            assert {"enum", "minimum", "minLength", "properties"} & set(entry)


def settings() -> list[tuple[str, dict[str, Any]]]:
    top = schema()["properties"]
    nested = top["detection"]["properties"].items()
    return [(key, entry) for key, entry in top.items() if key != "detection"] + [
        (f"detection.{key}", entry) for key, entry in nested
    ]


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


@pytest.mark.parametrize(("key", "value"), BAD)
def test_bad_values_are_refused_by_name(key: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"feature_extraction.{key}"):
        FeatureSettings.model_validate(mapping(key, value))


@pytest.mark.parametrize("key", ["componants", "detection.bluur"])
def test_unknown_keys_are_refused_with_the_known_ones(key: str) -> None:
    with pytest.raises(ValueError, match=r"unexpected.*allowed: .*(components|blur)"):
        FeatureSettings.model_validate(mapping(key, 1))


def test_all_problems_at_once() -> None:
    with pytest.raises(ValueError, match="components") as error:
        FeatureSettings.model_validate({"components": 0, "scale": "big", "detection": {"blur": -1}})
    assert len(str(error.value).splitlines()) == 3


def test_fewest_objects_is_not_above_most() -> None:
    with pytest.raises(ValueError, match="fewest_objects: above"):
        FeatureSettings.model_validate({"detection": {"fewest_objects": 5}})


def test_canonical_text_tells_settings_apart() -> None:
    assert FeatureSettings().canonical() == FeatureSettings.model_validate({"components": 30}).canonical()
    assert FeatureSettings().canonical() != FeatureSettings.model_validate({"components": 31}).canonical()
