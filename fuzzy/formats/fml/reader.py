"""An FML file to the document, which evaluates as JFML does: 2000 left ends of intervals and the sets' break points."""

from __future__ import annotations

from typing import Any

from fuzzy.errors import FormatError, InvalidSystemError, expected, shown
from fuzzy.formats.assembly import Imported, Remark, complement_name, marked_resolution, rule_base, with_complements
from fuzzy.formats.fml import tree, words
from fuzzy.formats.fml.tree import Element
from fuzzy.shapes import Points, Shape
from fuzzy.system import (
    And,
    Expression,
    FuzzySystem,
    Hedged,
    Inference,
    Input,
    Is,
    NoFire,
    Not,
    Or,
    Output,
    Rule,
    Sampling,
    Term,
)
from fuzzy.validation import MAX_RULES, MAX_TERMS, MAX_VARIABLES, validate

_JFML = Sampling(2000, "left_with_break_points")


def read(text: str, name: str) -> Imported:
    """Read a file's text.

    Args:
        text: The XML.
        name: Name of the file, for errors.

    Raises:
        FormatError: With line and column of the first mistake, what was found and what is valid.
    """
    return _Reader(tree.parse(text, name)).read(text)


class _Agreed:
    """One operator on which all places of a file must agree; the first place is remembered."""

    def __init__(self, what: str) -> None:
        self.what = what
        self.value: Any = None
        self._where = ""

    def agree(self, value: str, element: Element, where: str) -> None:
        if self.value is not None and self.value != value:
            raise element.error(
                f"the {self.what} of {where} is {value}, that of {self._where} is {self.value}: "
                "a system has one for all"
            )
        self.value, self._where = value, where


class _Reader:
    def __init__(self, root: Element) -> None:
        if root.tag != "fuzzySystem":
            raise root.error(f"expected <fuzzySystem>, found <{shown(root.tag)}>")
        self.root = root
        self.places: dict[str, Element] = {}
        self.remarks: list[Remark] = []
        self.negated: list[Is] = []
        self.operators = {
            key: _Agreed(key) for key in ("accumulation", "defuzzifier", "activation method", "andMethod", "orMethod")
        }
        self.suggested: dict[str, str] = {}

    def read(self, text: str) -> Imported:
        inputs, outputs = self._variables(self.root.only("knowledgeBase"))
        bases = [child for child in self.root.children if child.tag != "knowledgeBase"]
        rules: list[Rule] = []
        for base in bases:
            if base.tag in words.REFUSED_RULE_BASES:
                raise base.error(f"a <{base.tag}> cannot be read; valid: mamdaniRuleBase")
            if base.tag != "mamdaniRuleBase":
                raise base.error(f"unknown element <{shown(base.tag)}>; valid: mamdaniRuleBase")
            rules += self._rule_base(base, inputs, outputs, len(rules))
        if not bases:
            raise self.root.error("<fuzzySystem> has no <mamdaniRuleBase>")
        system_outputs = with_complements(outputs, self.negated)
        inference = Inference(
            self._operator("andMethod", "min"),
            self._operator("orMethod", "max"),
            self._operator("activation method", "min"),
            self._operator("accumulation", "max"),
            self._operator("defuzzifier", "centroid"),
            marked_resolution(text, _JFML),
        )
        name = " ".join(self.root.attributes.get("name", "").split()) or "fuzzySystem"
        rule_set = rule_base(inputs, system_outputs, rules)
        return self._imported(FuzzySystem(name, tuple(inputs), system_outputs, rule_set, inference))

    def _operator(self, key: str, otherwise: str) -> Any:
        value = self.operators[key].value
        return self.suggested.get(key, otherwise) if value is None else value

    def _imported(self, system: FuzzySystem) -> Imported:
        try:
            places = {path: (element.line, element.column) for path, element in self.places.items()}
            return Imported(validate(system), tuple(self.remarks), places)
        except InvalidSystemError as error:
            path = error.path
            while path not in self.places and path:
                path = path[: max(path.rfind("."), path.rfind("["), 0)]
            raise self.places.get(path, self.root).error(error.message, error.path) from None

    def _remark(self, message: str, element: Element) -> None:
        self.remarks.append(Remark(message, element.line, element.column))

    def _variables(self, base: Element) -> tuple[list[Input], list[Output]]:
        inputs: list[Input] = []
        outputs: list[Output] = []
        for element in base.children:
            if element.tag in words.REFUSED_VARIABLES:
                raise element.error(f"a <{element.tag}> cannot be read; valid: fuzzyVariable")
            if element.tag != "fuzzyVariable":
                raise element.error(f"unknown element <{shown(element.tag)}>; valid: fuzzyVariable")
            name = self._name(element)
            if any(entry.name == name for entry in (*inputs, *outputs)):
                raise element.error(f"the variable '{shown(name)}' stands twice")
            if element.choice("type", ("INPUT", "OUTPUT"), "input") == "INPUT":
                inputs.append(self._input(element, name))
            else:
                outputs.append(self._output(element, name))
            if max(len(inputs), len(outputs)) > MAX_VARIABLES:
                raise element.error(f"more than {MAX_VARIABLES} inputs or outputs")
        if not inputs or not outputs:
            raise base.error(f"<knowledgeBase> has {len(inputs)} inputs and {len(outputs)} outputs, both are needed")
        return inputs, outputs

    def _name(self, element: Element) -> str:
        return " ".join(element.required("name").split())

    def _input(self, element: Element, name: str) -> Input:
        low, high, terms = self._universe(element, f"inputs.{name}")
        return Input(name, low, high, terms, _unit(element))

    def _output(self, element: Element, name: str) -> Output:
        low, high, terms = self._universe(element, f"outputs.{name}")
        value = element.choice("accumulation", words.DISJUNCTIONS, "MAX")
        self.operators["accumulation"].agree(words.DISJUNCTIONS[value], element, f"'{name}'")
        value = element.choice("defuzzifier", words.DEFUZZIFIERS, "COG")
        self.operators["defuzzifier"].agree(words.DEFUZZIFIERS[value], element, f"'{name}'")
        return Output(name, low, high, terms, _unit(element), NoFire("default", element.number("defaultValue", 0.0)))

    def _universe(self, element: Element, path: str) -> tuple[float, float, tuple[Term, ...]]:
        self.places[path] = element
        low, high = element.number("domainleft"), element.number("domainright")
        terms: list[Term] = []
        for child in element.children:
            if child.tag != "fuzzyTerm":
                raise child.error(f"unknown element <{shown(child.tag)}>; valid: fuzzyTerm")
            name = self._name(child)
            if any(term.name == name for term in terms):
                raise child.error(f"the term '{shown(name)}' stands twice")
            if len(terms) >= MAX_TERMS:
                raise child.error(f"more than {MAX_TERMS} terms")
            self.places[f"{path}.terms.{name}"] = child
            is_complement = child.choice("complement", ("TRUE", "FALSE"), "false") == "TRUE"
            terms.append(Term(name, self._shape(child), complement=is_complement))
        return low, high, tuple(terms)

    def _shape(self, term: Element) -> Shape:
        if len(term.children) != 1:
            raise term.error(f"<fuzzyTerm> holds {len(term.children)} shapes, expected one")
        element = term.children[0]
        if element.tag in words.REFUSED_SHAPES:
            raise element.error(f"a <{element.tag}> cannot be read")
        if element.tag == "pointSetShape":
            return self._points(element)
        if element.tag not in words.SHAPES:
            valid = (*words.SHAPES, "pointSetShape")
            raise element.error(f"unknown shape {expected(shown(element.tag), valid)}")
        kind = words.SHAPES[element.tag]
        return kind.build(*(element.number(f"param{place}") for place in range(1, kind.n_parameters + 1)))

    def _points(self, element: Element) -> Shape:
        method = element.choice("interpolationMethod", ("LINEAR", "LAGRANGE", "SPLINE"), "linear")
        if method != "LINEAR":
            self._remark(f"the points are joined by lines, not by '{method.lower()}', as JFML does", element)
        points = []
        for child in element.children:
            if child.tag != "point":
                raise child.error(f"unknown element <{shown(child.tag)}>; valid: point")
            points.append((child.number("x"), child.number("y")))
        return Points(tuple(sorted(points, key=lambda point: point[0])))

    def _rule_base(self, base: Element, inputs: list[Input], outputs: list[Output], count: int) -> list[Rule]:
        value = base.choice("activationMethod", words.CONJUNCTIONS, "MIN")
        where = f"the rule base '{shown(base.attributes.get('name', ''))}'"
        self.operators["activation method"].agree(words.CONJUNCTIONS[value], base, where)
        for key, table in (("andMethod", words.CONJUNCTIONS), ("orMethod", words.DISJUNCTIONS)):
            word = base.choice(key, table, next(iter(table)))
            self.suggested.setdefault(key, table[word])
        rules: list[Rule] = []
        for element in base.children:
            if element.tag != "rule":
                raise element.error(f"unknown element <{shown(element.tag)}>; valid: rule")
            if count + len(rules) >= MAX_RULES:
                raise element.error(f"more than {MAX_RULES} rules")
            rules += self._rule(element, base, inputs, outputs, count + len(rules))
        return rules

    def _rule(
        self, element: Element, base: Element, inputs: list[Input], outputs: list[Output], number: int
    ) -> list[Rule]:
        """Return the rule, and one more for its ELSE, which fires with 1 - the antecedent's degree."""
        antecedent = self._antecedent(element, base, inputs)
        weight = element.number("weight", 1.0)
        if not 0 <= weight <= 1:
            raise element.error(f"weight {weight:g}: valid is 0 to 1")
        consequent = element.only("consequent")
        parts = {child.tag: child for child in consequent.children}
        if "then" not in parts or not set(parts) <= {"then", "else"}:
            raise consequent.error("<consequent> holds <then>, and may hold <else>")
        self.places[f"rules.list[{number}]"] = element
        rules = [Rule(antecedent, self._conclusions(parts["then"], outputs), weight)]
        if "else" in parts:
            if weight != 1:
                raise parts["else"].error("<else> in a rule with a weight cannot be said in the workbench")
            self.places[f"rules.list[{number + 1}]"] = parts["else"]
            rules.append(Rule(Not(antecedent), self._conclusions(parts["else"], outputs)))
        return rules

    def _antecedent(self, element: Element, base: Element, inputs: list[Input]) -> Expression:
        clauses = element.only("antecedent").children
        operands = [self._proposition(clause, inputs) for clause in clauses]
        if not operands:
            raise element.error("<antecedent> holds no <clause>")
        if len(operands) == 1:
            return operands[0]
        connector = element.choice("connector", ("AND", "OR"), "and")
        key, table = ("andMethod", words.CONJUNCTIONS) if connector == "AND" else ("orMethod", words.DISJUNCTIONS)
        owner = element if key in element.attributes else base
        value = owner.choice(key, table, next(iter(table)))
        self.operators[key].agree(table[value], owner, f"the rule '{shown(element.attributes.get('name', ''))}'")
        return And(tuple(operands)) if connector == "AND" else Or(tuple(operands))

    def _clause(self, clause: Element, variables: list[Input] | list[Output], kind: str) -> Is:
        if clause.tag != "clause":
            raise clause.error(f"unknown element <{shown(clause.tag)}>; valid: clause")
        name, term = clause.only("variable").text, clause.only("term").text
        found = next((entry for entry in variables if entry.name == name), None)
        if found is None:
            raise clause.error(f"unknown {kind} {expected(shown(name), [entry.name for entry in variables])}")
        terms = [entry.name for entry in found.terms]
        if term not in terms:
            raise clause.error(f"unknown term of '{name}': {expected(shown(term), terms)}")
        return Is(name, term)

    def _proposition(self, clause: Element, inputs: list[Input]) -> Expression:
        proposition = self._clause(clause, inputs, "input")
        modifier = clause.attributes.get("modifier", "").strip()
        if modifier == "not":
            return Not(proposition)
        if not modifier:
            return proposition
        if modifier not in words.HEDGES:
            raise self._unknown_modifier(clause, modifier)
        hedge: Any = words.HEDGES[modifier]
        return Hedged(proposition, hedge)

    def _unknown_modifier(self, clause: Element, modifier: str) -> FormatError:
        if modifier in words.REFUSED_HEDGES or modifier.startswith("custom"):
            return clause.error(f"the modifier '{shown(modifier)}' has no word in the workbench")
        return clause.error(f"unknown modifier {expected(shown(modifier), ('not', *words.HEDGES))}")

    def _conclusions(self, part: Element, outputs: list[Output]) -> tuple[Is, ...]:
        conclusions = []
        for clause in part.children:
            conclusion = self._clause(clause, outputs, "output")
            modifier = clause.attributes.get("modifier", "").strip()
            if modifier == "not":
                self.negated.append(conclusion)
                conclusion = Is(conclusion.variable, complement_name(conclusion.term))
            elif modifier:
                raise clause.error(f"the modifier '{shown(modifier)}' in a conclusion has no word in the workbench")
            conclusions.append(conclusion)
        if not conclusions:
            raise part.error(f"<{part.tag}> holds no <clause>")
        return tuple(conclusions)


def _unit(element: Element) -> str:
    """Return the unit, FML's ``scale``."""
    return element.attributes.get("scale", "").strip()
