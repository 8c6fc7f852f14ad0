"""What the parts of the Membership panel have in common: the chosen variable, and edits of its terms."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from app.state import AppState, DragMode, Edit
from fuzzy import edits, sets
from fuzzy.shapes import Trapezoid, Triangle
from fuzzy.system import FuzzySystem, Term, Variable


def chosen(state: AppState) -> Variable:
    """Return the variable whose terms are edited."""
    variables: tuple[Variable, ...] = (*state.document.inputs, *state.document.outputs)
    return next(variable for variable in variables if variable.name == state.variable)


def chosen_term(state: AppState) -> Term:
    """Return the term that is edited."""
    return next(term for term in chosen(state).terms if term.name == state.term)


def possible_mode(variable: Variable, wanted: DragMode) -> DragMode:
    """Return how points move: only triangles and trapezoids have feet that can follow in a partition."""
    is_linear = all(isinstance(term.shape, Triangle | Trapezoid) for term in variable.terms)
    return wanted if is_linear else "free"


def extent(variable: Variable) -> tuple[float, float]:
    """Return the part of the axis that is drawn: the range, and points of terms that lie outside."""
    points = [point for term in variable.terms for point in sets.break_points(term)]
    return float(min(variable.low, *points)), float(max(variable.high, *points))


def digits(variable: Variable) -> int:
    """Return how many decimals a number field shows for a variable: at least 3, and a thousandth of the range."""
    return min(max(3, 3 - math.floor(math.log10(variable.high - variable.low))), 12)


def is_shown_as(value: float, present: float, decimals: int) -> bool:
    """Whether a number field that shows ``present`` in its few digits sent no more than these back."""
    return abs(value - present) < 0.51 * 10**-decimals and round(present, decimals) == round(value, decimals)


def edit_of_term(
    state: AppState, label: str, change: Callable[[FuzzySystem], FuzzySystem], term: str, gesture: str = ""
) -> Edit:
    """Return an edit of a term's set; while editing is symmetric, the opposite terms follow."""
    if not state.design.is_symmetric:
        return Edit(label, change, gesture, time.monotonic())
    variable = state.variable
    return Edit(
        f"{label}, and its mirror",
        lambda system: edits.follow_in_mirror(system, change(system), variable, term),
        gesture,
        time.monotonic(),
    )
