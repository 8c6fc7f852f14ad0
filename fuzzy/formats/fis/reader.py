"""A .fis file to the document, which evaluates as the engine that the file is for.

MATLAB and Octave take 101 points with both ends and the middle of the range where no rule fires; fuzzylite, which
names itself in the first line of what it writes, takes 1000 midpoints and is undefined where no rule fires.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from fuzzy.errors import expected, shown
from fuzzy.formats.assembly import Imported, Notes, marked_resolution, rule_base, unique, with_complements
from fuzzy.formats.fis import words
from fuzzy.formats.fis.rules import read_rules
from fuzzy.formats.fis.sections import Line, Section, missing, quoted, read_sections
from fuzzy.formats.source import Source, number
from fuzzy.limits import MAX_OUTPUT_TERMS, MAX_VARIABLES
from fuzzy.shapes import MAX_POINTS, Linear, Points, Shape, Singleton
from fuzzy.system import WEIGHTED_VALUES, FuzzySystem, Inference, Input, NoFire, Output, Sampling, Term

_MEMBERSHIP = re.compile(r"(['\"])(?P<name>.*)\1\s*:\s*(['\"])(?P<kind>[^'\"]*)\3\s*,\s*\[(?P<numbers>[^\]]*)\]")
_WORD = re.compile(r"[^\s,;]+")
_FUZZYLITE = re.compile(r"\s*[#%].*fuzzylite", re.IGNORECASE)
_MF_KEY = re.compile(r"mf([1-9]\d{0,4})")
_SYSTEM_KEYS = frozenset(
    (
        *("name", "type", "version", "numinputs", "numoutputs", "numrules"),
        *("andmethod", "ormethod", "impmethod", "aggmethod", "defuzzmethod"),
    )
)
_VARIABLE_KEYS = frozenset(("name", "range", "nummfs", "enabled", "default", "lockprevious", "lockvalid", "lockrange"))


class Engine(NamedTuple):
    """What differs between the engines that write this suffix."""

    defuzzifiers: dict[str, str]
    hedges: dict[str, tuple[Any, ...]]
    sampling: Sampling
    no_fire: NoFire


_MATLAB = Engine(
    words.DEFUZZIFIERS | {"centroid_integral": "centroid"},
    words.OCTAVE_HEDGES,
    Sampling(101, "endpoints"),
    NoFire("midpoint"),
)
_FUZZYLITE_ENGINE = Engine(
    words.FUZZYLITE_DEFUZZIFIERS, words.FUZZYLITE_HEDGES, Sampling(1000, "midpoints"), NoFire("nan")
)


def read(text: str, name: str) -> Imported:
    """Read a file's text.

    Args:
        text: The .fis.
        name: Name of the file, for errors.

    Raises:
        FormatError: With line and column of the first mistake, what was found and what is valid.
    """
    source = Source(text, name)
    notes = Notes(source)
    sections = read_sections(source)
    engine = _FUZZYLITE_ENGINE if _FUZZYLITE.match(text) else _MATLAB
    system = sections[0]
    if system.name != "system":
        raise source.error(f"expected '[System]' first, found '{shown(system.label)}'", system.offset)
    _remark_unknown(notes, system, _SYSTEM_KEYS)
    kind = _kind(source, system)
    inference, has_sugeno = _inference(source, text, system, kind, engine)
    inputs = tuple(_input(notes, section) for section in _numbered(source, sections, "input"))
    outputs = tuple(
        _output(notes, section, len(inputs), engine, has_sugeno) for section in _numbered(source, sections, "output")
    )
    _check_unique(source, sections)
    found = next((section for section in sections if section.name == "rules"), None)
    if found is None:
        raise source.error("the section [Rules] is missing: the file ends too early", len(text))
    _check_count(source, system, "numrules", len(found.rules), "rules")
    rules, negated = read_rules(source, found.rules, inputs, outputs, engine.hedges)
    outputs = with_complements(outputs, negated)
    for index, line in enumerate(found.rules):
        notes.at(f"rules.list[{index}]", line.offset)
    title = quoted(source, system.entries["name"], "the name") if "name" in system.entries else ""
    return notes.imported(
        FuzzySystem(title.strip() or "fis", inputs, outputs, rule_base(inputs, outputs, rules), inference)
    )


def _remark_unknown(notes: Notes, section: Section, known: frozenset[str]) -> None:
    for key, line in section.keys.items():
        if re.match(r"(typereduction|mf\d+[ul]$|umf|lmf)", key):
            raise notes.source.error(
                f"'{shown(line.text)}' belongs to a type-2 system, which cannot be read", line.offset
            )
        if key not in known and not _MF_KEY.fullmatch(key):
            notes.remark(f"'{shown(line.text)}' in {section.label} is not known and left out", line.offset)


def _kind(source: Source, system: Section) -> str:
    if "type" not in system.entries:
        return "mamdani"
    line = system.entries["type"]
    kind = quoted(source, line, "the type").lower()
    valid = ("mamdani", "sugeno", "tsukamoto", "takagi-sugeno")
    if kind not in valid:
        raise source.error(f"unknown type {expected(shown(kind), valid)}", line.offset)
    return kind


def _operator(source: Source, system: Section, key: str, valid: dict[str, str], otherwise: str) -> str:
    line = system.entries.get(key)
    if line is None:
        return otherwise
    word = quoted(source, line, "the operator").lower()
    if word not in valid:
        raise source.error(f"{system.keys[key].text}: unknown operator {expected(shown(word), valid)}", line.offset)
    return valid[word]


def _inference(source: Source, text: str, system: Section, kind: str, engine: Engine) -> tuple[Inference, bool]:
    """Return the operators, and whether the outputs' terms are constants or linear functions."""
    has_sugeno = kind in ("sugeno", "takagi-sugeno")
    defuzzifier: Any = _operator(
        source, system, "defuzzmethod", engine.defuzzifiers, "weighted_average" if has_sugeno else "centroid"
    )
    is_weighted = defuzzifier in WEIGHTED_VALUES
    if is_weighted != (kind != "mamdani"):
        place = system.entries.get("defuzzmethod", system.entries.get("type"))
        assert place is not None, "the defaults go together"
        raise source.error(f"the defuzzifier {place.text} does not go with a {kind} system", place.offset)
    conjunction: Any = _operator(source, system, "andmethod", words.CONJUNCTIONS, "min")
    disjunction: Any = _operator(source, system, "ormethod", words.DISJUNCTIONS, "max")
    if is_weighted:
        # Every rule counts, also where several conclude the same term: their weights add up.
        resolution = marked_resolution(text, "exact")
        return Inference(conjunction, disjunction, "min", "sum", defuzzifier, resolution), has_sugeno
    implication: Any = _operator(source, system, "impmethod", words.IMPLICATIONS, "min")
    aggregation: Any = _operator(source, system, "aggmethod", words.AGGREGATIONS, "max")
    sampling = engine.sampling
    if "centroid_integral" in system.entries.get("defuzzmethod", Line("", 0)).text:
        sampling = Sampling(sampling.points, "trapezoid")
    resolution = marked_resolution(text, sampling)
    return Inference(conjunction, disjunction, implication, aggregation, defuzzifier, resolution), has_sugeno


def _numbered(source: Source, sections: list[Section], name: str) -> list[Section]:
    """Return the sections of all inputs or outputs in the order of their numbers, which must leave out none."""
    found = sorted((section for section in sections if section.name == name), key=lambda section: section.number)
    for place, section in enumerate(found, 1):
        if section.number != place:
            raise source.error(f"expected [{name.capitalize()}{place}], found {section.label}", section.offset)
    if len(found) > MAX_VARIABLES:
        raise source.error(f"{len(found)} {name}s: at most {MAX_VARIABLES}", found[MAX_VARIABLES].offset)
    _check_count(source, sections[0], f"num{name}s", len(found), f"{name} sections")
    if not found:
        raise source.error(f"the section [{name.capitalize()}1] is missing", len(source.text))
    return found


def _check_count(source: Source, section: Section, key: str, count: int, what: str) -> None:
    line = section.entries.get(key)
    if line is None:
        return
    stated = number(line.text)
    if stated != count:
        raise source.error(f"{section.keys[key].text}={shown(line.text)}, but the file has {count} {what}", line.offset)


def _check_unique(source: Source, sections: list[Section]) -> None:
    names: set[str] = set()
    for section in sections:
        if section.name in ("input", "output"):
            name = quoted(source, section.entries["name"], "the name").strip()
            unique(names, name, "a variable called", source, section.entries["name"].offset)
            names.add(name)


def _head(notes: Notes, section: Section, path: str) -> tuple[str, float, float]:
    """Return name and range of a variable."""
    source = notes.source
    _remark_unknown(notes, section, _VARIABLE_KEYS)
    for key in ("name", "range"):
        if key not in section.entries:
            raise missing(source, section, key.capitalize())
    name = quoted(source, section.entries["name"], "the name").strip()
    line = section.entries["range"]
    ends = _numbers(source, Line(line.text.strip("[]"), line.offset + line.text.startswith("[")))
    if len(ends) != 2 or not line.text.endswith("]"):
        raise source.error(f"expected a range such as [-1 1], found '{shown(line.text)}'", line.offset)
    if section.entries.get("enabled", Line("1", 0)).text.lower() in ("0", "false"):
        raise source.error(f"'{shown(name)}' is disabled, which has no word in the workbench", section.offset)
    notes.at(f"{path}.{name}", section.entries["name"].offset)
    notes.at(f"{path}.{name}.range", line.offset)
    return name, ends[0], ends[1]


def _numbers(source: Source, line: Line) -> list[float]:
    values: list[float] = []
    for match in _WORD.finditer(line.text):
        if len(values) > 2 * MAX_POINTS:
            raise source.error(f"more than {2 * MAX_POINTS} numbers", line.offset + match.start())
        value = number(match.group())
        if value is None or value != value:
            raise source.error(f"expected a number, found '{shown(match.group())}'", line.offset + match.start())
        values.append(value)
    return values


def _input(notes: Notes, section: Section) -> Input:
    name, low, high = _head(notes, section, "inputs")
    return Input(name, low, high, _terms(notes, section, f"inputs.{name}", 0, is_sugeno=False))


def _output(notes: Notes, section: Section, n_inputs: int, engine: Engine, is_sugeno: bool) -> Output:
    name, low, high = _head(notes, section, "outputs")
    terms = _terms(notes, section, f"outputs.{name}", n_inputs, is_sugeno=is_sugeno)
    no_fire = engine.no_fire
    if "default" in section.entries:
        line = section.entries["default"]
        value = number(line.text)
        if value is None:
            raise notes.source.error(f"expected a number, found '{shown(line.text)}'", line.offset)
        no_fire = NoFire("nan") if value != value else NoFire("default", value)
        notes.at(f"outputs.{name}.no_fire", line.offset)
    if section.entries.get("lockprevious", Line("0", 0)).text.lower() in ("1", "true"):
        no_fire = NoFire("hold")
    return Output(name, low, high, terms, no_fire=no_fire)


def _terms(notes: Notes, section: Section, path: str, n_inputs: int, *, is_sugeno: bool) -> tuple[Term, ...]:
    source = notes.source
    keys = [key for key in section.entries if _MF_KEY.fullmatch(key)]
    _check_count(source, section, "nummfs", len(keys), "membership functions in this section")
    terms: list[Term] = []
    if len(keys) > MAX_OUTPUT_TERMS:
        raise source.error(f"{len(keys)} membership functions: at most {MAX_OUTPUT_TERMS}", section.offset)
    for place in range(1, len(keys) + 1):
        if f"mf{place}" not in section.entries:
            raise missing(source, section, f"MF{place}")
        line = section.entries[f"mf{place}"]
        match = _MEMBERSHIP.fullmatch(line.text)
        if match is None:
            message = f"expected 'name':'type',[numbers], found '{shown(line.text)}'"
            raise source.error(message, line.offset)
        name = match.group("name").strip()
        unique(
            [term.name for term in terms], name, f"a membership function of {section.label} called", source, line.offset
        )
        notes.at(f"{path}.terms.{name}", line.offset)
        shape = _shape(notes, match, line.offset, n_inputs)
        if is_sugeno != isinstance(shape, Singleton | Linear):
            valid = "'constant' or 'linear'" if is_sugeno else "a fuzzy set"
            raise source.error(f"expected {valid} here, found '{match.group('kind')}'", line.offset)
        terms.append(Term(name, shape))
    return tuple(terms)


def _shape(notes: Notes, match: re.Match[str], offset: int, n_inputs: int) -> Shape:
    source = notes.source
    word = match.group("kind").strip().lower()
    place = offset + match.start("kind")
    values = _numbers(source, Line(match.group("numbers"), offset + match.start("numbers")))
    if word == "linear":
        if len(values) != n_inputs + 1:
            raise source.error(f"linear has {n_inputs + 1} parameters here, found {len(values)}", place)
        return Linear(tuple(values[:-1]), values[-1])
    if word == "discretemf":
        if len(values) < 2 or len(values) % 2:
            raise source.error(f"discretemf has pairs of x and degree, found {len(values)} numbers", place)
        return Points(tuple(zip(values[::2], values[1::2], strict=True)))
    if word not in words.SHAPES:
        valid = (*words.SHAPES, "linear", "discretemf")
        raise source.error(f"unknown membership function {expected(shown(word), valid)}", place)
    kind = words.SHAPES[word]
    if len(values) < kind.n_parameters:
        message = f"{word} has {kind.n_parameters} parameters ({', '.join(kind.names.split())}), found {len(values)}"
        raise source.error(message, place)
    if len(values) > kind.n_parameters:
        surplus = " ".join(f"{value:g}" for value in values[kind.n_parameters :])
        notes.remark(f"{word} has {kind.n_parameters} parameters: the rest ({shown(surplus)}) is left out", place)
    return kind.build(*values[: kind.n_parameters])
