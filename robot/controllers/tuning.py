"""The gains of a control law, by name, to be shown and multiplied."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, assert_never, get_args

import msgspec

from robot.controllers.adaptive import AdaptiveFuzzyFlc, AdaptiveFuzzyPid
from robot.controllers.feedback_linearization import Parallel, PdFlc, PidFlc
from robot.controllers.fuzzy import FuzzyFlc
from robot.controllers.fuzzy_pid import FuzzyPid, ScaledPid
from robot.controllers.gravity import PidGravity
from robot.controllers.pid import Pid
from robot.errors import UnknownNameError

Law = (
    Pid | PidGravity | PdFlc | PidFlc | Parallel | FuzzyFlc | FuzzyPid | AdaptiveFuzzyPid | AdaptiveFuzzyFlc | ScaledPid
)

Gain = Literal["kp", "kd", "ki", "gu", "ge", "gc", "gamma"]
"""A group of gains: proportional, derivative, integral, the blocks' output and two inputs, the rate of learning."""

GAINS: tuple[Gain, ...] = get_args(Gain)


def gains(law: Law) -> dict[Gain, tuple[float, ...]]:
    """Return the gains (2N,) that a law has, by group; integral gains that are all 0 are none.

    Units are those of the law's own attributes. Of two laws side by side, the PID's are given.
    """
    found: dict[Gain, tuple[float, ...]] = {}
    for part, names in _parts(law):
        for gain, name in names.items():
            found[gain] = tuple(getattr(part, name))
    return {gain: found[gain] for gain in GAINS if gain in found and (gain != "ki" or any(found[gain]))}


def scaled(law: Law, factors: Mapping[Gain, float]) -> Law:
    """Return a law with groups of gains multiplied; groups that it does not have are ignored.

    Raises:
        UnknownNameError: No such group.
        InvalidControllerError: A factor that leaves no valid law.
    """
    for gain in factors:
        if gain not in GAINS:
            raise UnknownNameError("gain", gain, GAINS)
    if all(factor == 1.0 for factor in factors.values()):
        return law
    match law:
        case Parallel():
            return msgspec.structs.replace(law, pid=_scaled(law.pid, factors))
        case FuzzyPid() | ScaledPid() | AdaptiveFuzzyPid():
            return _scaled(msgspec.structs.replace(law, pid=_scaled(law.pid, factors)), factors)
        case _:
            return _scaled(law, factors)


def _scaled(part: Any, factors: Mapping[Gain, float]) -> Any:
    changes = {
        name: tuple(factors.get(gain, 1.0) * value for value in getattr(part, name))
        for gain, name in _names(part).items()
    }
    return msgspec.structs.replace(part, **changes)


def _parts(law: Law) -> list[tuple[Any, dict[Gain, str]]]:
    match law:
        case Parallel() | FuzzyPid() | ScaledPid() | AdaptiveFuzzyPid():
            return [(part, _names(part)) for part in (law.pid, law)]
        case Pid() | PidGravity() | PdFlc() | PidFlc() | FuzzyFlc() | AdaptiveFuzzyFlc():
            return [(law, _names(law))]
        case _:
            assert_never(law)


def _names(part: Any) -> dict[Gain, str]:
    """Return the attributes of a law that hold gains; ``kv`` of a feedback linearization is its derivative gain."""
    fields = part.__struct_fields__
    names: dict[Gain, str] = {gain: gain for gain in GAINS if gain in fields}
    if "kv" in fields:
        names["kd"] = "kv"
    return names
