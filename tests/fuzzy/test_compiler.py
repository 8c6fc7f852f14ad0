"""What a document becomes: tables that kernels can read by address."""

from __future__ import annotations

import numpy as np
import pytest

from fuzzy import compile_system, formats
from fuzzy.kernels.address import directory
from fuzzy.kernels.tables import Tables, new_workspace
from fuzzy.shapes import Triangle
from fuzzy.system import FuzzySystem, Input, NoFire, Output, RuleBase, RuleTable, Term


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
    for name, array in whole.tables._asdict().items():
        assert array.dtype == getattr(real.tables, name).dtype, name


def test_tables_are_read_only_and_a_wrong_type_is_never_read_by_address() -> None:
    tables = compile_system(formats.load("rulebases/diagonal.yaml")).tables
    assert not any(array.flags.writeable for array in tables)
    workspace = new_workspace(tables)
    broken: Tables = tables._replace(input_range=tables.input_range.astype(np.float32))
    with pytest.raises(ValueError, match="float32"):
        directory(broken, workspace)
    strided: Tables = tables._replace(cut=tables.cut[::2])
    with pytest.raises(ValueError, match="contiguous"):
        directory(strided, workspace)
