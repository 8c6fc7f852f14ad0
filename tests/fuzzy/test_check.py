"""Findings: nothing on the shipped files, and each weakness where it is."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from msgspec.structs import replace

from fuzzy import edits
from fuzzy.check import check, gaps, locate
from fuzzy.formats import dumps, load, save
from fuzzy.language import parse_rule
from fuzzy.shapes import Gaussian, Trapezoid, Triangle
from fuzzy.system import FuzzySystem, Input, NoFire, RuleBase, Sampling, Term
from tests import plain, strategies

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PILTAN = load(RULEBASES / "piltan.yaml")


def _with_rules(*texts: str) -> FuzzySystem:
    rules = tuple(parse_rule(text, DIAGONAL) for text in texts)
    return replace(DIAGONAL, rules=RuleBase(DIAGONAL.rules.table, rules))


def _input(*shapes: Triangle | Trapezoid | Gaussian) -> Input:
    return Input("x", 0.0, 10.0, tuple(Term(f"t{number}", shape) for number, shape in enumerate(shapes)))


@pytest.mark.parametrize("system", [DIAGONAL, PILTAN], ids=lambda system: system.name)
def test_shipped_rule_bases_are_clean(system):
    assert check(system) == []


@pytest.mark.parametrize(
    ("system", "level", "path", "message"),
    [
        (edits.set_shape(DIAGONAL, "de", "Z", Triangle(-1, 0, 1)), None, "", ""),
        (
            edits.set_no_fire(DIAGONAL, "T", NoFire("default", 850)),
            "warning",
            "outputs.T.no_fire",
            "default 850 is outside the range [-85, 85]",
        ),
        (
            edits.set_shape(edits.set_shape(DIAGONAL, "de", "SL", Triangle(-4, -2, -1)), "de", "Z", Triangle(0, 0, 2)),
            "warning",
            "inputs.de.terms",
            "no term of 'de' is above 0 from -1 to 0",
        ),
        (
            edits.set_shape(DIAGONAL, "de", "FL", Triangle(-9, -8, -7)),
            "warning",
            "inputs.de.terms",
            "no term of 'de' is above 0 at -6",
        ),
        (
            edits.set_shape(DIAGONAL, "de", "FL", Triangle(-9, -8, -7)),
            "warning",
            "inputs.de.terms.FL",
            "'FL' is 0 in all of [-6, 6]: its rules never fire",
        ),
        (
            edits.set_cell(DIAGONAL, "NB", "SL", None),
            "warning",
            "rules.table.cells.NB",
            "no rule for 'e is NB' with 'de': SL",
        ),
        (
            edits.set_cell(DIAGONAL, "NS", "SL", "LR"),
            "hint",
            "rules.table.cells.NS[3]",
            "'T' falls from (NS, SL) LR to (NS, Z) SL, but rises with 'de' elsewhere",
        ),
        (
            edits.set_cell(DIAGONAL, "NS", "SL", "LR"),
            "hint",
            "rules.table.cells.Z[2]",
            "'T' falls from (NS, SL) LR to (Z, SL) SL, but rises with 'e' elsewhere",
        ),
        (
            edits.set_cell(DIAGONAL, "NS", "SL", "SL"),
            "hint",
            "rules.table.cells.PS[4]",
            "(NS, SL) SL and (PS, SR) MR are not opposite: the table is antisymmetric elsewhere",
        ),
        (
            edits.set_cell(DIAGONAL, "Z", "Z", "SR"),
            "hint",
            "rules.table.cells.Z[3]",
            "(Z, Z) SR is not the middle term: the table is antisymmetric elsewhere",
        ),
        (
            _with_rules("if de is FL and e is NB then T is LL with 0.5"),
            "warning",
            "rules.list[0]",
            "repeats a cell of the table: if de is FL and e is NB then T is LL",
        ),
        (
            _with_rules("if e is NB and de is FL then T is LR"),
            "warning",
            "rules.list[0]",
            "contradicts a cell of the table: if e is NB and de is FL then T is LL",
        ),
        (
            _with_rules("if e is NB or de is FL then T is LL", "if de is FL or e is NB then T is Z"),
            "warning",
            "rules.list[1]",
            "contradicts rules.list[0]: if de is FL or e is NB then T is LL",
        ),
        (
            _with_rules("if e is NB then T is LL with 0"),
            "hint",
            "rules.list[0]",
            "the weight is 0: this rule never fires",
        ),
        (
            edits.set_shape(DIAGONAL, "T", "Z", Gaussian(0, 9)),
            "hint",
            "outputs.T.terms",
            "'Z' of 'T' have no closed form: integrated by quadrature to 1e-9",
        ),
        (
            edits.add_term(DIAGONAL, "T", "X", Triangle(0, 1, 2)),
            "hint",
            "outputs.T.terms.X",
            "no rule concludes 'T is X'",
        ),
        (
            edits.add_term(DIAGONAL, "e", "X", Triangle(0, 0.1, 0.2)),
            "warning",
            "inputs.e.terms.X",
            "no rule tests 'e is X'",
        ),
        (
            replace(DIAGONAL, rules=RuleBase()),
            "warning",
            "rules",
            "there are no rules: every output stays at its value for when no rule fires",
        ),
        (replace(DIAGONAL, rules=RuleBase()), "warning", "inputs.e", "no rule tests 'e'"),
        (replace(DIAGONAL, rules=RuleBase()), "warning", "outputs.T", "no rule concludes 'T'"),
        (replace(DIAGONAL, name=""), "error", "name", "the system's name is empty"),
    ],
)
def test_each_weakness_is_found_where_it_is(system, level, path, message):
    findings = [(finding.level, finding.path, finding.message) for finding in check(system)]
    if level is None:
        assert findings == []
    else:
        assert (level, path, message) in findings


def test_one_slip_gives_no_flood():
    assert len(check(edits.set_cell(DIAGONAL, "NS", "SL", "LR"))) == 3
    assert len(check(edits.set_cell(DIAGONAL, "NB", "SL", None))) == 2
    assert len(check(edits.set_range(DIAGONAL, "e", -1, 2))) == 0


def test_a_table_that_is_neither_monotone_nor_antisymmetric_may_be_meant():
    system = edits.clear_table(DIAGONAL)
    for row in range(7):
        for column in range(7):
            system = edits.set_cell(
                system, row, column, ("LL", "LR", "Z", "SR", "ML")[(3 * row + 2 * column * row) % 5]
            )
    assert not [finding for finding in check(system) if finding.path.startswith("rules.table")]


def test_order_is_that_of_the_sets_and_not_of_the_list():
    turned = replace(DIAGONAL.outputs[0], terms=DIAGONAL.outputs[0].terms[::-1])
    assert check(replace(DIAGONAL, outputs=(turned,))) == []


def test_a_listed_rule_fills_the_cell_that_it_speaks_about():
    system = edits.set_cell(_with_rules("if e is NB and not (de is FR or de is MR) then T is LL"), "NB", "FL", None)
    assert not [finding for finding in check(system) if finding.path.startswith("rules.table.cells.NB")][1:]
    other = edits.set_cell(_with_rules("if e is PB then T is LL"), "NB", "FL", None)
    assert "no rule for 'e is NB' with 'de': FL" in [finding.message for finding in check(other)]


def test_quadrature_is_no_news_where_the_file_asks_for_samples():
    curved = edits.set_shape(DIAGONAL, "T", "Z", Gaussian(0, 9))
    assert check(edits.set_inference(curved, resolution=Sampling(101))) == []


@pytest.mark.parametrize(
    ("variable", "expected"),
    [
        (_input(Triangle(-math.inf, 0, 5), Triangle(0, 10, math.inf)), []),
        (_input(Triangle(-math.inf, 2, 5), Triangle(5, 8, math.inf)), [(5, 5)]),
        (_input(Triangle(-math.inf, 2, 4), Triangle(5, 8, math.inf)), [(4, 5)]),
        (_input(Triangle(0, 5, 10)), [(0, 0), (10, 10)]),
        (_input(Triangle(3, 3, 3)), [(0, 3), (3, 10)]),
        (_input(Trapezoid(2, 2, 4, 4), Trapezoid(4, 5, 12, 12)), [(0, 2)]),
        (_input(Triangle(20, 21, 22)), [(0, 10)]),
        (_input(Gaussian(5, 5)), []),
        (_input(Gaussian(1, 0.5)), [(5, 10)]),
    ],
)
def test_gaps(variable, expected):
    assert gaps(variable) == expected


@given(strategies.systems())
@settings(max_examples=40)
def test_gaps_are_where_all_degrees_are_zero(system):
    for variable in system.inputs:
        x = np.linspace(variable.low, variable.high, 301)
        degree = np.max([plain.degrees(term.shape, x) for term in variable.terms], axis=0)
        in_gap = np.zeros(x.shape, dtype=bool)
        inside_gap = np.zeros(x.shape, dtype=bool)
        for low, high in gaps(variable):
            in_gap |= (x >= low) & (x <= high)
            inside_gap |= (x > low) & (x < high)
        assert not np.any(inside_gap & (degree > 2e-14))  # the last bits of a triangle's foot
        assert np.all(in_gap | (degree > 0.0))


@given(strategies.systems(name=strategies.names))
@settings(max_examples=30)
def test_every_finding_has_a_place_in_the_file(tmp_path_factory, system):
    path = tmp_path_factory.getbasetemp() / "checked.yaml"
    save(system, path)
    lines = dumps(system).splitlines()
    for finding in locate(check(system), path):
        assert 1 <= finding.line <= len(lines)
        assert 1 <= finding.column <= len(lines[finding.line - 1]) + 1
        assert finding.message


def test_a_finding_is_located_at_its_key_or_cell(tmp_path):
    path = tmp_path / "slip.yaml"
    save(edits.set_cell(DIAGONAL, "NS", "SL", "LR"), path)
    lines = path.read_text(encoding="utf-8").splitlines()
    (finding,) = [found for found in locate(check(load(path)), path) if found.path == "rules.table.cells.NS[3]"]
    assert lines[finding.line - 1].startswith("      NS: [")
    assert lines[finding.line - 1][finding.column - 1 :].startswith("SL, Z")
    assert finding.cells == ((2, 2), (2, 3))
