"""Rule text <-> rule.

The language, keywords in any case, names exactly as they are written::

    rule        = "if" expression "then" consequent {"," consequent} ["with" weight]
    expression  = conjunction {"or" conjunction}
    conjunction = factor {"and" factor}
    factor      = ("not" | hedge) factor | "(" expression ")" | variable "is" {"not" | hedge} term
    consequent  = output "is" term
    hedge       = "very" | "extremely" | "somewhat" | ...

NOT and hedges bind tighter than AND, AND tighter than OR (IEC 61131-7); of several before a term the last one is
applied first. The variable is an input, or an output that the rules before conclude on. A name that holds a blank, a
bracket, a comma or a double quote, or that is a keyword or a hedge, stands in double quotes; a double quote in it is
doubled. A hedge's word that no hedge could be there is a name without them, too.
"""

from __future__ import annotations

import re
import typing
from collections.abc import Iterable

from fuzzy.errors import FormatError, expected, shown
from fuzzy.rules import MAX_DEPTH, MAX_PROPOSITIONS, depth
from fuzzy.system import And, Expression, FuzzySystem, Hedge, Hedged, Is, Not, Or, Rule, Variable

KEYWORDS = frozenset({"if", "then", "is", "not", "and", "or", "with"})
"""Words that are names only in double quotes."""

HEDGES: dict[str, Hedge] = {hedge: hedge for hedge in typing.get_args(Hedge)}
"""Words of the linguistic hedges."""

_MAX_BRACKETS = 4 * MAX_DEPTH

_TOKEN = re.compile(r'(?P<quoted>"(?:[^"]|"")*")|(?P<mark>[(),])|(?P<word>[^\s(),"]+)')
_BLANKS = re.compile(r"\s*")
_WEIGHT = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_BARE_NAME = re.compile(r'[^\s(),"]+')


def parse_rule(text: str, system: FuzzySystem) -> Rule:
    """Read one rule.

    Args:
        text: The rule, such as ``if e is NB and de is not FR then T is LL with 0.8``.
        system: The system whose variables and terms the rule may name; its own rules do not matter.

    Returns:
        The rule; ``format_rule`` gives a text from which it is read again.

    Raises:
        FormatError: With the column of the first word that is wrong, what it is and what is valid.
    """
    return _Parser(text, system).rule()


def format_rule(rule: Rule) -> str:
    """Return the canonical text of a rule: lower-case keywords, brackets only where they change the meaning."""
    consequents = ", ".join(_proposition(consequent) for consequent in rule.consequents)
    weight = "" if rule.weight == 1 else f" with {rule.weight!r}"
    return f"if {format_expression(rule.antecedent)} then {consequents}{weight}"


def format_expression(expression: Expression) -> str:
    """Return the canonical text of an antecedent."""
    match expression:
        case Is():
            return _proposition(expression)
        case Not() | Hedged():
            words, operand = _prefix(expression)
            if isinstance(operand, Is):
                return f"{_quoted(operand.variable)} is {words} {_quoted(operand.term)}"
            return f"{words} ({format_expression(operand)})"
        case And(operands=operands):
            return " and ".join(_operand(operand, And | Or) for operand in operands)
        case Or(operands=operands):
            return " or ".join(_operand(operand, Or) for operand in operands)


def _prefix(expression: Not | Hedged) -> tuple[str, Expression]:
    """Return the words "not" and hedges before an expression, and that expression."""
    words: list[str] = []
    inner: Expression = expression
    while isinstance(inner, Not | Hedged):
        words.append("not" if isinstance(inner, Not) else inner.hedge)
        inner = inner.operand
    return " ".join(words), inner


def _operand(operand: Expression, bracketed: object) -> str:
    text = format_expression(operand)
    return f"({text})" if isinstance(operand, bracketed) else text  # type: ignore[arg-type]


def _proposition(proposition: Is) -> str:
    return f"{_quoted(proposition.variable)} is {_quoted(proposition.term)}"


def _quoted(name: str) -> str:
    if _BARE_NAME.fullmatch(name) and name.lower() not in KEYWORDS and name.lower() not in HEDGES:
        return name
    return '"' + name.replace('"', '""') + '"'


class _Parser:
    """Recursive descent over one rule's text; ``start`` and ``end`` frame the current word."""

    def __init__(self, text: str, system: FuzzySystem) -> None:
        self.text = text
        self.inputs: dict[str, Variable] = {variable.name: variable for variable in system.inputs}
        self.outputs: dict[str, Variable] = {variable.name: variable for variable in system.outputs}
        self.variables = self.inputs | self.outputs
        self.count = 0
        self.end = 0
        self.advance()

    def advance(self) -> None:
        """Step to the next word; an empty word is the end of the text."""
        blanks = _BLANKS.match(self.text, self.end)
        self.start = blanks.end() if blanks else self.end
        match = _TOKEN.match(self.text, self.start)
        if match is None and self.start < len(self.text):
            self.end = len(self.text)
            raise self.error("this name in double quotes does not end: expected '\"'")
        self.end = match.end() if match else self.start
        self.word = match.group() if match else ""
        self.is_keyword = self.word.lower() in KEYWORDS

    def error(self, message: str) -> FormatError:
        """Return an error at the current word."""
        return FormatError(message, "rule", 1, self.start + 1)

    def unexpected(self, valid: str) -> FormatError:
        """Return an error that says which word was found and what would be valid."""
        found = f"'{shown(self.word)}'" if self.word else "the end of the rule"
        return self.error(f"expected {valid}, found {found}")

    def accept(self, word: str) -> bool:
        """Step over ``word`` where it comes next."""
        if self.word.lower() != word:
            return False
        self.advance()
        return True

    def require(self, word: str, alternatives: str = "") -> None:
        """Step over ``word``, which must come next."""
        if not self.accept(word):
            raise self.unexpected(f"'{word}'{alternatives}")

    def accept_hedge(self, following: str) -> Hedge | None:
        """Step over a hedge where one comes next and what follows is none of the ``following`` words."""
        hedge = HEDGES.get(self.word.lower())
        if hedge is None:
            return None
        place = (self.start, self.end, self.word, self.is_keyword)
        self.advance()
        if self.word.lower() in following.split("|"):
            self.start, self.end, self.word, self.is_keyword = place
            return None
        return hedge

    def rule(self) -> Rule:
        """Read the whole text."""
        self.require("if")
        antecedent = self.expression(0)
        if depth(antecedent) > MAX_DEPTH:
            raise FormatError(f"the antecedent is nested more than {MAX_DEPTH} deep", "rule", 1, 1)
        self.require("then", ", 'and' or 'or'")
        consequents = [self.consequent()]
        while self.accept(","):
            consequents.append(self.consequent())
            if len(consequents) > MAX_PROPOSITIONS:
                raise self.error(f"a rule has at most {MAX_PROPOSITIONS} consequents")
        weight = self.weight() if self.accept("with") else 1.0
        if self.word:
            raise self.unexpected("',', 'with' or the end of the rule")
        return Rule(antecedent, tuple(consequents), weight)

    def expression(self, level: int) -> Expression:
        """Read conjunctions joined by OR."""
        operands = [self.conjunction(level)]
        while self.accept("or"):
            operands.append(self.conjunction(level))
        return operands[0] if len(operands) == 1 else Or(tuple(operands))

    def conjunction(self, level: int) -> Expression:
        """Read factors joined by AND."""
        operands = [self.factor(level)]
        while self.accept("and"):
            operands.append(self.factor(level))
        return operands[0] if len(operands) == 1 else And(tuple(operands))

    def factor(self, level: int) -> Expression:
        """Read a negation, a bracket or a proposition."""
        if level > _MAX_BRACKETS:
            raise self.error(f"'not', hedges and '(' are nested more than {_MAX_BRACKETS} deep")
        if self.accept("not"):
            return Not(self.factor(level + 1))
        if hedge := self.accept_hedge("is"):
            return Hedged(self.factor(level + 1), hedge)
        if self.accept("("):
            inner = self.expression(level + 1)
            self.require(")", ", 'and' or 'or'")
            return inner
        self.count += 1
        if self.count > MAX_PROPOSITIONS:
            raise self.error(f"an antecedent has at most {MAX_PROPOSITIONS} propositions")
        variable = self.variable(self.variables, "an input, 'not', a hedge or '('", {}, "")
        self.require("is")
        return self.proposition(variable, level)

    def proposition(self, variable: Variable, level: int) -> Expression:
        """Read "not", hedges and a term."""
        if level > _MAX_BRACKETS:
            raise self.error(f"'not', hedges and '(' are nested more than {_MAX_BRACKETS} deep")
        if self.accept("not"):
            return Not(self.proposition(variable, level + 1))
        if hedge := self.accept_hedge("and|or|then|)|"):
            return Hedged(self.proposition(variable, level + 1), hedge)
        return Is(variable.name, self.term(variable))

    def consequent(self) -> Is:
        """Read "output is term"."""
        variable = self.variable(self.outputs, "an output", self.inputs, "input, a consequent names outputs")
        self.require("is")
        if self.word.lower() == "not":
            raise self.error("a consequent cannot be negated: expected a term")
        return Is(variable.name, self.term(variable))

    def variable(self, valid: dict[str, Variable], wanted: str, other: dict[str, Variable], reason: str) -> Variable:
        """Read the name of one of the ``valid`` variables."""
        name = self.name(wanted, valid)
        if name in valid:
            self.advance()
            return valid[name]
        if name in other:
            raise self.error(f"'{name}' is an {reason}: {', '.join(valid)}")
        raise self.error(f"unknown variable {expected(shown(name), valid)}")

    def term(self, variable: Variable) -> str:
        """Read the name of a term of ``variable``."""
        names = [term.name for term in variable.terms]
        name = self.name(f"a term of '{variable.name}'", names)
        if name not in names:
            raise self.error(f"unknown term of '{variable.name}': {expected(shown(name), names)}")
        self.advance()
        return name

    def name(self, wanted: str, valid: Iterable[str]) -> str:
        """Return the name that the current word is."""
        if self.word.startswith('"'):
            return self.word[1:-1].replace('""', '"')
        if self.is_keyword and self.word in valid:
            raise self.error(f"the name '{self.word}' is a keyword too: write it in double quotes")
        if not self.word or self.is_keyword or self.word in "(),":
            raise self.unexpected(wanted)
        return self.word

    def weight(self) -> float:
        """Read a rule weight."""
        if not _WEIGHT.fullmatch(self.word) or not 0 <= float(self.word) <= 1:
            raise self.unexpected("a weight from 0 to 1")
        weight = float(self.word)
        self.advance()
        return weight
