"""What all readers do at the end: rules into a table, the parts into one valid system, errors at their place."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from fuzzy.errors import FormatError, InvalidSystemError
from fuzzy.formats.source import Source
from fuzzy.shapes import Shape, Trapezoid
from fuzzy.system import And, FuzzySystem, Input, Is, Output, Rule, RuleBase, RuleTable, Sampling, Term
from fuzzy.validation import validate

_RESOLUTION = re.compile(r"fuzzy-workbench/1 resolution: (?:(exact)|(\d{1,6}) ([a-z_]+))\b")


class Remark(NamedTuple):
    """What a reader left out or took otherwise than it is written; the file can be used all the same.

    Attributes:
        message: One sentence.
        line: Line, counted from 1.
        column: Column, counted from 1.
    """

    message: str
    line: int
    column: int


class Imported(NamedTuple):
    """A system that was read, what was noticed meanwhile, and where its parts stand.

    Attributes:
        system: The document, valid.
        remarks: What was left out or taken otherwise, in the order in which it was found.
        places: Line and column, counted from 1, of paths such as ``inputs.e.terms.NB``.
    """

    system: FuzzySystem
    remarks: tuple[Remark, ...] = ()
    places: Mapping[str, tuple[int, int]] = {}


class Notes:
    """Places in the document and where they stand in the file, and the remarks; filled while a file is read."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.places: dict[str, int] = {}
        self.remarks: list[Remark] = []

    def at(self, path: str, offset: int) -> None:
        """Remember where a path of the document, such as ``inputs.e.terms.NB``, stands."""
        self.places.setdefault(path, offset)

    def remark(self, message: str, offset: int) -> None:
        """Note what was left out or taken otherwise."""
        self.remarks.append(Remark(message, *self.source.place(offset)))

    def imported(self, system: FuzzySystem) -> Imported:
        """Return the system if it is valid.

        Raises:
            FormatError: At the place of what is not valid.
        """
        try:
            places = {path: self.source.place(offset) for path, offset in self.places.items()}
            return Imported(validate(system), tuple(self.remarks), places)
        except InvalidSystemError as error:
            path = error.path
            while path not in self.places and path:
                path = path[: max(path.rfind("."), path.rfind("["), 0)]
            line, column = self.source.place(self.places.get(path, 0))
            raise FormatError(error.message, self.source.name, line, column, error.path) from None


def resolution_mark(resolution: str | Sampling) -> str:
    """Return the words that keep a resolution in a comment of a format that has no word for it."""
    if isinstance(resolution, Sampling):
        return f"fuzzy-workbench/1 resolution: {resolution.points} {resolution.rule}"
    return f"fuzzy-workbench/1 resolution: {resolution}"


def marked_resolution(text: str, otherwise: Any) -> Any:
    """Return the resolution that a comment of the workbench keeps in a file, or ``otherwise``."""
    found = _RESOLUTION.search(text)
    if found is None:
        return otherwise
    rule: Any = found.group(3)
    return "exact" if found.group(1) else Sampling(int(found.group(2)), rule)


def rule_base(inputs: Sequence[Input], outputs: Sequence[Output], rules: Sequence[Rule]) -> RuleBase:
    """Return the rules as a table where it can say all of them and nothing else, otherwise as a list, in order."""
    table = _table(inputs, outputs, rules)
    return RuleBase(table) if table is not None else RuleBase(None, tuple(rules))


def _table(inputs: Sequence[Input], outputs: Sequence[Output], rules: Sequence[Rule]) -> RuleTable | None:
    if len(inputs) != 2 or len(outputs) != 1 or not rules:
        return None
    rows, columns = inputs
    cells: dict[tuple[str, str], str] = {}
    for rule in rules:
        match rule:
            case Rule(And((Is(first, row), Is(second, column))), (Is(_, term),), weight=1.0):
                if (first, second) == (columns.name, rows.name):
                    row, column = column, row
                elif (first, second) != (rows.name, columns.name):
                    return None
                if (row, column) in cells:
                    return None
                cells[row, column] = term
            case _:
                return None
    return RuleTable(
        rows.name,
        columns.name,
        outputs[0].name,
        tuple(tuple(cells.get((row.name, column.name)) for column in columns.terms) for row in rows.terms),
    )


def open_trapezoid(a: float, b: float, c: float, d: float) -> Shape:
    """Return a trapezoid whose inner points are finite: [-inf -inf c d] is open to the left from c on."""
    if b == -math.inf == a:
        b = c
    if c == math.inf == d:
        c = b
    return Trapezoid(a, b, c, d)


def with_complements(outputs: Iterable[Output], negated: Iterable[Is]) -> tuple[Output, ...]:
    """Return the outputs with a term "not X" for every negated conclusion "output is not X"."""
    wanted = {(entry.variable, entry.term) for entry in negated}
    return tuple(
        Output(
            output.name,
            output.low,
            output.high,
            (
                *output.terms,
                *(
                    Term(complement_name(term.name), term.shape, term.height, not term.complement)
                    for term in output.terms
                    if (output.name, term.name) in wanted
                ),
            ),
            output.unit,
            output.no_fire,
        )
        for output in outputs
    )


def complement_name(term: str) -> str:
    """Return the name of the term that stands for "not ``term``" in a conclusion."""
    return f"not {term}"


class Chosen:
    """One operator that several places of a file choose, and that all of them must choose alike."""

    def __init__(self, what: str, source: Source) -> None:
        self.what = what
        self.value: Any = None
        self._suggested: Any = None
        self._source = source
        self._where = ""

    def choose(self, value: Any, where: str, offset: int) -> None:
        """Take a value.

        Raises:
            FormatError: Another place has chosen another value: a system of the workbench has one set of operators.
        """
        if self.value is not None and self.value != value:
            raise self._source.error(
                f"the {self.what} of {where} is {_said(value)}, that of {self._where} is {_said(self.value)}: "
                "a system has one for all",
                offset,
            )
        if self.value is None:
            self.value, self._where = value, where

    def suggest(self, value: Any) -> None:
        """Take the value of a place that makes no use of it: it counts where no other place chooses."""
        if self._suggested is None:
            self._suggested = value

    def get(self, otherwise: Any) -> Any:
        """Return the value, or ``otherwise`` where no place has chosen or suggested one."""
        return next((value for value in (self.value, self._suggested) if value is not None), otherwise)


def _said(value: Any) -> str:
    return f"{value.points} points ({value.rule})" if isinstance(value, Sampling) else str(value)


def unique(names: Mapping[str, Any] | Iterable[str], name: str, what: str, source: Source, offset: int) -> None:
    """Refuse a name that is there already."""
    if name in names:
        raise source.error(f"{what} '{name}' stands twice", offset)
