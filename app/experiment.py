"""From the session's choices to what :mod:`robot` simulates."""

from __future__ import annotations

from typing import NamedTuple

import msgspec

import robot.scenario
from app.state import Setup
from fuzzy.inference import Controller
from robot import controllers
from robot.arm import Arm
from robot.controllers import ControlLaw
from robot.disturbance import BandLimitedNoise
from robot.scenario import Scenario


class Experiment(NamedTuple):
    """An arm, the law that controls it, and what is asked of both."""

    arm: Arm
    law: ControlLaw
    scenario: Scenario


DISTURBANCES = {"none": None, "force_noise": BandLimitedNoise()}
"""Disturbances by name."""


def scenario_names() -> tuple[str, ...]:
    """Return the scenarios that are offered: those without a disturbance, which is a choice of its own."""
    return tuple(name for name in robot.scenario.names() if Scenario.preset(name).disturbance is None)


def prepare(setup: Setup, controller: Controller, law: str | None = None) -> Experiment:
    """Return the experiment of a setup.

    Args:
        setup: The session's choices.
        controller: The compiled document.
        law: Another control law than the setup's, to compare with.

    Raises:
        RobotError: A name that is not known.
    """
    arm = Arm.preset(setup.arm)
    scenario = scenario_of(setup)
    name = law or setup.controller
    wanted = controllers.default(name, arm, scenario, controller, natural_frequency=setup.natural_frequency)
    return Experiment(arm, wanted, scenario)


def scenario_of(setup: Setup) -> Scenario:
    """Return the scenario of a setup, with its disturbance."""
    return msgspec.structs.replace(Scenario.preset(setup.scenario), disturbance=DISTURBANCES[setup.disturbance])


def natural_frequency(setup: Setup) -> float | None:
    """Return the natural frequency of the setup's control law, rad/s; None for one that has none."""
    if not controllers.has_natural_frequency(setup.controller):
        return None
    return setup.natural_frequency or controllers.default_natural_frequency(scenario_of(setup))
