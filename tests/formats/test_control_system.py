"""The controller in a loop of python-control."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from fuzzy import compile_system, formats
from fuzzy.errors import FuzzyError
from fuzzy.export.control_system import to_control_system

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    control = pytest.importorskip("control")

SYSTEM = formats.load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")


def test_it_gives_the_controllers_outputs() -> None:
    block = to_control_system(SYSTEM, name="fuzzy")
    assert (block.input_labels, block.output_labels, block.nstates) == (["e", "de"], ["T"], 0)
    assert block(np.array([0.2, -1.0])) == pytest.approx(compile_system(SYSTEM)(0.2, -1.0))


def test_it_closes_a_loop_around_a_mass() -> None:
    """x'' = T / 10, driven to 0.5 by the rules alone: the error and its rate go in, the force comes out."""
    plant = control.NonlinearIOSystem(
        lambda _t, x, u, _p: np.array([x[1], 0.1 * u[0]]),
        lambda _t, x, _u, _p: np.array([x[0], -x[1]]),
        inputs=["T"],
        outputs=["x", "de"],
        states=2,
        name="plant",
    )
    error = control.summing_junction(inputs=["r", "-x"], output="e", name="error")
    fuzzy = to_control_system(SYSTEM, name="fuzzy")
    loop = control.interconnect([plant, fuzzy, error], inputs=["r"], outputs=["x", "T"], name="loop")
    times = np.linspace(0, 20, 401)
    found = control.input_output_response(loop, times, 0.5 * np.ones(times.size), [0.0, 0.0])
    position, force = found.outputs
    assert abs(position[-1] - 0.5) < 0.01
    assert position.max() < 0.75
    assert force[0] == pytest.approx(compile_system(SYSTEM)(0.5, 0.0))


def test_without_python_control_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(FuzzyError, match="pip install 'fuzzy-arm-workbench\\[control\\]'"):
        to_control_system(SYSTEM)
