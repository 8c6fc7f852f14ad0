"""YAML text as a tree of texts, mappings and lists that know their line, column and path.

Read from the parser's events, so that hostile files (alias bombs, deep nesting, a million items) are refused while
they are read.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import yaml

from fuzzy.errors import FormatError, shown

MAX_LEVELS = 12
"""Greatest nesting of mappings and lists; the schema needs six."""

MAX_NODES = 50_000
"""Greatest number of keys and values in a file; the greatest valid system needs some 25,000."""

_MAX_KEY = 200
"""Greatest length of a key, which stands in the paths of errors."""

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_FORBIDDEN = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_NULL = frozenset({"", "~", "null", "Null", "NULL"})


@dataclass(slots=True)
class Node:
    """A value of the file: a text, a mapping of texts to nodes, or a list of nodes.

    Attributes:
        value: The content; the text of a scalar, before it is read as a number.
        source: Name of the file.
        path: Place in the document, such as ``inputs.e.terms.NB`` or ``rules.list[0]``.
        line: Line of the value, counted from 1.
        column: Column of the value, counted from 1.
        key_line: Line of the value's key, or of the value in a list.
        key_column: Column of the value's key, or of the value in a list.
        raw: The scalar as it is written, with its quotes.
        is_plain: Whether a scalar is written without quotes, so that it may be a number or ``~``.
    """

    value: str | dict[str, Node] | list[Node]
    source: str
    path: str
    line: int
    column: int
    key_line: int
    key_column: int
    raw: str = ""
    is_plain: bool = False

    @property
    def is_null(self) -> bool:
        """Whether the value is ``~``, ``null`` or missing."""
        return self.is_plain and self.value in _NULL

    def error(self, message: str) -> FormatError:
        """Return an error at the value."""
        return FormatError(message, self.source, self.line, self.column, self.path)

    def key_error(self, message: str) -> FormatError:
        """Return an error at the value's key."""
        return FormatError(message, self.source, self.key_line, self.key_column, self.path)

    def error_inside(self, message: str, offset: int) -> FormatError:
        """Return an error at one character of a text, counted from 0; at its start where it spans lines."""
        shift = _raw_offset(self.raw, offset)
        return FormatError(message, self.source, self.line, self.column + shift, self.path)


def parse(text: str, source: str) -> Node:
    """Read YAML.

    Raises:
        FormatError: If the text is not YAML, is empty, or uses what the schema has no use for: anchors, aliases,
            tags, several documents, duplicate keys, deep nesting.
    """
    forbidden = _FORBIDDEN.search(text)
    if forbidden is not None:
        before = text[: forbidden.start()]
        line, column = before.count("\n") + 1, forbidden.start() - before.rfind("\n")
        raise FormatError(f"the character {forbidden.group()!r} is not allowed in text", source, line, column)
    try:
        root = _Builder(text, source).build()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column, index = (mark.line + 1, mark.column + 1, mark.index) if mark else (1, 1, 0)
        hint = " (YAML is indented by blanks, never by tabs)" if text[index : index + 1] == "\t" else ""
        message = " ".join(part for part in (error.context, error.problem) if part)
        raise FormatError(f"this is not YAML: {message}{hint}", source, line, column) from None
    except yaml.YAMLError as error:
        raise FormatError(f"this is not YAML: {str(error).splitlines()[0]}", source, 1, 1) from None
    if root is None or root.is_null:
        raise FormatError("the file is empty: expected 'schema: fuzzy-workbench/1' in its first line", source, 1, 1)
    return root


def positions(root: Node) -> dict[str, tuple[int, int]]:
    """Return the line and column of every path: of its key, or of an item of a list."""
    found: dict[str, tuple[int, int]] = {}
    waiting = [root]
    while waiting:
        node = waiting.pop()
        found[node.path] = (node.key_line, node.key_column)
        if isinstance(node.value, dict):
            waiting.extend(node.value.values())
        elif isinstance(node.value, list):
            waiting.extend(node.value)
    return found


def describe(node: Node) -> str:
    """Return what a node is, in words."""
    match node.value:
        case dict():
            return "a mapping"
        case list():
            return "a list"
        case str(value):
            if node.is_plain and value == "":
                return "nothing"
            return f"'{shown(value)}'" if node.is_plain else f"the text '{shown(value)}'"


def _raw_offset(raw: str, offset: int) -> int:
    """Return where the character ``offset`` of a scalar's value stands in its written form."""
    if "\n" in raw or raw[:1] in {"|", ">"}:
        return 0
    if raw[:1] == "'":
        step: Callable[[int], int] = lambda at: 2 if raw[at : at + 2] == "''" else 1  # noqa: E731
    elif raw[:1] == '"':
        lengths = {"x": 4, "u": 6, "U": 10}
        step = lambda at: lengths.get(raw[at + 1], 2) if raw[at] == "\\" else 1  # noqa: E731
    else:
        return offset
    at = 1
    for _ in range(offset):
        if at >= len(raw) - 1:
            break
        at += step(at)
    return at


@dataclass(slots=True)
class _Open:
    """A mapping or list that is being read, and the key whose value comes next."""

    node: Node
    key: Node | None = None


class _Builder:
    """Builds the tree from the parser's events with a stack of its own: depth costs no recursion."""

    def __init__(self, text: str, source: str) -> None:
        self.text = text
        self.source = source
        self.stack: list[_Open] = []
        self.root: Node | None = None
        self.count = 0

    def build(self) -> Node | None:
        """Return the root, or None for a file without a document."""
        for event in yaml.parse(self.text, Loader=_LOADER):
            match event:
                case yaml.AliasEvent():
                    raise self._error(event, "aliases (*name) are not used in this schema: write the value out")
                case yaml.NodeEvent():
                    self._check(event)
                    self._add(event)
                case yaml.CollectionEndEvent():
                    self.stack.pop()
                case yaml.DocumentStartEvent() if self.root is not None:
                    raise self._error(event, "a second document begins here: a file holds one")
                case _:
                    pass
        return self.root

    def _error(self, event: Any, message: str) -> FormatError:
        path = self.stack[-1].node.path if self.stack else ""
        return FormatError(message, self.source, event.start_mark.line + 1, event.start_mark.column + 1, path)

    def _check(self, event: Any) -> None:
        self.count += 1
        if self.count > MAX_NODES:
            raise self._error(event, f"more than {MAX_NODES} values")
        if event.anchor is not None:
            raise self._error(event, "anchors (&name) are not used in this schema: write the value out")
        if event.tag is not None:
            raise self._error(event, f"tags are not used in this schema, found {shown(event.tag)}")
        if len(self.stack) >= MAX_LEVELS and not isinstance(event, yaml.ScalarEvent):
            raise self._error(event, f"nested more than {MAX_LEVELS} deep")

    def _add(self, event: Any) -> None:
        """Put the value that ``event`` begins into the open mapping or list."""
        parent = self.stack[-1] if self.stack else None
        node = self._node(event)
        if parent is None:
            self.root = node
        elif isinstance(parent.node.value, list):
            node.path = f"{parent.node.path}[{len(parent.node.value)}]"
            parent.node.value.append(node)
        elif parent.key is None:
            parent.key = self._key(parent.node, node)
            return
        else:
            key = parent.key
            node.path, node.key_line, node.key_column = key.path, key.line, key.column
            assert isinstance(parent.node.value, dict)
            parent.node.value[str(key.value)] = node
            parent.key = None
        if not isinstance(event, yaml.ScalarEvent):
            self.stack.append(_Open(node))

    def _node(self, event: Any) -> Node:
        start, end = event.start_mark, event.end_mark
        line, column = start.line + 1, start.column + 1
        match event:
            case yaml.ScalarEvent():
                raw = self.text[start.index : end.index]
                return Node(event.value, self.source, "", line, column, line, column, raw, not event.style)
            case yaml.MappingStartEvent():
                return Node({}, self.source, "", line, column, line, column)
            case _:
                return Node([], self.source, "", line, column, line, column)

    def _key(self, mapping: Node, key: Node) -> Node:
        if not isinstance(key.value, str):
            raise key.error(f"a key is a text, found {describe(key)}")
        if len(key.value) > _MAX_KEY:
            raise key.error(f"a key of {len(key.value)} characters: at most {_MAX_KEY}")
        key.path = f"{mapping.path}.{key.value}" if mapping.path else key.value
        assert isinstance(mapping.value, dict)
        if key.value in mapping.value:
            first = mapping.value[key.value].key_line
            raise key.error(f"the key '{shown(key.value)}' stands twice, first in line {first}")
        return key
