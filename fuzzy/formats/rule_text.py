"""Rules as fuzzylite and IEC 61131-7 write them: tokens to a rule of the document.

::

    rule        = "if" condition "then" conclusion {("and" | ",") conclusion} ["with" weight]
    condition   = factor {("and" | "or") factor}
    factor      = "not" factor | "(" condition ")" | variable "is" {"not" | hedge} [term]
    conclusion  = output "is" term

Keywords may be in any case. AND binds tighter than OR, unless the dialect reads both from left to right.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from fuzzy.errors import FormatError, expected, shown
from fuzzy.formats.source import Source, number
from fuzzy.rules import MAX_PROPOSITIONS
from fuzzy.system import And, Expression, Hedged, Input, Is, Not, Or, Output, Rule

_KEYWORDS = frozenset({"if", "then", "is", "not", "and", "or", "with"})
_MAX_NESTING = 48


class Token(NamedTuple):
    """A word or a mark of a file, and where it begins."""

    text: str
    offset: int


class Dialect(NamedTuple):
    """How an engine reads rules.

    Attributes:
        hedges: The engine's hedges, and the document's word for each.
        is_flat: Whether AND and OR are read from left to right.
        has_chaining: Whether an antecedent may name an output.
    """

    hedges: Mapping[str, Any] = {}
    is_flat: bool = False
    has_chaining: bool = False


class ParsedRule(NamedTuple):
    """A rule, and whether it uses AND and OR."""

    rule: Rule
    uses_and: bool
    uses_or: bool


class RuleReader:
    """Recursive descent over the tokens of one rule."""

    def __init__(
        self, source: Source, inputs: Sequence[Input], outputs: Sequence[Output], dialect: Dialect, is_folded: bool
    ) -> None:
        self._source = source
        self._dialect = dialect
        self._is_folded = is_folded
        self._inputs = {entry.name: [term.name for term in entry.terms] for entry in inputs}
        self._outputs = {entry.name: [term.name for term in entry.terms] for entry in outputs}
        self._tokens: Sequence[Token] = ()
        self._next = 0

    def read(self, tokens: Sequence[Token], end: int) -> ParsedRule:
        """Read one rule.

        Args:
            tokens: The words and marks from IF to the last one.
            end: Offset behind the rule, where an error stands that finds it too short.

        Raises:
            FormatError: At the first word that is wrong, with what is valid.
        """
        self._tokens, self._next, self._end, self._count = tokens, 0, end, 0
        self._used: set[str] = set()
        self._require("if")
        antecedent = self._condition(0)
        self._require("then")
        consequents: list[Is] = []
        while True:
            conclusion = self._conclusion()
            if conclusion in consequents:
                raise self._source.error("the same conclusion stands twice in the rule", tokens[0].offset)
            consequents.append(conclusion)
            if not (self._accept("and") or self._accept(",")):
                break
        weight = self._weight() if self._accept("with") else 1.0
        if self._next < len(tokens):
            raise self._unexpected("'and', ',', 'with' or the end of the rule")
        rule = Rule(antecedent, tuple(consequents), weight)
        return ParsedRule(rule, "and" in self._used, "or" in self._used)

    @property
    def _word(self) -> str:
        return self._tokens[self._next].text if self._next < len(self._tokens) else ""

    @property
    def _offset(self) -> int:
        return self._tokens[self._next].offset if self._next < len(self._tokens) else self._end

    def _accept(self, word: str) -> bool:
        if self._word.lower() != word:
            return False
        self._next += 1
        return True

    def _require(self, word: str) -> None:
        if not self._accept(word):
            raise self._unexpected(f"'{word}'")

    def _unexpected(self, valid: str) -> FormatError:
        found = f"'{shown(self._word)}'" if self._word else "the end of the rule"
        return self._source.error(f"expected {valid}, found {found}", self._offset)

    def _condition(self, level: int) -> Expression:
        if level > _MAX_NESTING:
            raise self._source.error(f"'not' and '(' are nested more than {_MAX_NESTING} deep", self._offset)
        if self._dialect.is_flat:
            return self._flat(level)
        operands = [self._conjunction(level)]
        while self._accept("or"):
            operands.append(self._conjunction(level))
            self._used.add("or")
        return operands[0] if len(operands) == 1 else Or(tuple(operands))

    def _conjunction(self, level: int) -> Expression:
        operands = [self._factor(level)]
        while self._accept("and"):
            operands.append(self._factor(level))
            self._used.add("and")
        return operands[0] if len(operands) == 1 else And(tuple(operands))

    def _flat(self, level: int) -> Expression:
        """Read AND and OR from left to right."""
        kind = ""
        operands: list[Expression] = [self._factor(level)]
        while self._word.lower() in ("and", "or"):
            word = self._word.lower()
            if kind and kind != word:
                operands = [And(tuple(operands)) if kind == "and" else Or(tuple(operands))]
            kind = word
            self._used.add(word)
            self._next += 1
            operands.append(self._factor(level))
        if len(operands) == 1:
            return operands[0]
        return And(tuple(operands)) if kind == "and" else Or(tuple(operands))

    def _factor(self, level: int) -> Expression:
        if self._accept("not"):
            if level > _MAX_NESTING:
                raise self._source.error(f"'not' and '(' are nested more than {_MAX_NESTING} deep", self._offset)
            return Not(self._factor(level + 1))
        if self._accept("("):
            inner = self._condition(level + 1)
            self._require(")")
            return inner
        self._count += 1
        if self._count > MAX_PROPOSITIONS:
            raise self._source.error(f"an antecedent has at most {MAX_PROPOSITIONS} propositions", self._offset)
        variable, terms = self._variable(is_conclusion=False)
        self._require("is")
        return self._proposition(variable, terms)

    def _proposition(self, variable: str, terms: list[str]) -> Expression:
        """Read hedges, the nearest to the term first to act, and the term; "any" needs none."""
        hedges: list[Any] = []
        while self._word not in terms:
            word = self._word.lower()
            if word == "not":
                hedges.append(None)
            elif word in self._dialect.hedges:
                hedges.append(self._dialect.hedges[word])
            else:
                break
            self._next += 1
            if len(hedges) > _MAX_NESTING:
                raise self._source.error(f"more than {_MAX_NESTING} hedges", self._offset)
        has_no_term = bool(hedges) and hedges[-1] == "any" and self._word.lower() in ("and", "or", "then", ")")
        proposition: Expression = Is(variable, terms[0] if has_no_term else self._term(variable, terms))
        for hedge in reversed(hedges):
            proposition = Not(proposition) if hedge is None else Hedged(proposition, hedge)
        return proposition

    def _conclusion(self) -> Is:
        variable, terms = self._variable(is_conclusion=True)
        self._require("is")
        word = self._word.lower()
        if self._word not in terms and (word == "not" or word in self._dialect.hedges):
            raise self._source.error(f"'{word}' in a conclusion has no word in the workbench", self._offset)
        return Is(variable, self._term(variable, terms))

    def _variable(self, *, is_conclusion: bool) -> tuple[str, list[str]]:
        valid = self._outputs if is_conclusion else self._inputs
        if not is_conclusion and self._dialect.has_chaining:
            valid = self._inputs | self._outputs
        word = self._word
        if not word or (word.lower() in _KEYWORDS and word not in valid) or word in "(),":
            raise self._unexpected("an output" if is_conclusion else "a variable, 'not' or '('")
        name = self._known(word, valid)
        if name is None:
            kind = "output" if is_conclusion else "input"
            other = self._inputs if is_conclusion else self._outputs
            if self._known(word, other) is not None:
                is_other = "an input" if is_conclusion else "an output: this dialect does not chain rules through it"
                raise self._source.error(
                    f"'{shown(word)}' is {is_other}; expected one of: {', '.join(valid)}", self._offset
                )
            raise self._source.error(f"unknown {kind} {expected(shown(word), valid)}", self._offset)
        self._next += 1
        return name, valid[name]

    def _term(self, variable: str, terms: list[str]) -> str:
        name = self._known(self._word, terms)
        if name is None:
            if not self._word or self._word.lower() in _KEYWORDS or self._word in "(),":
                raise self._unexpected(f"a term of '{variable}'")
            raise self._source.error(
                f"unknown term of '{variable}': {expected(shown(self._word), terms)}", self._offset
            )
        self._next += 1
        return name

    def _known(self, word: str, names: Mapping[str, Any] | Sequence[str]) -> str | None:
        """Return the name that a word means: itself, or the one name that differs by case only."""
        if word in names:
            return word
        alike = [name for name in names if name.casefold() == word.casefold()] if self._is_folded else []
        return alike[0] if len(alike) == 1 else None

    def _weight(self) -> float:
        value = number(self._word)
        if value is None or not 0 <= value <= 1:
            raise self._unexpected("a weight from 0 to 1")
        self._next += 1
        return value
