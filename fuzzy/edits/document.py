"""Edits of the whole document: its name, its notes, its operators."""

from __future__ import annotations

from typing import Any

from msgspec.structs import replace

from fuzzy.errors import InvalidSystemError, expected
from fuzzy.system import FuzzySystem
from fuzzy.validation import validate


def set_name(system: FuzzySystem, name: str) -> FuzzySystem:
    """Name the system."""
    return validate(replace(system, name=name))


def set_notes(system: FuzzySystem, notes: str) -> FuzzySystem:
    """Replace the notes."""
    return validate(replace(system, notes=notes))


def set_inference(system: FuzzySystem, **changes: Any) -> FuzzySystem:
    """Change operators, defuzzifier or resolution; keywords are the fields of :class:`fuzzy.system.Inference`."""
    valid = system.inference.__struct_fields__
    for field in changes:
        if field not in valid:
            raise InvalidSystemError(f"unknown option {expected(field, valid)}", "inference")
    return validate(replace(system, inference=replace(system.inference, **changes)))
