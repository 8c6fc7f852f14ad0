"""From the session's choices to what :mod:`robot` simulates."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import msgspec

import robot.scenario
from app.state import Disturbance, Setup
from fuzzy.inference import Controller
from robot import controllers
from robot.arm import Arm
from robot.controllers import ControlLaw
from robot.disturbance import BandLimitedNoise, Pulse, Push
from robot.scenario import Hold, Mismatch, Payload, Scenario, TipCircle


class Experiment(NamedTuple):
    """An arm, the law that controls it, and what is asked of both."""

    arm: Arm
    law: ControlLaw
    scenario: Scenario


NOISES = {"none": None, "force_noise": BandLimitedNoise()}
"""The noise that a command line may ask for, by name."""

_CHANNELS = {"force_noise": "force", "measurement_noise": "measurement", "reference_noise": "reference"}


def scenario_names() -> tuple[str, ...]:
    """Return the scenarios that are offered: those without a disturbance, which is a choice of its own."""
    return tuple(name for name in robot.scenario.names() if Scenario.preset(name).disturbance is None)


def disturbances(scenario: str) -> tuple[Disturbance, ...]:
    """Return the disturbances that can do something in a scenario.

    Noise on the forces is a share of the force that holds the target: in a scenario without one it is 0.
    """
    noises: tuple[Disturbance, ...] = ("force_noise", "measurement_noise", "reference_noise")
    if isinstance(Scenario.preset(scenario).reference, Hold | TipCircle):
        noises = noises[1:]
    return ("none", *noises, "pulse", "push")


def parameters(setup: Setup) -> dict[str, float]:
    """Return the scenario's own parameters as they are now, by the names of the setup's fields."""
    scenario = scenario_of(setup)
    known = {"duration": scenario.duration, "prefilter": scenario.prefilter or 0.0}
    return known | {name: getattr(scenario.reference, name) for name in _reference_fields(scenario)}


def prepare(setup: Setup, controller: Controller, law: str | None = None) -> Experiment:
    """Return the experiment of a setup.

    Args:
        setup: The session's choices.
        controller: The compiled document.
        law: Another control law than the setup's, with its own default gains, to compare with.

    Raises:
        RobotError: A name that is not known, or a value that cannot be used.
    """
    arm = Arm.preset(setup.arm)
    scenario = scenario_of(setup)
    if law is not None:
        return Experiment(arm, controllers.default(law, arm, scenario, controller), scenario)
    wanted = controllers.default(
        setup.controller,
        arm,
        scenario,
        controller,
        natural_frequency=setup.natural_frequency,
        damping_ratio=setup.damping_ratio,
    )
    factors: dict[controllers.Gain, float] = {gain: getattr(setup, gain) for gain in controllers.GAINS}
    return Experiment(arm, controllers.scaled(wanted, factors), scenario)


@functools.lru_cache(maxsize=4)  # the page asks for it many times
def scenario_of(setup: Setup) -> Scenario:
    """Return the scenario of a setup, with its disturbance, its mismatch and its limits.

    Raises:
        RobotError: A name that is not known, or a value that cannot be used.
    """
    preset = Scenario.preset(setup.scenario)
    changes: dict[str, Any] = {}
    if setup.duration is not None:
        changes["duration"] = setup.duration
    if setup.prefilter is not None:
        changes["prefilter"] = setup.prefilter or None
    wanted = {name: getattr(setup, name) for name in _reference_fields(preset)}
    chosen = {name: value for name, value in wanted.items() if value is not None}
    if chosen:
        changes["reference"] = msgspec.structs.replace(preset.reference, **chosen)
    if setup.payload > 0.0:
        changes["payload"] = Payload(setup.payload)
    if setup.least_force is not None or setup.greatest_force is not None:
        least = -_WITHOUT_LIMIT if setup.least_force is None else setup.least_force
        greatest = _WITHOUT_LIMIT if setup.greatest_force is None else setup.greatest_force
        changes["force_limits"] = (least, greatest)
    mismatch = Mismatch(setup.mass, setup.stiffness, setup.damping, setup.friction)
    changes |= {"mismatch": mismatch, "valve_time": setup.valve_time} | _disturbance(setup, preset)
    return msgspec.structs.replace(preset, **changes)


_WITHOUT_LIMIT = 1e6
"""N: more than any arm here is ever asked for."""


def _reference_fields(scenario: Scenario) -> tuple[str, ...]:
    """Return the parameters of a scenario's motion that a setup can change."""
    fields = scenario.reference.__struct_fields__
    return tuple(name for name in ("extension", "bend", "frequency", "radius", "period", "dwell") if name in fields)


def _disturbance(setup: Setup, preset: Scenario) -> dict[str, Any]:
    match setup.disturbance:
        case "none":
            return {}
        case "pulse":
            pulse = Pulse(setup.pulse_coordinate, setup.pulse_value, setup.event_start, setup.event_duration)
            return {"pulses": (*preset.pulses, pulse)}
        case "push":
            push = Push((setup.push_sideways, setup.push_down), setup.event_start, setup.event_duration)
            return {"pushes": (*preset.pushes, push)}
        case noise:
            channel: Any = _CHANNELS[noise]
            return {"disturbance": BandLimitedNoise(setup.noise_share, setup.noise_hold, setup.seed, channel)}


def natural_frequency(setup: Setup) -> float | None:
    """Return the natural frequency of the setup's control law, rad/s; None for one that has none."""
    if not controllers.has_natural_frequency(setup.controller):
        return None
    return setup.natural_frequency or controllers.default_natural_frequency(scenario_of(setup))
