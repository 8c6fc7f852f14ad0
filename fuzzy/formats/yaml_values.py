"""Typed values of a YAML tree, or an error at the node that says what was found and what is valid.

Names stay texts whatever they look like; numbers are those of YAML 1.2's core schema.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from fuzzy.errors import expected, shown
from fuzzy.formats.yaml_tree import Node, describe

_MAX_NUMBER = 64
"""Greatest length of a number's text."""

_DECIMAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_OCTAL = re.compile(r"0o[0-7]+")
_HEXADECIMAL = re.compile(r"0x[0-9a-fA-F]+")
_INFINITE = re.compile(r"([-+]?)\.(inf|Inf|INF)")
_NOT_A_NUMBER = frozenset({".nan", ".NaN", ".NAN"})


def entries(node: Node, what: str = "a mapping") -> dict[str, Node]:
    """Return the entries of a mapping whose keys are free names."""
    if not isinstance(node.value, dict):
        raise node.error(f"expected {what}, found {describe(node)}")
    return node.value


def fields(node: Node, required: Iterable[str], optional: Iterable[str] = ()) -> dict[str, Node]:
    """Return the entries of a mapping whose keys are the schema's.

    Raises:
        FormatError: For an unknown key (at the key, with the nearest valid one) or a missing one.
    """
    required = tuple(required)
    valid = (*required, *optional)
    found = entries(node, f"a mapping with the keys {', '.join(valid)}")
    for key, entry in found.items():
        if key not in valid:
            raise entry.key_error(f"unknown key {expected(shown(key), valid)}")
    for key in required:
        if key not in found:
            raise node.error(f"the key '{key}' is missing")
    return found


def items(node: Node, what: str = "a list") -> list[Node]:
    """Return the nodes of a list."""
    if not isinstance(node.value, list):
        raise node.error(f"expected {what}, found {describe(node)}")
    return node.value


def text(node: Node, what: str = "a text") -> str:
    """Return a text, whatever it looks like: ``NO`` and ``1e3`` are texts where a name is expected."""
    if not isinstance(node.value, str) or (node.is_plain and node.value in {"", "~"}):
        raise node.error(f"expected {what}, found {describe(node)}")
    return node.value


def choice(node: Node, valid: Iterable[str]) -> str:
    """Return one of the valid words."""
    valid = tuple(valid)
    if not isinstance(node.value, str) or node.value == "":
        raise node.error(f"expected one of {', '.join(valid)}, found {describe(node)}")
    if node.value not in valid:
        raise node.error(f"unknown word {expected(shown(node.value), valid)}")
    return node.value


def number(node: Node, *, finite: bool = True) -> float:
    """Return a number of YAML 1.2's core schema; infinite ones only where ``finite`` is false, NaN never."""
    value = _number(node.value) if isinstance(node.value, str) and node.is_plain else None
    if value is None:
        raise node.error(f"expected a number such as 0.5, 1e3 or -.inf, found {describe(node)}")
    if math.isnan(value):
        raise node.error("expected a number, found .nan")
    if math.isinf(value) and not _INFINITE.fullmatch(str(node.value)):
        raise node.error(f"the number {shown(str(node.value))} is too large")
    if finite and math.isinf(value):
        raise node.error(f"expected a finite number, found {node.value}")
    return value


def _number(value: str) -> float | None:
    if len(value) > _MAX_NUMBER:
        return None
    if _DECIMAL.fullmatch(value):
        return float(value)
    if _OCTAL.fullmatch(value):
        return float(int(value[2:], 8))
    if _HEXADECIMAL.fullmatch(value):
        return float(int(value[2:], 16))
    if infinite := _INFINITE.fullmatch(value):
        return -math.inf if infinite.group(1) == "-" else math.inf
    return math.nan if value in _NOT_A_NUMBER else None
