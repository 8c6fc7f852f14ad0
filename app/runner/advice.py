"""After a run: which rule to look at where the response overshoots, and what the next term would do, tried out."""

from __future__ import annotations

import math
from collections.abc import Callable

import fuzzy
from app import experiment
from app.state import Advice, Result, Setup
from fuzzy.analysis import culprits, stepped
from fuzzy.errors import FuzzyError
from fuzzy.inference import Controller
from fuzzy.rules import all_rules
from fuzzy.system import FuzzySystem
from robot import controllers
from robot.diagnosis import Overshoot, overshoots
from robot.errors import RobotError
from robot.metrics import Metrics
from robot.simulation import simulate

_STEPS = (1, 2, 3)
"""By how many terms a consequent is moved when it is tried out."""
_PRICE = 0.2
"""Overshoot that a further term must save, %."""
_HELPS = 0.9
"""Share of the overshoot below which a change counts as help."""
_EVERY = 4
"""One row of so many is looked at: the inputs hardly change from one control step to the next."""


def advise(setup: Setup, result: Result, is_stale: Callable[[], bool]) -> tuple[Advice, ...] | None:
    """Return advice for every coordinate that overshoots, the worst first; None if something newer came up.

    Args:
        setup: The experiment.
        result: Its run.
        is_stale: Whether the answer is not wanted any more.
    """
    controller = controllers.inference_of(result.run.controller)
    if controller is None or "adaptive" in setup.controller:
        return ()
    tried: dict[tuple[int, int], tuple[str, Metrics] | None] = {}
    advice = []
    for overshoot in overshoots(result.run):
        inputs = result.run.inputs[overshoot.first : overshoot.peak + 1 : _EVERY, overshoot.coordinate]
        suspects = culprits(controller, inputs, overshoot.direction)
        for number, _ in suspects:
            for steps in _STEPS:
                if is_stale():
                    return None
                key = (number, -steps * overshoot.direction)
                if key not in tried:
                    tried[key] = _tried(setup, controller.system, *key)
        advice.append(_best(controller, result, overshoot, suspects, tried))
    return tuple(advice)


def _tried(setup: Setup, document: FuzzySystem, number: int, steps: int) -> tuple[str, Metrics] | None:
    """Return the figures with another consequent of one rule; None where there is no other or it cannot be run."""
    other = stepped(document, number, steps)
    if other is None:
        return None
    try:
        run = simulate(*experiment.prepare(setup, fuzzy.compile_system(other[0])))
    except (FuzzyError, RobotError):
        return None
    return None if run.stopped is not None else (other[1], run.metrics())


def _best(
    controller: Controller,
    result: Result,
    overshoot: Overshoot,
    suspects: tuple[tuple[int, float], ...],
    tried: dict[tuple[int, int], tuple[str, Metrics] | None],
) -> Advice:
    """Return the advice that helps most, settling before all, few steps rather than many; the first suspect's if none.

    The coordinate must overshoot less than nine tenths of what it does.
    """
    name = result.run.arm.coordinates[overshoot.coordinate]
    times = (float(result.run.t[overshoot.first]), float(result.run.t[overshoot.peak]))
    advice = Advice(overshoot.coordinate, overshoot.percent, *times)
    numbered = all_rules(controller.system)
    if suspects:
        number, push = suspects[0]
        advice = advice._replace(rule=numbered[number], number=number, push=push)
    best = (2, 0.0)
    for number, push in suspects:
        for steps in _STEPS:
            found = tried[number, -steps * overshoot.direction]
            if found is None or found[1].overshoot[name] > _HELPS * overshoot.percent:
                continue
            after, settling = found[1].overshoot[name], found[1].settling_time["worst"]
            score = (int(not math.isfinite(settling)), after + _PRICE * steps)
            if score < best:
                best = score
                rule = numbered[number]
                advice = advice._replace(
                    rule=rule, number=number, push=push, term=found[0], after=after, settling=settling
                )
    return advice
