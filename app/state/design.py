"""What is chosen and being written in the Design panel."""

from __future__ import annotations

import msgspec

from fuzzy import edits
from fuzzy.edits import Grid
from fuzzy.system import FuzzySystem


class Design(msgspec.Struct, frozen=True):
    """Selections of the Design panel besides variable, term and brush; what is being written is no edit yet.

    Attributes:
        grid: Which rules the table shows; None for a system with one input.
        marked: Cells that a chosen finding is about.
        rule: Number in the list of the rule that is chosen, from 0.
        rule_text: A rule that is being written; None is the chosen one's own text.
        page: Page of the list that is shown, from 0.
        gains: Kp and Kd from which the table can be filled; None is what reaches the ends of all ranges.
        term_name: A name that is being written; None is the chosen term's own.
        variable_name: Likewise of the variable.
        count: How many terms the variable shall have if it is spaced evenly; None is as many as it has.
        stretches: Whether terms are stretched along when the range changes.
        is_symmetric: Whether opposite terms follow when one is edited.
        probe: Inputs whose inference is explained; None is the moment that is shown.
    """

    grid: Grid | None = None
    marked: tuple[tuple[int, int], ...] = ()
    rule: int | None = None
    rule_text: str | None = None
    page: int = 0
    gains: tuple[float, float] | None = None
    term_name: str | None = None
    variable_name: str | None = None
    count: int | None = None
    stretches: bool = False
    is_symmetric: bool = False
    probe: tuple[float, ...] | None = None


def fitting(design: Design, document: FuzzySystem) -> Design:
    """Return the selections without what the document does not have."""
    grid = edits.fitting_grid(document, design.grid)
    listed = len(document.rules.list)
    rule = design.rule if design.rule is not None and design.rule < listed else None
    probe = design.probe if design.probe is not None and len(design.probe) == len(document.inputs) else None
    fitted = msgspec.structs.replace(design, grid=grid, rule=rule, probe=probe)
    return design if fitted == design else fitted


def after_edit(design: Design) -> Design:
    """Return the selections after the document has changed: what was marked or written is done with."""
    return msgspec.structs.replace(without_drafts(design), marked=(), rule_text=None)


def without_drafts(design: Design) -> Design:
    """Return the selections without what is being written for the chosen term and variable."""
    return msgspec.structs.replace(design, term_name=None, variable_name=None, count=None)


def names_of(document: FuzzySystem) -> tuple[str, ...]:
    """Return the names of the inputs and outputs."""
    return tuple(variable.name for variable in (*document.inputs, *document.outputs))
