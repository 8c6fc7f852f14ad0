"""Variables of an FML file with their terms: sets, functions of a TSK system, monotone sets of Tsukamoto's."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from fuzzy.errors import expected, shown
from fuzzy.formats.fml import words
from fuzzy.formats.fml.agreement import Agreement
from fuzzy.formats.fml.tree import Element
from fuzzy.formats.source import number
from fuzzy.limits import MAX_OUTPUT_TERMS, MAX_VALUE, MAX_VARIABLES
from fuzzy.shapes import Linear, Points, Shape, Singleton
from fuzzy.system import Input, NoFire, Output, Term


class Variables:
    """Variables of a file.

    Attributes:
        inputs: In the order of the file.
        outputs: In the order of the file.
        of_functions: Names of the outputs whose terms are functions of the inputs, on which TSK rules conclude.
    """

    def __init__(self, base: Element, agreement: Agreement) -> None:
        self._agreement = agreement
        self.inputs: list[Input] = []
        self.outputs: list[Output] = []
        self.of_functions: set[str] = set()
        names: set[str] = set()
        found: list[tuple[Element, str]] = []
        for element in base.children:
            if element.tag in words.REFUSED_VARIABLES:
                raise element.error(f"a <{element.tag}> cannot be read; valid: {', '.join(words.VARIABLES)}")
            if element.tag not in words.VARIABLES:
                raise element.error(f"unknown element <{shown(element.tag)}>; valid: {', '.join(words.VARIABLES)}")
            name = _name(element)
            if name in names:
                raise element.error(f"the variable '{shown(name)}' stands twice")
            names.add(name)
            if len(names) > 2 * MAX_VARIABLES:
                raise element.error(f"more than {MAX_VARIABLES} inputs or outputs")
            otherwise = "input" if element.tag == "fuzzyVariable" else "output"
            is_input = element.choice("type", ("INPUT", "OUTPUT"), otherwise) == "INPUT"
            if is_input and element.tag != "fuzzyVariable":
                raise element.error(f"a <{element.tag}> is an output")
            if is_input:
                low, high, terms = self._universe(element, f"inputs.{name}")
                self.inputs.append(Input(name, low, high, terms, _unit(element)))
            else:
                found.append((element, name))
        if not self.inputs or not found:
            raise base.error(f"<knowledgeBase> has {len(self.inputs)} inputs and {len(found)} outputs, both are needed")
        # Functions of the inputs are read when all inputs are known.
        self.outputs = [self._output(element, name) for element, name in found]
        for entries, what in ((self.inputs, "inputs"), (self.outputs, "outputs")):
            if len(entries) > MAX_VARIABLES:
                raise base.error(f"more than {MAX_VARIABLES} {what}")

    def _output(self, element: Element, name: str) -> Output:
        default = element.number("defaultValue", 0.0)
        if element.tag == "fuzzyVariable":
            low, high, terms = self._universe(element, f"outputs.{name}")
            defuzzifier = words.DEFUZZIFIERS[element.choice("defuzzifier", words.DEFUZZIFIERS, "COG")]
            accumulation = words.DISJUNCTIONS[element.choice("accumulation", words.DISJUNCTIONS, "MAX")]
        else:
            element.choice("combination", ("WA",), "WA")
            defuzzifier, accumulation = "weighted_average", "sum"  # every rule counts
            if element.tag == "tskVariable":
                low, high, terms = self._functions(element, name, default)
            else:
                low, high, terms = self._universe(element, f"outputs.{name}")
        self._agreement.agree("defuzzifier", defuzzifier, element, f"'{name}'")
        self._agreement.agree("accumulation", accumulation, element, f"'{name}'")
        return Output(name, low, high, terms, _unit(element), NoFire("default", default))

    def _universe(self, element: Element, path: str) -> tuple[float, float, tuple[Term, ...]]:
        is_monotone = element.tag == "tsukamotoVariable"
        self._agreement.places[path] = element
        low, high = element.number("domainleft"), element.number("domainright")
        terms: list[Term] = []
        for child, name in self._terms(element, "tsukamotoTerm" if is_monotone else "fuzzyTerm", path):
            is_complement = child.choice("complement", ("TRUE", "FALSE"), "false") == "TRUE"
            if is_complement and is_monotone:
                message = "the complement is that of the set; JFML takes 1 minus the place where the set has a degree"
                self._agreement.remark(message, child)
            valid = words.MONOTONE_SHAPES if is_monotone else (*words.SHAPES, "pointSetShape")
            terms.append(Term(name, self._shape(child, valid), complement=is_complement))
        return low, high, tuple(terms)

    def _terms(self, element: Element, tag: str, path: str) -> list[tuple[Element, str]]:
        """Return a variable's terms with their names."""
        found: dict[str, Element] = {}
        for child in element.children:
            if child.tag != tag:
                raise child.error(f"unknown element <{shown(child.tag)}>; valid: {tag}")
            name = _name(child)
            if name in found:
                raise child.error(f"the term '{shown(name)}' stands twice")
            if len(found) >= MAX_OUTPUT_TERMS:
                raise child.error(f"more than {MAX_OUTPUT_TERMS} terms")
            self._agreement.places[f"{path}.terms.{name}"] = child
            found[name] = child
        return [(child, name) for name, child in found.items()]

    def _functions(self, element: Element, name: str, default: float) -> tuple[float, float, tuple[Term, ...]]:
        """Return a TSK output's terms and its range, which the format has no word for: the span of all values."""
        path = f"outputs.{name}"
        self.of_functions.add(name)
        self._agreement.places[path] = element
        terms = tuple(Term(term, self._function(child)) for child, term in self._terms(element, "tskTerm", path))
        ends = [end for term in terms for end in _span(term.shape, self.inputs)]
        low, high = min(default, *ends), max(default, *ends)
        if not high - low > 1e-6 * max(abs(low), abs(high)):
            margin = max(0.5, 0.5 * abs(low))
            low, high = low - margin, high + margin
        return max(low, -MAX_VALUE), min(high, MAX_VALUE), terms

    def _function(self, term: Element) -> Shape:
        """Return a constant, or a constant and a coefficient for each input, which follow it in the file."""
        values = []
        for child in term.children:
            if child.tag != "tskValue":
                raise child.error(f"unknown element <{shown(child.tag)}>; valid: tskValue")
            value = number(child.text)
            if value is None:
                raise child.error(f"<tskValue> is '{shown(child.text)}', expected a number")
            values.append(value)
        if not values:
            raise term.error("<tskTerm> holds no <tskValue>")
        term.required("order")
        if term.choice("order", ("0", "1"), "0") == "0":
            if len(values) > 1:
                self._agreement.remark("of a function of order 0 the first value counts", term)
            return Singleton(values[0])
        if len(values) > len(self.inputs) + 1:
            valid = f"valid are at most {len(self.inputs) + 1}: a constant, and a coefficient for each input"
            raise term.error(f"<tskTerm> holds {len(values)} values; {valid}")
        missing = len(self.inputs) + 1 - len(values)
        return Linear((*values[1:], *itertools.repeat(0.0, missing)), values[0])

    def _shape(self, term: Element, valid: Sequence[str]) -> Shape:
        if len(term.children) != 1:
            raise term.error(f"<{term.tag}> holds {len(term.children)} shapes, expected one")
        element = term.children[0]
        if element.tag in words.REFUSED_SHAPES:
            raise element.error(f"a <{element.tag}> cannot be read")
        if element.tag not in valid:
            raise element.error(f"unknown shape {expected(shown(element.tag), valid)}")
        if element.tag not in words.SHAPES:
            return self._points(element)
        kind = words.SHAPES[element.tag]
        return kind.build(*(element.number(f"param{place}") for place in range(1, kind.n_parameters + 1)))

    def _points(self, element: Element) -> Shape:
        method = element.choice("interpolationMethod", ("LINEAR", "LAGRANGE", "SPLINE", "CUBIC"), "linear")
        if method != "LINEAR":
            self._agreement.remark(f"the points are joined by lines, not by '{method.lower()}', as JFML does", element)
        points = []
        for child in element.children:
            if child.tag != "point":
                raise child.error(f"unknown element <{shown(child.tag)}>; valid: point")
            points.append((child.number("x"), child.number("y")))
        return Points(tuple(sorted(points, key=lambda point: point[0])))


def _span(function: Shape, inputs: Sequence[Input]) -> tuple[float, float]:
    """Return the least and the greatest value of a function over the ranges of the inputs."""
    if isinstance(function, Singleton):
        return function.value, function.value
    assert isinstance(function, Linear)
    low = high = function.constant
    for factor, entry in zip(function.coefficients, inputs, strict=True):
        low += min(factor * entry.low, factor * entry.high)
        high += max(factor * entry.low, factor * entry.high)
    return low, high


def _name(element: Element) -> str:
    return " ".join(element.required("name").split())


def _unit(element: Element) -> str:
    """Return the unit, FML's ``scale``."""
    return element.attributes.get("scale", "").strip()
