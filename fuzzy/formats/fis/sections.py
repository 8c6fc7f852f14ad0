"""The lines of a .fis file: sections of ``Key=value`` with places, and the lines of rules."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import NamedTuple

from fuzzy.errors import FormatError, shown
from fuzzy.formats.source import Source
from fuzzy.limits import MAX_OUTPUT_TERMS, MAX_RULES, MAX_VARIABLES

_HEAD = re.compile(r"\[\s*([A-Za-z]+?)\s*(\d{0,6})\s*\]")
_ENTRY = re.compile(r"([A-Za-z_]\w*)\s*=\s*(.*)", re.ASCII)
_FISPRO = re.compile(r"^[ \t]*(?:(?:Ninputs|Noutputs|Nrules|Conjunction|MissingValues)[ \t]*=|\[Exceptions\])", re.M)
_MAX_ENTRIES = MAX_OUTPUT_TERMS + 32
_MAX_SECTIONS = 2 * MAX_VARIABLES + 8


class Line(NamedTuple):
    """A text of the file and where it begins."""

    text: str
    offset: int


@dataclass
class Section:
    """A section of the file.

    Attributes:
        name: Its word in lower case: ``system``, ``input``, ``output`` or ``rules``.
        label: Its name as it stands in the file, with its number.
        number: Its number; 0 without one.
        offset: Where it begins.
        entries: Values by key in lower case.
        keys: Where each key stands.
        rules: The lines of the rules.
    """

    name: str
    label: str
    number: int
    offset: int
    entries: dict[str, Line] = field(default_factory=dict)
    keys: dict[str, Line] = field(default_factory=dict)
    rules: list[Line] = field(default_factory=list)


def read_sections(source: Source) -> list[Section]:
    """Return the sections of a file in their order; lines that begin with % or # are comments.

    Raises:
        FormatError: At the first line that is none, or for another language with the same suffix.
    """
    fispro = _FISPRO.search(source.text)
    if fispro is not None:
        raise source.error(
            f"this is FisPro's .fis, another language with the same suffix ('{fispro.group().strip()}'); "
            "MATLAB's, Octave's and fuzzylite's can be read",
            fispro.start(),
        )
    sections: list[Section] = []
    for start, line in source.lines():
        text = line.strip()
        if not text or text[0] in "%#":
            continue
        offset = start + line.index(text)
        head = _HEAD.fullmatch(text)
        if head is not None:
            sections.append(_section(source, sections, head, offset))
        elif not sections:
            raise source.error(f"expected '[System]' first, found '{shown(text)}'", offset)
        elif sections[-1].name == "rules":
            sections[-1].rules.append(Line(text, offset))
            if len(sections[-1].rules) > MAX_RULES:
                raise source.error(f"more than {MAX_RULES} rules", offset)
        else:
            _add_entry(source, sections[-1], text, offset)
    if not sections:
        raise source.error("the file is empty; expected '[System]'", 0)
    return sections


def _section(source: Source, before: list[Section], head: re.Match[str], offset: int) -> Section:
    name, digits = head.group(1).lower(), head.group(2)
    is_numbered = name in ("input", "output")
    if name not in ("system", "rules", "input", "output") or is_numbered != bool(digits):
        raise source.error(
            f"unknown section '{shown(head.group())}'; valid: [System], [Input1] …, [Output1] …, [Rules]", offset
        )
    section = Section(name, head.group(), int(digits or 0), offset)
    if any((other.name, other.number) == (section.name, section.number) for other in before):
        raise source.error(f"the section {shown(section.label)} stands twice", offset)
    if len(before) >= _MAX_SECTIONS:
        raise source.error(f"more than {_MAX_SECTIONS} sections", offset)
    return section


def _add_entry(source: Source, section: Section, text: str, offset: int) -> None:
    entry = _ENTRY.fullmatch(text)
    if entry is None:
        raise source.error(f"expected 'Key=value', found '{shown(text)}'", offset)
    key = entry.group(1).lower()
    if key in section.entries:
        raise source.error(f"'{entry.group(1)}' stands twice in {section.label}", offset)
    if len(section.entries) >= _MAX_ENTRIES:
        raise source.error(f"more than {_MAX_ENTRIES} lines in {section.label}", offset)
    section.entries[key] = Line(entry.group(2), offset + entry.start(2))
    section.keys[key] = Line(entry.group(1), offset)


def quoted(source: Source, line: Line, what: str) -> str:
    """Return a text in single or double quotes, or as it stands without any."""
    text = line.text
    if len(text) >= 2 and text[0] in "'\"" and text[-1] == text[0]:
        return text[1:-1]
    if text[:1] in ("'", '"'):
        raise source.error(f"{what} does not end: expected {text[0]}", line.offset + len(text))
    return text


def missing(source: Source, section: Section, key: str) -> FormatError:
    """Return the error that a key is missing in a section."""
    return source.error(f"{section.label} has no '{key}='", section.offset)
