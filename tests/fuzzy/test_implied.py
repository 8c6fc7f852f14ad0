"""A drawn implied set is what the kernels make of a single rule."""

from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from msgspec.structs import replace

import fuzzy
from fuzzy.formats import load
from fuzzy.language import parse_rule
from fuzzy.operators import implied
from fuzzy.system import Implication, RuleBase, Sampling

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")


@pytest.mark.parametrize("implication", get_args(Implication))
@pytest.mark.parametrize("error", [0.0, 0.1, 0.25, 0.3])
def test_it_is_the_aggregated_set_of_one_rule(implication, error):
    rule = parse_rule("if e is Z then T is MR", DIAGONAL)
    alone = replace(DIAGONAL, rules=RuleBase(None, (rule,)))
    system = replace(alone, inference=replace(alone.inference, implication=implication, resolution=Sampling(101)))
    trace = fuzzy.compile_system(system).explain(error, 0.0)
    output = trace.outputs["T"]
    drawn = implied(DIAGONAL.outputs[0].terms[5], implication, output.heights["MR"], output.u)
    assert drawn == pytest.approx(output.degree, abs=1e-12)


def test_a_silent_rule_implies_nothing():
    for implication in get_args(Implication):
        assert not implied(DIAGONAL.outputs[0].terms[5], implication, 0.0, np.linspace(-85, 85, 11)).any()
