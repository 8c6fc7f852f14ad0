"""The picture of an inference shows what the controller computed."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec.structs import replace

import fuzzy
from app.views.inference.explain import output_curves, output_lines
from fuzzy.system import NoFire, RuleBase

_SYSTEM = fuzzy.load("rulebases/diagonal.yaml")


@pytest.mark.parametrize("aggregation", ["max", "sum"])
@pytest.mark.parametrize("inputs", [(0.2, -1.0), (1.0, 6.0), (0.0, 0.0), (-3.0, 9.0)])
def test_the_drawn_set_has_the_crisp_output_as_its_centroid(inputs: tuple[float, float], aggregation: str) -> None:
    system = replace(_SYSTEM, inference=replace(_SYSTEM.inference, aggregation=aggregation))
    trace = fuzzy.compile_system(system).explain(*inputs)
    u, *sets, degree, mark = output_curves(system, system.outputs[0], trace)
    assert len(sets) + 2 == len(output_lines(system.outputs[0]))
    assert (np.max(sets, axis=0) <= degree + 1e-9).all()
    assert (np.diff(u) > 0).all()
    assert 0.0 <= degree.min() <= degree.max() <= 1.0
    centroid = np.trapezoid(u * degree, u) / np.trapezoid(degree, u)
    assert centroid == pytest.approx(trace.outputs["T"].value, abs=0.2)
    assert u[mark > 0] == pytest.approx([trace.outputs["T"].value], abs=1e-3)


def test_an_undefined_output_has_no_mark() -> None:
    output = replace(_SYSTEM.outputs[0], no_fire=NoFire("nan"))
    system = replace(_SYSTEM, outputs=(output,), rules=RuleBase())
    u, *sets, degree, mark = output_curves(system, output, fuzzy.compile_system(system).explain(0.0, 0.0))
    assert not np.any(sets)
    assert len(u) == len(degree) == len(mark)
    assert not degree.any()
    assert not mark.any()
