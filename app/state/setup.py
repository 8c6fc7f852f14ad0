"""The experiment that a session has chosen: plain values, from which :mod:`app.experiment` makes what is simulated."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

Disturbance = Literal["none", "force_noise", "measurement_noise", "reference_noise", "pulse", "push"]


class Setup(msgspec.Struct, frozen=True):
    """Which arm, under which control law, has to do what. Names are those of :mod:`robot`; None is its own default."""

    arm: str = "soft"
    controller: str = "fuzzy_flc"
    scenario: str = "step"
    disturbance: Disturbance = "none"

    natural_frequency: float | None = None  # rad/s; None is what the scenario asks for
    damping_ratio: float = 1.0
    # Factors on the law's default gains; a law ignores those that it does not have.
    kp: float = 1.0
    kd: float = 1.0
    ki: float = 1.0
    gu: float = 1.0
    ge: float = 1.0
    gc: float = 1.0
    gamma: float = 1.0

    # The scenario's parameters; one ignores those that its motion does not have.
    duration: float | None = None  # s
    extension: float | None = None  # m
    bend: float | None = None  # rad
    frequency: float | None = None  # Hz
    radius: float | None = None  # m
    period: float | None = None  # s
    dwell: float | None = None  # s
    prefilter: float | None = None  # rad/s; 0 is none

    noise_share: float = 0.3
    noise_hold: float = 0.036  # s
    seed: int = 0
    pulse_coordinate: str = "theta3"
    pulse_value: float = 0.5  # N or N m
    push_sideways: float = 2.0  # N
    push_down: float = 0.0  # N
    event_start: float = 1.0  # s
    event_duration: float = 0.3  # s

    # How the plant differs from what the controller knows.
    mass: float = 1.0
    stiffness: float = 1.0
    damping: float = 1.0
    friction: float = 0.0  # N
    payload: float = 0.0  # kg

    least_force: float | None = None  # N; None is without limit
    greatest_force: float | None = None  # N
    valve_time: float = 0.0  # s


OF_THE_SCENARIO = ("duration", "extension", "bend", "frequency", "radius", "period", "dwell", "prefilter")
"""Fields that another scenario gives other defaults."""

OF_THE_LAW = ("damping_ratio", "kp", "kd", "ki", "gu", "ge", "gc", "gamma", "natural_frequency")
"""Fields that another control law gives other defaults."""

_BANDWIDTH = ("disturbance", "scenario")
"""Fields after whose change another bandwidth is asked for; one chosen by hand was chosen for what was before."""


def changed(setup: Setup, changes: dict[str, Any]) -> Setup:
    """Return the setup with changes, and with defaults in place of what was chosen for something else."""
    defaults: dict[str, Any] = {}
    if "scenario" in changes:
        defaults |= dict.fromkeys(OF_THE_SCENARIO)
    if "controller" in changes:
        defaults |= {name: getattr(Setup(), name) for name in OF_THE_LAW}
        defaults["natural_frequency"] = setup.natural_frequency
    if any(name in changes for name in _BANDWIDTH):
        defaults["natural_frequency"] = None
    return msgspec.structs.replace(setup, **(defaults | changes))
