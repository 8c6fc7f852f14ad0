"""XML as a tree of elements with places; no document type, so no entities, and no deep nesting.

Read with expat, event by event, so that hostile files are refused while they are read.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from fuzzy.errors import FormatError, expected, shown
from fuzzy.formats.source import number

MAX_ELEMENTS = 50_000
"""Greatest number of elements: a file of 1 MiB holds no more that say something."""

MAX_LEVELS = 16
"""Greatest nesting; the schema needs eight."""

_MAX_ATTRIBUTES = 32


@dataclass(slots=True)
class Element:
    """An element of the file.

    Attributes:
        tag: Its name without the namespace.
        source: Name of the file.
        line: Line of its first character, counted from 1.
        column: Column of its first character, counted from 1.
        attributes: Texts by name.
        children: The elements inside, in order.
        text: The characters inside, between the elements, without blanks at the ends.
    """

    tag: str
    source: str
    line: int
    column: int
    attributes: dict[str, str]
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def error(self, message: str, path: str = "") -> FormatError:
        """Return an error at the element."""
        return FormatError(message, self.source, self.line, self.column, path)

    def required(self, name: str) -> str:
        """Return an attribute that must be there."""
        if name not in self.attributes:
            raise self.error(f"<{self.tag}> has no attribute '{name}'")
        return self.attributes[name]

    def number(self, name: str, otherwise: float | None = None) -> float:
        """Return an attribute that is a number; without ``otherwise`` it must be there."""
        text = self.attributes.get(name)
        if text is None and otherwise is not None:
            return otherwise
        text = self.required(name).strip()
        value = number(text)
        if value is None or value != value:
            raise self.error(f"the attribute '{name}' of <{self.tag}> is '{shown(text)}', expected a number")
        return value

    def choice(self, name: str, valid: Iterable[str], otherwise: str) -> str:
        """Return an attribute in capitals that is one of the valid words."""
        valid = tuple(valid)
        text = self.attributes.get(name, otherwise).strip().upper()
        if text not in valid:
            found = shown(self.attributes.get(name, otherwise))
            raise self.error(f"the attribute '{name}' of <{self.tag}>: unknown word {expected(found, valid)}")
        return text

    def only(self, tag: str) -> Element:
        """Return the one child of a name."""
        found = [child for child in self.children if child.tag == tag]
        if len(found) != 1:
            raise self.error(f"<{self.tag}> has {len(found)} elements <{tag}>, expected one")
        return found[0]


class _Builder:
    """Collects the elements; ``stack`` holds the open ones."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.root: Element | None = None
        self.stack: list[Element] = []
        self.texts: list[list[str]] = []
        self.count = 0
        self.parser: Any = expat.ParserCreate("utf-8")  # whatever encoding the file declares
        self.parser.buffer_text = True
        self.parser.ordered_attributes = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._characters
        self.parser.StartDoctypeDeclHandler = self._refuse_doctype
        self.parser.EntityDeclHandler = self._refuse_doctype
        self.parser.ExternalEntityRefHandler = None

    def _error(self, message: str) -> FormatError:
        return FormatError(message, self.source, self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)

    def _refuse_doctype(self, *_: Any) -> None:
        raise self._error("a document type (<!DOCTYPE …>) with its entities is not read: leave it out")

    def _start(self, tag: str, flat: list[str]) -> None:
        self.count += 1
        if self.count > MAX_ELEMENTS:
            raise self._error(f"more than {MAX_ELEMENTS} elements")
        if len(self.stack) >= MAX_LEVELS:
            raise self._error(f"elements are nested more than {MAX_LEVELS} deep")
        if len(flat) > 2 * _MAX_ATTRIBUTES:
            raise self._error(f"more than {_MAX_ATTRIBUTES} attributes")
        attributes = {_local(name): value for name, value in zip(flat[::2], flat[1::2], strict=True)}
        line, column = self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1
        element = Element(_local(tag), self.source, line, column, attributes)
        if self.stack:
            self.stack[-1].children.append(element)
        else:
            self.root = element
        self.stack.append(element)
        self.texts.append([])

    def _end(self, _: str) -> None:
        self.stack.pop().text = " ".join("".join(self.texts.pop()).split())

    def _characters(self, text: str) -> None:
        self.texts[-1].append(text)


def _local(name: str) -> str:
    return name.rpartition(":")[2]


def parse(text: str, source: str) -> Element:
    """Read XML.

    Raises:
        FormatError: If the text is no XML, has a document type, or is nested too deep.
    """
    builder = _Builder(source)
    try:
        builder.parser.Parse(text.encode("utf-8", "surrogatepass"), True)
    except expat.ExpatError as error:
        raise FormatError(
            f"this is not XML: {expat.ErrorString(error.code)}", source, error.lineno, error.offset + 1
        ) from None
    assert builder.root is not None, "expat refuses a text without elements"
    return builder.root
