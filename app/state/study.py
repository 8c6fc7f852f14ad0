"""Long work off the loop, a study of robustness or a fit: what was ordered, how far it is, what was found."""

from __future__ import annotations

from typing import Literal, NamedTuple

import msgspec
from msgspec.structs import replace

from app.state.setup import Setup
from fuzzy.system import FuzzySystem
from robot.robustness import Spread

PLANTS = (50, 200, 1000)
"""How many arms can be chosen."""


Method = Literal["least squares", "least greatest error", "Gaussians of their own"]
"""How a Sugeno system is fitted to the present one."""


class Order(NamedTuple):
    """What was ordered; the number tells one from the next. With a method it is a fit, else a study of robustness."""

    number: int
    document: FuzzySystem
    setup: Setup
    plants: int
    method: Method | None = None


class Outcome(NamedTuple):
    """What was found: the session's control law beside PID, on the same arms."""

    order: Order
    law: Spread
    pid: Spread


class Fitted(NamedTuple):
    """A Sugeno system that does nearly what the ordered document does: errors in the output's unit."""

    order: Order
    document: FuzzySystem
    rms: float
    largest: float


class Study(msgspec.Struct, frozen=True, eq=False):
    """What is chosen, what is being computed, and what was found last.

    Attributes:
        plants: How many arms the next study takes.
        order: What is being computed; None if nothing is.
        done: Share of it that is done, 0 to 1.
        outcome: What the last study of robustness found.
        method: How the next fit is made.
        fitted: What was fitted last.
        ordered: Number of orders so far.
    """

    plants: int = PLANTS[1]
    order: Order | None = None
    done: float = 0.0
    outcome: Outcome | None = None
    method: Method = "least squares"
    fitted: Fitted | None = None
    ordered: int = 0


class StudyChosen(msgspec.Struct, frozen=True):
    """Take so many arms next time."""

    plants: int


class StudyOrdered(msgspec.Struct, frozen=True):
    """Begin a study of the present document and experiment; one that runs is given up."""


class FitChosen(msgspec.Struct, frozen=True):
    """Fit in this way next time."""

    method: Method


class FitOrdered(msgspec.Struct, frozen=True):
    """Begin to fit a Sugeno system to the present document; what runs is given up."""


class StudyCancelled(msgspec.Struct, frozen=True):
    """Give up what runs; what was found before stays."""


class StudyProgressed(msgspec.Struct, frozen=True):
    """So much of an order is done."""

    number: int
    done: float


class StudyFinished(msgspec.Struct, frozen=True, eq=False):
    """An order was carried out; ``outcome`` is None if it failed, which was said."""

    number: int
    outcome: Outcome | Fitted | None


StudyEvent = StudyChosen | StudyOrdered | FitChosen | FitOrdered | StudyCancelled | StudyProgressed | StudyFinished


def after(study: Study, event: StudyEvent, document: FuzzySystem, setup: Setup) -> Study:
    """Return the study after an event; what comes from an order that was given up changes nothing."""
    match event:
        case StudyChosen():
            return replace(study, plants=event.plants)
        case StudyOrdered():
            order = Order(study.ordered + 1, document, setup, study.plants)
            return replace(study, order=order, done=0.0, ordered=order.number)
        case FitChosen():
            return replace(study, method=event.method)
        case FitOrdered():
            order = Order(study.ordered + 1, document, setup, study.plants, study.method)
            return replace(study, order=order, done=0.0, ordered=order.number)
        case StudyCancelled():
            return replace(study, order=None, done=0.0)
        case StudyProgressed() | StudyFinished() if study.order is None or event.number != study.order.number:
            return study
        case StudyProgressed():
            return replace(study, done=event.done)
        case StudyFinished():
            done = replace(study, order=None, done=0.0)
            match event.outcome:
                case Outcome():
                    return replace(done, outcome=event.outcome)
                case Fitted():
                    return replace(done, fitted=event.outcome)
                case None:
                    return done
