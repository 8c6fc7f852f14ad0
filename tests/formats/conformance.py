"""The public conformance cases, where they lie beside the project: read in place, never copied."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

from fuzzy import formats, sets
from fuzzy.shapes import Triangle
from fuzzy.system import And, FuzzySystem, Inference, Input, Is, NoFire, Output, Rule, RuleBase, Sampling, Term

SUFFIXES = (".fis", ".fll", ".fcl", ".xml")


def folder() -> Path | None:
    """Return the folder of the cases, found by walking up from here."""
    for parent in Path(__file__).resolve().parents:
        for candidate in (parent / "conformance", parent / "shared" / "conformance"):
            if (candidate / "MANIFEST.json").is_file():
                return candidate
    return None


FOLDER = folder()
CASES = sorted(path.parent.name for path in FOLDER.glob("*/meta.json")) if FOLDER else []
FILES = (
    sorted(
        str(path.relative_to(FOLDER)) for name in CASES for path in (FOLDER / name).iterdir() if path.suffix in SUFFIXES
    )
    if FOLDER
    else []
)
"""All files of other engines, the variants in a case beside its own."""

needs_cases = pytest.mark.skipif(FOLDER is None, reason="the public conformance cases are not beside the project")


class Case(NamedTuple):
    """What is expected.

    Attributes:
        meta: How the table was computed.
        inputs: (n, n_in) crisp inputs.
        expected: (n, n_out) crisp outputs, NaN where undefined.
    """

    meta: dict[str, Any]
    inputs: NDArray[np.float64]
    expected: NDArray[np.float64]

    @property
    def tolerance(self) -> float:
        return float(self.meta["tolerance_abs"])


def read_case(name: str) -> Case:
    assert FOLDER is not None
    meta = json.loads((FOLDER / name / "meta.json").read_text(encoding="utf-8"))
    with (FOLDER / name / "expected.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    table = np.array(rows, dtype=np.float64)
    n_in = len(meta["inputs"])
    return Case(meta, table[:, :n_in], table[:, n_in:])


def read_system(name: str) -> FuzzySystem:
    """Return the system of a case in its own format."""
    assert FOLDER is not None
    (path,) = (FOLDER / name).glob("system.*")
    return _from_transcript(path) if path.suffix == ".yaml" else formats.load(path)


def _from_transcript(path: Path) -> FuzzySystem:
    """Return a scikit-fuzzy system that stands in a YAML of the cases' own."""
    document = yaml.safe_load(path.read_text(encoding="utf-8"))

    def terms(entry: dict[str, Any]) -> tuple[Term, ...]:
        return tuple(
            Term(term["name"], Triangle(*(float(value) for value in term["params"]))) for term in entry["terms"]
        )

    inputs = tuple(
        Input(entry["name"], float(entry["range"][0]), float(entry["range"][1]), terms(entry))
        for entry in document["inputs"]
    )
    outputs = tuple(
        Output(entry["name"], float(entry["range"][0]), float(entry["range"][1]), terms(entry), no_fire=NoFire("nan"))
        for entry in document["outputs"]
    )
    rules = tuple(
        Rule(
            And(tuple(Is(entry.name, rule[entry.name]) for entry in inputs)),
            tuple(Is(entry.name, rule[entry.name]) for entry in outputs),
        )
        for rule in document["rules"]
    )
    (output,) = outputs
    resolution = Sampling(_points_of_universe(document, output), "polygon")
    return FuzzySystem(path.parent.name, inputs, outputs, RuleBase(None, rules), Inference(resolution=resolution))


def _points_of_universe(document: dict[str, Any], output: Output) -> int:
    """Return the number of points at which the sets are known: those that are stated, or all that sets bend at."""
    stated = re.match(r"numpy\.arange\((\S+), (\S+), (\S+)\)", document.get("universe", ""))
    if stated:
        universe = np.arange(*(float(value) for value in stated.groups()))
    else:
        bends = {point for term in output.terms for point in sets.break_points(term)}
        universe = np.array(sorted(point for point in bends if output.low <= point <= output.high))
    np.testing.assert_allclose(universe, np.linspace(output.low, output.high, universe.size), atol=1e-12)
    return universe.size
