"""What every controller keeps to, whatever its rules: policies, refusals, and one result however it is asked for."""

from __future__ import annotations

import math
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from fuzzy.errors import InvalidInputError
from fuzzy.formats import load
from fuzzy.inference import Controller, compile_system
from fuzzy.kernels.inference import evaluate
from fuzzy.shapes import Triangle
from fuzzy.system import FuzzySystem, Inference, Input, Is, NoFire, OutOfRange, Output, Rule, RuleBase, Sampling, Term
from tests import generated, plain

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")

OPERATORS = [
    Inference(),
    Inference(implication="product"),
    Inference(conjunction="product", aggregation="sum"),
    Inference(conjunction="product", implication="product", aggregation="sum"),
    Inference(resolution=Sampling(101, "endpoints")),
]


def narrow(policy: NoFire, *, low: float = -4.0, high: float = 8.0, out_of_range: OutOfRange = "clamp") -> FuzzySystem:
    """Return a system that fires for 2 < x < 4 only, with an output of x = 3 at its centre."""
    x = Input("x", 0.0, 10.0, (Term("mid", Triangle(2.0, 3.0, 4.0)),), out_of_range=out_of_range)
    y = Output("y", low, high, (Term("top", Triangle(low, (low + high) / 2, high)),), no_fire=policy)
    return FuzzySystem("narrow", (x,), (y,), RuleBase(None, (Rule(Is("x", "mid"), (Is("y", "top"),)),)))


def value(controller: Controller, *inputs: float) -> float:
    """Return the output of a controller that has one."""
    found = controller(*inputs)
    assert isinstance(found, float)
    return found


@pytest.mark.parametrize(
    ("policy", "silent"),
    [(NoFire("default", 1.5), 1.5), (NoFire("midpoint"), 2.0), (NoFire("hold"), 2.0), (NoFire("nan"), math.nan)],
)
def test_no_fire_policy(policy, silent):
    controller = compile_system(narrow(policy))
    assert controller(9.0) == pytest.approx(silent, nan_ok=True)
    assert controller(3.0) == pytest.approx(2.0)
    after = 2.0 if policy.policy == "hold" else silent
    assert controller(1.0) == pytest.approx(after, nan_ok=True)
    controller.reset()
    assert controller(1.0) == pytest.approx(silent, nan_ok=True)
    assert not controller.explain(1.0).outputs["y"].fired
    assert controller.batch([[9.0], [3.0], [1.0]])[:, 0] == pytest.approx([silent, 2.0, silent], nan_ok=True)


def test_a_refused_call_leaves_the_held_output():
    controller = compile_system(replace(DIAGONAL, outputs=(replace(DIAGONAL.outputs[0], no_fire=NoFire("hold")),)))
    table = controller.system.rules.table
    assert table is not None
    empty = replace(controller.system, rules=RuleBase(replace(table, cells=((None,) * 7,) * 6 + table.cells[6:])))
    holding = compile_system(empty)
    held = value(holding, 1.0, 6.0)
    assert held > 70
    for _ in range(2):
        with pytest.raises(InvalidInputError):
            holding(math.nan, 0.0)
        assert holding(-1.0, 0.0) == held


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", [0, 1])
def test_inputs_that_are_not_finite_are_refused(bad, place):
    controller = compile_system(DIAGONAL)
    inputs = [0.1, 0.1]
    inputs[place] = bad
    for _ in range(2):  # the first call and those after it go different ways
        with pytest.raises(InvalidInputError, match=f"^{DIAGONAL.inputs[place].name}: .*not a finite number"):
            controller(*inputs)
        controller(0.1, 0.1)
    with pytest.raises(InvalidInputError, match="row 1"):
        controller.batch([[0.1, 0.1], inputs])
    with pytest.raises(InvalidInputError):
        controller.explain(*inputs)
    own = controller.directory()
    y = np.zeros(1)
    assert evaluate(own.address, np.array(inputs), y) == -1
    assert math.isnan(y[0])


@pytest.mark.parametrize("inputs", [(), (0.1,), (0.1, 0.2, 0.3), ("a", 0.1), (None, 0.1), ([0.1], 0.1), (0.1, 1j)])
def test_what_is_no_input_is_refused(inputs):
    controller: Any = compile_system(DIAGONAL)
    for _ in range(2):
        with pytest.raises(InvalidInputError, match="valid: "):
            controller(*inputs)
        controller(0.1, 0.1)


def test_any_kind_of_number_is_an_input():
    controller: Any = compile_system(DIAGONAL)
    wanted = controller(1.0, -1.0)
    for one, other in ((1, -1), (True, np.int8(-1)), (np.float32(1), np.float64(-1)), (np.array(1.0), -1)):
        assert controller(one, other) == wanted


def test_clamp_and_reject():
    clamping = compile_system(narrow(NoFire("nan")))
    assert clamping.explain(-1.0).clamped == ("x",)
    assert clamping.explain(0.0).clamped == ()
    rejecting = compile_system(narrow(NoFire("nan"), out_of_range="reject"))
    assert math.isnan(value(rejecting, 10.0))
    for refused in (-1e-9, 10.1):
        with pytest.raises(InvalidInputError, match=r"^x: .*valid: 0 to 10"):
            rejecting(refused)
        with pytest.raises(InvalidInputError, match="row 1"):
            rejecting.batch([[1.0], [refused]])
    two = compile_system(
        replace(DIAGONAL, inputs=(replace(DIAGONAL.inputs[0], out_of_range="reject"), DIAGONAL.inputs[1]))
    )
    for _ in range(2):
        assert two(1.0, 7.0) == two(1.0, 6.0)
        with pytest.raises(InvalidInputError, match=r"^e: "):
            two(1.1, 0.0)


@pytest.mark.parametrize("wrong", [[[1.0]], [1.0, 2.0], [[[1.0, 2.0]]], [["a", "b"]], [[1.0, 2.0], [1.0]]])
def test_batches_of_the_wrong_shape_are_refused(wrong):
    with pytest.raises(InvalidInputError):
        compile_system(DIAGONAL).batch(wrong)


def test_a_batch_may_be_empty():
    assert compile_system(DIAGONAL).batch(np.empty((0, 2))).shape == (0, 1)


@pytest.mark.parametrize("operators", OPERATORS)
def test_a_batch_is_its_calls_bit_for_bit(operators):
    controller = compile_system(replace(DIAGONAL, inference=operators))
    x = np.random.default_rng(1).uniform([-1.2, -7.0], [1.2, 7.0], (9001, 2))  # enough rows for two threads
    y = controller.batch(x)
    assert y.shape == (9001, 1)
    rows = [0, 1, 4499, 4500, 4501, 9000, *range(100, 200)]
    assert y[rows, 0].tolist() == [controller(*x[row]) for row in rows]
    assert y[rows, 0].tolist() == [controller.explain(*x[row]).outputs["T"].value for row in rows]


def test_an_inference_does_not_depend_on_the_one_before():
    random = np.random.default_rng(2)
    for system in generated.systems(100, 2):
        controller = compile_system(system)
        x = [generated.inputs_for(random, system) for _ in range(5)]
        alone = [[trace.value for trace in controller.explain(*row).outputs.values()] for row in x]
        np.testing.assert_array_equal(controller.batch(x), alone)
        np.testing.assert_array_equal([np.atleast_1d(controller(*row)) for row in x], alone)


def test_explain_shows_what_the_kernel_saw():
    random = np.random.default_rng(3)
    for system in [DIAGONAL, *generated.systems(60, 3)]:
        controller = compile_system(system)
        inputs = generated.inputs_for(random, system)
        trace = controller.explain(*inputs)
        for variable, x in zip(system.inputs, inputs, strict=True):
            inside = min(max(x, variable.low), variable.high)
            for term in variable.terms:
                assert trace.memberships[variable.name][term.name] == plain.degrees(term.shape, inside)
        assert [rule.strength for rule in trace.rules] == sorted(trace.strength[trace.strength > 0].tolist())[::-1]
        assert {rule.number for rule in trace.rules} == set(np.flatnonzero(trace.strength).tolist())
        for output in system.outputs:
            shown = trace.outputs[output.name]
            assert (shown.u[0], shown.u[-1]) == (output.low, output.high)
            fired = [rule for rule in trace.rules for c in rule.rule.consequents if c.variable == output.name]
            assert shown.fired == bool(fired)
            assert bool(shown.degree.any()) <= shown.fired


def test_the_explained_set_has_the_explained_output_as_its_centroid():
    trace = compile_system(DIAGONAL).explain(0.23, -1.7).outputs["T"]
    assert np.trapezoid(trace.u * trace.degree, trace.u) / np.trapezoid(trace.degree, trace.u) == pytest.approx(
        trace.value, abs=0.02
    )


@pytest.mark.parametrize("operators", OPERATORS)
@pytest.mark.parametrize("name", ["diagonal", "piltan"])
def test_an_antisymmetric_table_gives_an_odd_surface(name, operators):
    system = load(RULEBASES / f"{name}.yaml")
    table = system.rules.table
    assert table is not None
    mirrored = tuple(tuple(reversed(row)) for row in reversed(table.cells))
    terms = [term.name for term in system.outputs[0].terms]
    is_antisymmetric = all(
        terms.index(one) + terms.index(other) == len(terms) - 1
        for row, other_row in zip(table.cells, mirrored, strict=True)
        for one, other in zip(row, other_row, strict=True)
        if one is not None and other is not None
    )
    assert is_antisymmetric
    controller = compile_system(replace(system, inference=operators))
    x = np.random.default_rng(4).uniform(-1.1, 1.1, (2000, 2)) * [variable.high for variable in system.inputs]
    np.testing.assert_allclose(controller.batch(x), -controller.batch(-x), atol=1e-12 * 170)


def test_a_monotone_table_gives_a_monotone_surface():
    # Product implication and the sum of sets: the output is a mean of centroids, weighted by a partition.
    controller = compile_system(
        replace(DIAGONAL, inference=Inference(conjunction="product", implication="product", aggregation="sum"))
    )
    axis = np.linspace(-1.0, 1.0, 101)
    x = np.stack(np.meshgrid(axis, 6 * axis, indexing="ij"), axis=-1)
    surface = controller.batch(x.reshape(-1, 2)).reshape(101, 101)
    assert np.diff(surface, axis=0).min() > -1e-10
    assert np.diff(surface, axis=1).min() > -1e-10
    assert surface[0, 0] < -75 < 75 < surface[-1, -1]


@pytest.mark.parametrize("n_inputs", [2, 3])
def test_threads_may_share_a_controller(n_inputs):
    third = Input("z", -1.0, 1.0, (Term("on", Triangle(-math.inf, 0.0, 1.0)),))
    controller = compile_system(replace(DIAGONAL, inputs=(*DIAGONAL.inputs, third)[:n_inputs]))
    x = np.random.default_rng(5).uniform(-1, 1, (400, n_inputs))
    wanted = [controller(*row) for row in x]
    found: dict[int, list] = {}

    def work(number: int) -> None:
        found[number] = [controller(*row) for _ in range(20) for row in x]
        assert controller.batch(x)[:, 0].tolist() == wanted

    threads = [threading.Thread(target=work, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[number] for number in range(4)] == [wanted * 20] * 4


def test_equal_systems_share_their_compiled_variables_and_changed_ones_do_not():
    table = DIAGONAL.rules.table
    assert table is not None
    painted = replace(DIAGONAL, rules=RuleBase(replace(table, cells=(("LR",) * 7, *table.cells[1:]))))
    one, other = compile_system(DIAGONAL), compile_system(painted)
    assert one.tables.inputs is other.tables.inputs
    assert one.tables.outputs is other.tables.outputs
    assert value(one, -1.0, 0.0) < 0 < value(other, -1.0, 0.0)
    moved = replace(DIAGONAL, outputs=(replace(DIAGONAL.outputs[0], low=-90.0),))
    assert value(compile_system(moved), -1.0, -6.0) < value(one, -1.0, -6.0)


@pytest.mark.parametrize("aggregation", ["max", "sum"])
@pytest.mark.parametrize("implication", ["min", "product"])
@pytest.mark.parametrize("x", [(0.2, -1.0), (-0.9, 2.5), (0.01, 0.0), (1.0, 6.0)])
def test_center_of_sums_counts_every_rule_whatever_the_aggregation(x, implication, aggregation):
    operators = Inference(implication=implication, aggregation=aggregation, defuzzifier="center_of_sums")
    system = replace(DIAGONAL, inference=operators)
    controller = compile_system(system)
    output = system.outputs[0]
    shapes = {term.name: term.shape for term in output.terms}
    u = np.linspace(output.low, output.high, 1_700_001)
    area = moment = 0.0
    for fired in controller.explain(*x).rules:
        degree = plain.degrees(shapes[fired.rule.consequents[0].term], u)
        own = np.minimum(fired.strength, degree) if implication == "min" else fired.strength * degree
        area += float(np.trapezoid(own, u))
        moment += float(np.trapezoid(own * u, u))
    assert controller(*x) == pytest.approx(moment / area, abs=1e-9 * (output.high - output.low))
    sampled = replace(system, inference=replace(operators, resolution=Sampling(100_000)))
    assert compile_system(sampled)(*x) == pytest.approx(controller(*x), abs=1e-6)
