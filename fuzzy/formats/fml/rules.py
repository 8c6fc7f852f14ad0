"""Rule bases of an FML file: Mamdani's, Tsukamoto's and TSK."""

from __future__ import annotations

from typing import Any

from fuzzy.errors import FormatError, expected, shown
from fuzzy.formats.assembly import complement_name
from fuzzy.formats.fml import words
from fuzzy.formats.fml.agreement import Agreement
from fuzzy.formats.fml.tree import Element
from fuzzy.formats.fml.variables import Variables
from fuzzy.limits import MAX_RULES
from fuzzy.system import And, Expression, Hedged, Input, Is, Not, Or, Output, Rule


class Rules:
    """Rules of all rule bases, in order."""

    def __init__(self, variables: Variables, agreement: Agreement) -> None:
        self._variables = variables
        self._agreement = agreement
        self.rules: list[Rule] = []

    def add(self, base: Element) -> None:
        """Read a rule base."""
        if base.tag in words.REFUSED_RULE_BASES:
            raise base.error(f"a <{base.tag}> cannot be read; valid: {', '.join(words.RULE_BASES)}")
        if base.tag not in words.RULE_BASES:
            raise base.error(f"unknown element <{shown(base.tag)}>; valid: {', '.join(words.RULE_BASES)}")
        tags = words.RULE_BASES[base.tag]
        is_tsk = base.tag == "tskRuleBase"
        concludes = [
            entry for entry in self._variables.outputs if (entry.name in self._variables.of_functions) == is_tsk
        ]
        value = base.choice("activationMethod", words.CONJUNCTIONS, "MIN")
        if base.tag == "mamdaniRuleBase":  # the others imply no sets
            where = f"the rule base '{shown(base.attributes.get('name', ''))}'"
            self._agreement.agree("activation method", words.CONJUNCTIONS[value], base, where)
        for key, table in (("andMethod", words.CONJUNCTIONS), ("orMethod", words.DISJUNCTIONS)):
            word = base.choice(key, table, next(iter(table)))
            self._agreement.suggested.setdefault(key, table[word])
        for element in base.children:
            if element.tag != tags.rule:
                raise element.error(f"unknown element <{shown(element.tag)}>; valid: {tags.rule}")
            if len(self.rules) >= MAX_RULES:
                raise element.error(f"more than {MAX_RULES} rules")
            self._rule(element, base, tags, concludes)

    def _rule(self, element: Element, base: Element, tags: words.RuleTags, outputs: list[Output]) -> None:
        """Read a rule; its ELSE, which fires with 1 - the antecedent's degree, becomes one more."""
        antecedent = self._antecedent(element, base)
        weight = element.number("weight", 1.0)
        if not 0 <= weight <= 1:
            raise element.error(f"weight {weight:g}: valid is 0 to 1")
        consequent = element.only(tags.consequent)
        parts = {child.tag: child for child in consequent.children}
        if tags.then not in parts or not set(parts) <= {tags.then, tags.otherwise}:
            raise consequent.error(f"<{tags.consequent}> holds <{tags.then}>, and may hold <{tags.otherwise}>")
        self._agreement.places[f"rules.list[{len(self.rules)}]"] = element
        self.rules.append(Rule(antecedent, self._conclusions(parts[tags.then], tags, outputs), weight))
        if tags.otherwise in parts:
            last = parts[tags.otherwise]
            if weight != 1:
                raise last.error(f"<{last.tag}> in a rule with a weight cannot be said in the workbench")
            self._agreement.places[f"rules.list[{len(self.rules)}]"] = last
            self.rules.append(Rule(Not(antecedent), self._conclusions(last, tags, outputs)))

    def _antecedent(self, element: Element, base: Element) -> Expression:
        clauses = element.only("antecedent").children
        operands = [self._proposition(clause) for clause in clauses]
        if not operands:
            raise element.error("<antecedent> holds no <clause>")
        if len(operands) == 1:
            return operands[0]
        connector = element.choice("connector", ("AND", "OR"), "and")
        key, table = ("andMethod", words.CONJUNCTIONS) if connector == "AND" else ("orMethod", words.DISJUNCTIONS)
        owner = element if key in element.attributes else base
        value = owner.choice(key, table, next(iter(table)))
        self._agreement.agree(key, table[value], owner, f"the rule '{shown(element.attributes.get('name', ''))}'")
        return And(tuple(operands)) if connector == "AND" else Or(tuple(operands))

    def _clause(self, clause: Element, tag: str, variables: list[Input] | list[Output], kind: str) -> Is:
        if clause.tag != tag:
            raise clause.error(f"unknown element <{shown(clause.tag)}>; valid: {tag}")
        name, term = clause.only("variable").text, clause.only("term").text
        found = next((entry for entry in variables if entry.name == name), None)
        if found is None:
            raise clause.error(f"unknown {kind} {expected(shown(name), [entry.name for entry in variables])}")
        terms = [entry.name for entry in found.terms]
        if term not in terms:
            raise clause.error(f"unknown term of '{name}': {expected(shown(term), terms)}")
        return Is(name, term)

    def _proposition(self, clause: Element) -> Expression:
        proposition = self._clause(clause, "clause", self._variables.inputs, "input")
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

    def _conclusions(self, part: Element, tags: words.RuleTags, outputs: list[Output]) -> tuple[Is, ...]:
        conclusions = []
        for clause in part.children:
            conclusion = self._clause(clause, tags.clause, outputs, "output")
            modifier = clause.attributes.get("modifier", "").strip()
            if modifier == "not" and conclusion.variable not in self._variables.of_functions:
                self._agreement.negated.append(conclusion)
                conclusion = Is(conclusion.variable, complement_name(conclusion.term))
            elif modifier:
                raise clause.error(f"the modifier '{shown(modifier)}' in a conclusion has no word in the workbench")
            conclusions.append(conclusion)
        if not conclusions:
            raise part.error(f"<{part.tag}> holds no <{tags.clause}>")
        return tuple(conclusions)
