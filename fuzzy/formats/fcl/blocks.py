"""The blocks of an .fcl file as they stand there, before they become a system."""

from __future__ import annotations

from dataclasses import dataclass, field

from fuzzy.errors import FormatError, shown
from fuzzy.formats.assembly import Notes, unique
from fuzzy.formats.fcl.terms import read_term
from fuzzy.formats.fcl.tokens import Cursor
from fuzzy.formats.rule_text import Token
from fuzzy.limits import MAX_OUTPUT_TERMS, MAX_RULES, MAX_VARIABLES
from fuzzy.system import NoFire, Term

_TYPES = frozenset({"REAL", "LREAL", "INT", "DINT", "SINT", "LINT", "UINT"})
_OTHER_VARIABLES = ("VAR", "VAR_IN_OUT", "VAR_TEMP", "VAR_GLOBAL", "VAR_EXTERNAL")


@dataclass
class Declared:
    """A variable: its name, whether it is an input, and what its block says."""

    name: Token
    is_input: bool
    block: Token | None = None
    ends: tuple[float, float] | None = None
    range_offset: int = 0
    terms: list[Term] = field(default_factory=list)
    term_offsets: list[int] = field(default_factory=list)
    method: Token | None = None
    accumulation: Token | None = None
    no_fire: NoFire | None = None
    no_fire_offset: int = 0


@dataclass
class RuleBlock:
    """A block of rules: its operators, and the words of every rule behind ``RULE name :``."""

    name: str
    offset: int
    operators: dict[str, Token] = field(default_factory=dict)
    rules: list[tuple[list[Token], int]] = field(default_factory=list)


@dataclass
class FunctionBlock:
    """A function block: its variables and rules, and the dialects whose words it uses."""

    name: str
    variables: dict[str, Declared] = field(default_factory=dict)
    rule_blocks: list[RuleBlock] = field(default_factory=list)
    dialects: set[str] = field(default_factory=set)


def read_function_block(cursor: Cursor, notes: Notes) -> FunctionBlock:
    """Read the one function block of a file.

    Raises:
        FormatError: At the first word that is wrong, or at a second function block.
    """
    cursor.require("FUNCTION_BLOCK")
    block = FunctionBlock("")
    if cursor.text and not _is_keyword(cursor.word):
        block.name = cursor.name("a name").text
    while not cursor.accept("END_FUNCTION_BLOCK"):
        word = cursor.word
        if word in ("VAR_INPUT", "VAR_OUTPUT"):
            _declarations(cursor, block)
        elif word in ("FUZZIFY", "DEFUZZIFY"):
            _variable(cursor, block)
        elif word == "RULEBLOCK":
            block.rule_blocks.append(_rule_block(cursor))
        elif word == "OPTION":
            _option(cursor, notes)
        elif word in _OTHER_VARIABLES:
            raise cursor.source.error(
                f"{word} cannot be said in the workbench: it has inputs and outputs", cursor.offset
            )
        else:
            raise cursor.unexpected("VAR_INPUT, VAR_OUTPUT, FUZZIFY, DEFUZZIFY, RULEBLOCK or END_FUNCTION_BLOCK")
    if cursor.word == "FUNCTION_BLOCK":
        offset = cursor.offset
        cursor.take()
        message = f"a second FUNCTION_BLOCK ('{shown(cursor.text)}') begins here: a file of the workbench holds one"
        raise cursor.source.error(message, offset)
    if cursor.text:
        raise cursor.unexpected("the end of the file")
    return block


def _is_keyword(word: str) -> bool:
    return word in ("VAR_INPUT", "VAR_OUTPUT", "FUZZIFY", "DEFUZZIFY", "RULEBLOCK", "OPTION", "END_FUNCTION_BLOCK")


def _declarations(cursor: Cursor, block: FunctionBlock) -> None:
    is_input = cursor.take().text.upper() == "VAR_INPUT"
    while not cursor.accept("END_VAR"):
        name = cursor.name("a variable or END_VAR")
        unique(block.variables, name.text, "the variable", cursor.source, name.offset)
        cursor.require(":")
        if cursor.word not in _TYPES:
            raise cursor.unexpected("REAL")
        cursor.take()
        cursor.end()
        variable = Declared(name, is_input)
        if cursor.word == "RANGE":
            _range(cursor, variable)
        block.variables[name.text] = variable
        if len(block.variables) > 2 * MAX_VARIABLES:
            raise cursor.source.error(f"more than {MAX_VARIABLES} inputs and outputs", name.offset)


def _range(cursor: Cursor, variable: Declared) -> None:
    cursor.take()
    variable.range_offset = cursor.offset
    cursor.require(":=")
    cursor.require("(")
    low = cursor.number()
    cursor.require("..")
    variable.ends = low, cursor.number()
    cursor.require(")")
    cursor.end()


def _variable(cursor: Cursor, block: FunctionBlock) -> None:
    word = cursor.take()
    is_input = word.text.upper() == "FUZZIFY"
    end = f"END_{word.text.upper()}"
    name = cursor.name("a variable")
    variable = block.variables.get(name.text)
    if variable is None or variable.is_input != is_input:
        kind = "VAR_INPUT" if is_input else "VAR_OUTPUT"
        raise cursor.source.error(f"'{shown(name.text)}' is not declared in {kind}", name.offset)
    if variable.block is not None:
        raise cursor.source.error(f"'{shown(name.text)}' has a second {word.text}", word.offset)
    variable.block = word
    n_inputs = sum(entry.is_input for entry in block.variables.values())
    while not cursor.accept(end):
        _item(cursor, block, variable, n_inputs, end)


def _item(cursor: Cursor, block: FunctionBlock, variable: Declared, n_inputs: int, end: str) -> None:
    match cursor.word:
        case "TERM":
            _term(cursor, block, variable, n_inputs)
        case "RANGE":
            _once(cursor, variable.ends)
            _range(cursor, variable)
        case "METHOD" if not variable.is_input:
            _once(cursor, variable.method)
            variable.method = _operator(cursor)
        case "ACCU" if not variable.is_input:
            _once(cursor, variable.accumulation)
            variable.accumulation = _operator(cursor)
        case "DEFAULT" if not variable.is_input:
            _once(cursor, variable.no_fire)
            _default(cursor, variable)
        case "ENABLED" | "LOCK":
            _fuzzylite_item(cursor, block, variable)
        case _:
            more = "" if variable.is_input else "METHOD, ACCU, DEFAULT, "
            raise cursor.unexpected(f"TERM, RANGE, {more}or {end}")


def _once(cursor: Cursor, before: object) -> None:
    if before is not None:
        raise cursor.source.error(f"{cursor.word} stands twice", cursor.offset)


def _term(cursor: Cursor, block: FunctionBlock, variable: Declared, n_inputs: int) -> None:
    cursor.take()
    name = cursor.name("a term's name")
    unique([term.name for term in variable.terms], name.text, "the term", cursor.source, name.offset)
    cursor.require(":=")
    shape, height, dialect = read_term(cursor, n_inputs)
    cursor.end()
    variable.terms.append(Term(name.text, shape, height))
    variable.term_offsets.append(name.offset)
    if dialect:
        block.dialects.add(dialect)
    if len(variable.terms) > MAX_OUTPUT_TERMS:
        raise cursor.source.error(f"more than {MAX_OUTPUT_TERMS} terms", name.offset)


def _operator(cursor: Cursor) -> Token:
    cursor.take()
    cursor.require(":")
    operator = cursor.name("the name of an operator")
    cursor.end()
    return operator


def _default(cursor: Cursor, variable: Declared) -> None:
    cursor.take()
    cursor.require(":=")
    variable.no_fire_offset = cursor.offset
    if cursor.accept("NC"):
        variable.no_fire = NoFire("hold")
    else:
        value = cursor.number(may_be_nan=True)
        variable.no_fire = NoFire("nan") if value != value else NoFire("default", value)
        if cursor.accept("|"):
            cursor.require("NC")
    cursor.end()


def _fuzzylite_item(cursor: Cursor, block: FunctionBlock, variable: Declared) -> None:
    """Read fuzzylite's ``ENABLED : TRUE;`` and ``LOCK : PREVIOUS | RANGE;``."""
    block.dialects.add("fuzzylite")
    word = cursor.take()
    cursor.require(":")
    value = cursor.name("a word")
    if word.text.upper() == "ENABLED" and value.text.upper() == "FALSE":
        message = f"'{shown(variable.name.text)}' is not enabled, which has no word in the workbench"
        raise cursor.source.error(message, value.offset)
    if value.text.upper() == "PREVIOUS":
        variable.no_fire, variable.no_fire_offset = NoFire("hold"), value.offset
    while cursor.text and cursor.text != ";":
        cursor.take()
    cursor.end()


def _option(cursor: Cursor, notes: Notes) -> None:
    notes.remark("OPTION is left out", cursor.offset)
    while not cursor.accept("END_OPTION"):
        if not cursor.text:
            raise cursor.unexpected("END_OPTION")
        cursor.take()


def _rule_block(cursor: Cursor) -> RuleBlock:
    offset = cursor.take().offset
    block = RuleBlock("", offset)
    if cursor.text and not _is_rule_item(cursor):
        block.name = cursor.name("the name of the block").text
    while not cursor.accept("END_RULEBLOCK"):
        word = cursor.word
        if word == "RULE":
            block.rules.append(_rule(cursor))
            if len(block.rules) > MAX_RULES:
                raise cursor.source.error(f"more than {MAX_RULES} rules", cursor.offset)
        elif word in ("AND", "OR", "ACT", "ACCU", "ENABLED"):
            if word in block.operators:
                raise cursor.source.error(f"{word} stands twice", cursor.offset)
            block.operators[word] = _operator(cursor)
        else:
            raise cursor.unexpected("AND, OR, ACT, ACCU, RULE or END_RULEBLOCK")
    return block


def _is_rule_item(cursor: Cursor) -> bool:
    return cursor.word in ("RULE", "AND", "OR", "ACT", "ACCU", "END_RULEBLOCK")


def _rule(cursor: Cursor) -> tuple[list[Token], int]:
    """Return the words of a rule; fuzzylite ends it with its line."""
    cursor.take()
    name = cursor.take()
    if not name.text or name.text in ("(", ")", ":", ";", ","):
        raise _nameless(cursor, name)
    cursor.require(":")
    tokens: list[Token] = []
    while not cursor.accept(";"):
        if cursor.word in ("RULE", "END_RULEBLOCK"):
            break
        if not cursor.text:
            raise cursor.unexpected("';' at the end of the rule")
        tokens.append(cursor.take())
    end = tokens[-1].offset + len(tokens[-1].text) if tokens else cursor.offset
    return tokens, end


def _nameless(cursor: Cursor, name: Token) -> FormatError:
    return cursor.source.error(f"expected a rule's name, found '{shown(name.text)}'", name.offset)
