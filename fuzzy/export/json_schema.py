"""The JSON Schema of rule base files, for editors that complete and check YAML; generated from the document's types.

``python -m fuzzy.export.json_schema > rulebases/fuzzy-workbench-1.schema.json`` writes it anew.
"""

from __future__ import annotations

import json
import typing
from typing import Any

from fuzzy import shapes
from fuzzy import system as document
from fuzzy.formats.yaml import OPERATOR_KEYS
from fuzzy.limits import (
    MAX_NAME,
    MAX_NOTES,
    MAX_OUTPUT_TERMS,
    MAX_POINTS,
    MAX_RULES,
    MAX_TERMS,
    MAX_VARIABLES,
    MIN_POINTS,
)
from fuzzy.system import SCHEMA, Inference

_NAME = {"type": "string", "minLength": 1, "maxLength": MAX_NAME}
_NUMBER = {"type": "number"}


def json_schema() -> dict[str, Any]:
    """Return the schema, draft 2020-12. It knows forms and words; names and orders are the reader's to check."""
    hints = typing.get_type_hints(Inference)
    operators = {key: _words(hints[field]) for key, field in OPERATOR_KEYS.items()}
    rule = {"type": "string", "pattern": "^\\s*[iI][fF]\\s"}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"Rule base of the fuzzy workbench, {SCHEMA}",
        **_object(
            {
                "schema": {"const": SCHEMA},
                "name": _NAME,
                "notes": {"type": "string", "maxLength": MAX_NOTES},
                "inputs": _named(_variable({"out_of_range": _words(document.OutOfRange)}, MAX_TERMS), MAX_VARIABLES),
                "outputs": _named(_variable({"no_fire": _no_fire()}, MAX_OUTPUT_TERMS), MAX_VARIABLES),
                "rules": _object({"table": _table(), "list": {"type": "array", "items": rule, "maxItems": MAX_RULES}}),
                "inference": _object({**operators, "resolution": _resolution()}),
            },
            required=("schema", "name", "inputs", "outputs"),
        ),
    }


def _object(properties: dict[str, Any], required: tuple[str, ...] = ()) -> dict[str, Any]:
    found = {"type": "object", "properties": properties, "additionalProperties": False}
    return {**found, "required": list(required)} if required else found


def _words(kind: Any) -> dict[str, Any]:
    return {"enum": list(typing.get_args(kind))}


def _named(entry: dict[str, Any], most: int) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": entry, "minProperties": 1, "maxProperties": most}


def _numbers(count: int) -> dict[str, Any]:
    return {"type": "array", "items": _NUMBER, "minItems": count, "maxItems": count}


def _variable(more: dict[str, Any], most_terms: int) -> dict[str, Any]:
    unit = {"type": "string", "maxLength": MAX_NAME}
    properties = {"range": _numbers(2), "unit": unit, **more, "terms": _named(_term(), most_terms)}
    return _object(properties, required=("range", "terms"))


def _term() -> dict[str, Any]:
    """Return one shape, and perhaps height and complement."""
    more = {"height": {"type": "number", "exclusiveMinimum": 0, "maximum": 1}, "complement": {"type": "boolean"}}
    kinds = {shapes.kind(kind): _parameters(kind) for kind in shapes.KINDS}
    return {"oneOf": [_object({word: entry, **more}, required=(word,)) for word, entry in kinds.items()]}


def _parameters(kind: Any) -> dict[str, Any]:
    if kind is shapes.Points:
        return {"type": "array", "items": _numbers(2), "minItems": 1, "maxItems": shapes.MAX_POINTS}
    if kind is shapes.Linear:
        return {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": MAX_VARIABLES + 1}
    names = shapes.parameter_names(kind)
    return {**_numbers(len(names)), "description": ", ".join(names)}


def _no_fire() -> dict[str, Any]:
    words = [policy for policy in typing.get_args(document.NoFirePolicy) if policy != "default"]
    return {"oneOf": [{"enum": words}, _object({"default": _NUMBER}, required=("default",))]}


def _table() -> dict[str, Any]:
    cell = {"oneOf": [_NAME, {"type": "null"}]}
    row = {"type": "array", "items": cell, "minItems": 1, "maxItems": MAX_TERMS}
    names = ("rows", "columns", "output")
    return _object({**dict.fromkeys(names, _NAME), "cells": _named(row, MAX_TERMS)}, required=(*names, "cells"))


def _resolution() -> dict[str, Any]:
    points = {"type": "integer", "minimum": MIN_POINTS, "maximum": MAX_POINTS}
    sampled = _object({"points": points, "rule": _words(document.SamplingRule)}, required=("points",))
    return {"oneOf": [{"const": "exact"}, sampled]}


def text() -> str:
    """Return the schema as the text of its file."""
    return json.dumps(json_schema(), indent=1) + "\n"


if __name__ == "__main__":
    print(text(), end="")
