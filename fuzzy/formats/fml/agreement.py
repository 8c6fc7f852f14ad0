"""What is remembered while an FML file is read: the operators on which its parts must agree, places and remarks."""

from __future__ import annotations

from typing import Any

from fuzzy.errors import InvalidSystemError
from fuzzy.formats.assembly import Imported, Remark
from fuzzy.formats.fml.tree import Element
from fuzzy.system import FuzzySystem, Is
from fuzzy.validation import validate

_OPERATORS = ("defuzzifier", "accumulation", "activation method", "andMethod", "orMethod")


class Agreement:
    """Operators, places and remarks.

    Attributes:
        places: The element of each place in the document.
        negated: Conclusions "output is not term", which become terms of their own.
        suggested: Operators of rule bases that no rule uses; they count where no other place chooses.
    """

    def __init__(self) -> None:
        self.places: dict[str, Element] = {}
        self.negated: list[Is] = []
        self.suggested: dict[str, str] = {}
        self._remarks: list[Remark] = []
        self._chosen: dict[str, tuple[str, str]] = {}

    def agree(self, key: str, value: str, element: Element, where: str) -> None:
        """Take an operator.

        Raises:
            FormatError: Another place has chosen another value: a system of the workbench has one set of operators.
        """
        assert key in _OPERATORS
        other, there = self._chosen.get(key, (value, where))
        if other != value:
            raise element.error(
                f"the {key} of {where} is {value}, that of {there} is {other}: a system has one for all"
            )
        self._chosen[key] = (value, there)

    def operator(self, key: str, otherwise: str) -> Any:
        """Return what was chosen, or else suggested."""
        return self._chosen[key][0] if key in self._chosen else self.suggested.get(key, otherwise)

    def remark(self, message: str, element: Element) -> None:
        """Keep what a reader of the file should know."""
        self._remarks.append(Remark(message, element.line, element.column))

    def imported(self, system: FuzzySystem, root: Element) -> Imported:
        """Return a system that is valid, or raise an error at the element that is not."""
        try:
            places = {path: (element.line, element.column) for path, element in self.places.items()}
            return Imported(validate(system), tuple(self._remarks), places)
        except InvalidSystemError as error:
            path = error.path
            while path not in self.places and path:
                path = path[: max(path.rfind("."), path.rfind("["), 0)]
            raise self.places.get(path, root).error(error.message, error.path) from None
