"""Errors of the robot package: each says what was found, in which field, and what is valid."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class RobotError(ValueError):
    """A parameter, a scenario or a controller that cannot be simulated.

    Attributes:
        message: What was found and what is valid, one sentence, without its place.
        path: Name of the field, such as ``mass[1]``; empty where there is none.
    """

    def __init__(self, message: str, path: str = "") -> None:
        super().__init__(f"{path}: {message}" if path else message)
        self.message = message
        self.path = path


class InvalidArmError(RobotError):
    """Parameters that no arm can have."""


class NoEquilibriumError(RobotError):
    """An arm whose springs cannot hold it at rest."""


class InvalidScenarioError(RobotError):
    """A scenario that cannot be run."""


class InvalidControllerError(RobotError):
    """Gains that are not finite or do not fit the arm, or a controller that lacks a part."""


class UnknownNameError(RobotError):
    """A name of an arm, a scenario or a controller that does not exist."""

    def __init__(self, kind: str, found: object, valid: Iterable[str]) -> None:
        names = list(valid)
        close = difflib.get_close_matches(str(found), names, n=1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        super().__init__(f"no {kind} is called '{found}'; {hint}valid: {', '.join(names)}")
