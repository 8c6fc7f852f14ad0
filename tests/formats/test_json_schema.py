"""The JSON Schema is the one of the types, accepts what is valid, and refuses what has another form."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings

from fuzzy import formats
from fuzzy.export.json_schema import json_schema, text
from tests.strategies import systems

RULEBASES = Path(__file__).parents[2] / "rulebases"
SCHEMA = json_schema()


def accepts(schema: dict[str, Any], value: Any) -> bool:
    """Validate by the keywords that the schema uses."""
    types: dict[str, Any] = {
        "object": dict,
        "array": list,
        "string": str,
        "boolean": bool,
        "null": type(None),
        "number": (int, float),
        "integer": int,
    }
    if "oneOf" in schema:
        return sum(accepts(entry, value) for entry in schema["oneOf"]) == 1
    if "const" in schema or "enum" in schema:
        return value in schema.get("enum", [schema.get("const")])
    if not isinstance(value, types[schema["type"]]) or (isinstance(value, bool) and schema["type"] != "boolean"):
        return False
    match value:
        case dict():
            known, others = schema.get("properties", {}), schema["additionalProperties"]
            return (
                set(schema.get("required", ())) <= set(value)
                and schema.get("minProperties", 0) <= len(value) <= schema.get("maxProperties", 1000)
                and all(
                    accepts(known[key], entry) if key in known else bool(others) and accepts(others, entry)
                    for key, entry in value.items()
                )
            )
        case list():
            is_long = schema.get("minItems", 0) <= len(value) <= schema["maxItems"]
            return is_long and all(accepts(schema["items"], entry) for entry in value)
        case str():
            is_long = schema.get("minLength", 0) <= len(value) <= schema.get("maxLength", 10**6)
            return is_long and bool(re.search(schema.get("pattern", ""), value))
        case int() | float() if schema["type"] != "boolean":
            above = schema.get("exclusiveMinimum", float("-inf"))
            return schema.get("minimum", float("-inf")) <= value <= schema.get("maximum", float("inf")) and (
                value > above or above == float("-inf")
            )
    return True


def test_the_file_is_up_to_date() -> None:
    assert (RULEBASES / "fuzzy-workbench-1.schema.json").read_text(encoding="utf-8") == text()
    assert json.loads(text()) == SCHEMA


@pytest.mark.parametrize("path", sorted(RULEBASES.glob("*.yaml")), ids=lambda path: path.name)
def test_shipped_rule_bases_are_valid(path: Path) -> None:
    assert accepts(SCHEMA, yaml.safe_load(path.read_text(encoding="utf-8")))


@settings(max_examples=60)
@given(systems())
def test_whatever_is_written_is_valid(system: Any) -> None:
    assert accepts(SCHEMA, yaml.safe_load(formats.dumps(system)))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("fuzzy-workbench/1", "fuzzy-workbench/2"),
        ("defuzzifier: centroid", "defuzzifier: centre"),
        ("resolution: exact", "resolution: {points: 1}"),
        ("{triangle: [", "{triangel: ["),
        ("range: [-1, 1]", "range: [-1, 0, 1]"),
        ("name: diagonal", "name: diagonal\ntitle: x"),
        ("    rows: e\n", ""),
    ],
)
def test_other_forms_are_not(old: str, new: str) -> None:
    written = formats.dumps(formats.load(RULEBASES / "diagonal.yaml"))
    assert old in written
    assert not accepts(SCHEMA, yaml.safe_load(written.replace(old, new, 1)))


def test_an_output_has_more_terms_than_an_input() -> None:
    document = yaml.safe_load(formats.dumps(formats.load(RULEBASES / "diagonal.yaml")))
    many = {f"t{number}": {"singleton": [number]} for number in range(256)}
    document["outputs"]["T"]["terms"] = many
    assert accepts(SCHEMA, document)
    document["inputs"]["e"]["terms"] = many
    assert not accepts(SCHEMA, document)
