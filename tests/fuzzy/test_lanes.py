"""Inferences side by side are single inferences: to the last bit, whatever the policies and however odd a row is."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec.structs import replace

from fuzzy.inference import compile_system
from fuzzy.kernels import codes, inference, lanes
from fuzzy.system import And, FuzzySystem, Is, NoFire, Rule, RuleBase
from tests import generated

ROWS = 2 * lanes.LANES + 5


def conjunctive(random: np.random.Generator, system: FuzzySystem) -> FuzzySystem:
    """Return the system with other listed rules: each joins terms of some inputs by AND and concludes all outputs."""
    listed = []
    for _ in range(random.integers(0, 6)):
        chosen = [v for v in system.inputs if random.random() < 0.7] or system.inputs[:1]
        propositions = [Is(v.name, v.terms[random.integers(len(v.terms))].name) for v in chosen]
        antecedent = propositions[0] if len(propositions) == 1 else And(tuple(propositions))
        concluded = tuple(Is(v.name, v.terms[random.integers(len(v.terms))].name) for v in system.outputs)
        listed.append(Rule(antecedent, concluded, weight=float(random.choice([1.0, 0.3, 1e-170]))))
    return replace(system, rules=RuleBase(system.rules.table, tuple(listed)))


def evaluated(system: FuzzySystem, x: np.ndarray, before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the outputs of rows side by side and one after another, from the same last outputs."""
    own = compile_system(system).directory()
    shape = lanes.block_shape(own.workspace.membership.size, own.workspace.height.size)
    together, alone = before.copy(), before.copy()
    lanes.evaluate_rows(own.address, x, together, 0, len(x), np.full(shape, np.nan))
    for row, y in zip(x, alone, strict=True):
        inference.evaluate(own.address, row, y)
    return together, alone


@pytest.mark.parametrize("policy", ["nan", "hold", "default", "midpoint"])
def test_rows_side_by_side_are_single_inferences_bit_for_bit(policy):
    random = np.random.default_rng(5)
    suitable = 0
    for drawn in generated.systems(40, 6, ordered=True, implication="min", aggregation="max"):
        system = conjunctive(random, drawn)
        no_fire = NoFire(policy, 0.25 if policy == "default" else 0.0)
        outputs = tuple(replace(output, no_fire=no_fire) for output in system.outputs)
        system = replace(system, outputs=outputs)
        suitable += (compile_system(system).tables.outputs.method == codes.CLIPPED).all()
        x = np.array([generated.inputs_for(random, system) for _ in range(ROWS)])
        together, alone = evaluated(system, x, random.uniform(-1.0, 1.0, (ROWS, len(outputs))))
        np.testing.assert_array_equal(together, alone)
    assert suitable > 30


@pytest.mark.parametrize("operators", [{"disjunction": "max"}, {"aggregation": "sum"}, {"implication": "product"}])
def test_other_systems_are_evaluated_one_after_another(operators):
    random = np.random.default_rng(7)
    for system in generated.systems(15, 8, varied=True, **operators):
        x = np.array([generated.inputs_for(random, system) for _ in range(ROWS)])
        np.testing.assert_array_equal(*evaluated(system, x, np.zeros((ROWS, len(system.outputs)))))


def test_a_row_that_is_no_input_spoils_no_other():
    random = np.random.default_rng(9)
    for drawn in generated.systems(20, 10, ordered=True, implication="min", aggregation="max"):
        system = conjunctive(random, drawn)
        rejecting = (replace(system.inputs[0], out_of_range="reject"), *system.inputs[1:])
        system = replace(system, inputs=rejecting)
        x = np.array([generated.inputs_for(random, system) for _ in range(ROWS)])
        odd = random.random(ROWS) < 0.1
        x[odd, random.integers(len(system.inputs))] = random.choice([np.nan, np.inf, -np.inf], odd.sum())
        together, alone = evaluated(system, x, np.zeros((ROWS, len(system.outputs))))
        np.testing.assert_array_equal(together, alone)
        assert np.isnan(together[odd]).all()


def test_the_order_of_the_rules_changes_no_bit():
    random = np.random.default_rng(11)
    for drawn in generated.systems(40, 12, implication="min", aggregation="max"):
        system = conjunctive(random, drawn)
        shuffled = tuple(system.rules.list[n] for n in random.permutation(len(system.rules.list)))
        x = np.array([generated.inputs_for(random, system) for _ in range(50)])
        other = replace(system, rules=replace(system.rules, list=shuffled))
        np.testing.assert_array_equal(compile_system(system).batch(x), compile_system(other).batch(x))
