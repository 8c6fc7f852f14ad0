"""What a document becomes: tables that kernels can read by address."""

from __future__ import annotations

import numpy as np
import pytest

from fuzzy import compile_system, formats
from fuzzy.kernels.address import entries
from fuzzy.shapes import Triangle
from fuzzy.system import FuzzySystem, Input, Is, NoFire, Output, Rule, RuleBase, RuleTable, Term


def one_by_one(number: type) -> FuzzySystem:
    """Return a system with all its numbers as ``number``."""
    terms = (
        Term("N", Triangle(number(-2), number(-1), number(1))),
        Term("P", Triangle(number(-1), number(1), number(2))),
    )
    return FuzzySystem(
        name="ends",
        inputs=tuple(Input(name, number(-1), number(1), terms) for name in ("e", "de")),
        outputs=(Output("T", number(-1), number(1), terms, no_fire=NoFire("default", number(0))),),
        rules=RuleBase(RuleTable("e", "de", "T", (("N", "N"), ("N", "P")))),
    )


def test_whole_numbers_in_a_document_are_numbers() -> None:
    whole, real = (compile_system(one_by_one(number)) for number in (int, float))
    for e in (-1, 0.3, 1):
        assert whole(e, 0.5) == real(e, 0.5)
    for one, other in zip(whole.tables[:3], real.tables[:3], strict=True):
        for name, array in one._asdict().items():
            np.testing.assert_array_equal(array, getattr(other, name), strict=True, err_msg=name)


def test_tables_are_read_only_and_a_wrong_type_is_never_read_by_address() -> None:
    tables = compile_system(formats.load("rulebases/diagonal.yaml")).tables
    arrays = [*tables.inputs, *tables.rules, *tables.outputs, tables.entries]
    assert not any(array.flags.writeable for array in arrays)
    with pytest.raises(ValueError, match="float32"):
        entries([*tables.inputs, tables.inputs.range.astype(np.float32)])
    with pytest.raises(ValueError, match="contiguous"):
        entries([tables.outputs.cut[:, ::2]])


def test_an_output_that_holds_starts_inside_its_range_and_keeps_what_it_was() -> None:
    terms = (Term("low", Triangle(10.0, 11.0, 12.0)), Term("high", Triangle(12.0, 13.0, 14.0)))
    inputs = (Input("x", 0.0, 10.0, (Term("left", Triangle(0.0, 1.0, 2.0)), Term("right", Triangle(8.0, 9.0, 10.0)))),)
    rules = RuleBase(
        list=tuple(Rule(Is("x", side), (Is("y", level),)) for side, level in (("left", "low"), ("right", "high")))
    )
    output = Output("y", 10.0, 14.0, terms, no_fire=NoFire("hold"))
    controller = compile_system(FuzzySystem("holds", inputs, (output,), rules))
    assert controller(5.0) == 12.0
    assert controller(1.0) == pytest.approx(11.0)
    assert controller(5.0) == controller(1.0)
    controller.reset()
    assert controller(5.0) == 12.0
    assert controller.batch([[1.0], [5.0]])[1, 0] == 12.0
