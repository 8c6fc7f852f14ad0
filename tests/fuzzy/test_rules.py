"""Rule text: what is written is read again, precedence, and errors that point at the word."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzy.errors import FormatError
from fuzzy.language import format_rule, parse_rule
from fuzzy.rules import MAX_DEPTH, MAX_PROPOSITIONS, all_rules, depth, table_rule_indices
from fuzzy.shapes import Triangle
from fuzzy.system import And, FuzzySystem, Hedged, Input, Is, Not, Or, Output, Rule, RuleBase, Term
from tests import strategies

ANY = Triangle(-1, 0, 1)


def _system() -> FuzzySystem:
    def terms(names: str) -> tuple[Term, ...]:
        return tuple(Term(name, ANY) for name in names.split("|"))

    inputs = (
        Input("e", -1, 1, terms("NB|Z|PB|very big|and")),
        Input("de", -1, 1, terms("FL|Z|FR")),
        Input("oil level", -1, 1, terms('low|say "hi"')),
    )
    outputs = (Output("T", -1, 1, terms("LL|Z|LR")), Output("U", -1, 1, terms("off|on")))
    return FuzzySystem("s", inputs, outputs)


SYSTEM = _system()
NB, FL, PB = Is("e", "NB"), Is("de", "FL"), Is("e", "PB")
LL = (Is("T", "LL"),)


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("if e is NB then T is LL", Rule(NB, LL)),
        ("IF e Is NB\n AND de iS FL Then T is LL WITH .5", Rule(And((NB, FL)), LL, 0.5)),
        ("if e is NB or e is PB and de is FL then T is LL", Rule(Or((NB, And((PB, FL)))), LL)),
        ("if (e is NB or e is PB) and de is FL then T is LL", Rule(And((Or((NB, PB)), FL)), LL)),
        ("if not e is NB and de is FL then T is LL", Rule(And((Not(NB), FL)), LL)),
        ("if not (e is NB and de is FL) then T is LL", Rule(Not(And((NB, FL))), LL)),
        ("if e is not NB then T is LL", Rule(Not(NB), LL)),
        ("if not (e is NB) then T is LL", Rule(Not(NB), LL)),
        ("if not e is not NB then T is LL", Rule(Not(Not(NB)), LL)),
        ("if ((e is NB)) then T is LL", Rule(NB, LL)),
        ("if (e is NB and de is FL) and e is PB then T is LL", Rule(And((And((NB, FL)), PB)), LL)),
        ('if "oil level" is "say ""hi""" then T is LL', Rule(Is("oil level", 'say "hi"'), LL)),
        ("if e is very NB then T is LL", Rule(Hedged(Is("e", "NB"), "very"), LL)),
        ("if e is not VERY NB then T is LL", Rule(Not(Hedged(Is("e", "NB"), "very")), LL)),
        ("if e is very not NB then T is LL", Rule(Hedged(Not(Is("e", "NB")), "very"), LL)),
        (
            "if any (e is Z or somewhat e is NB) then T is LL",
            Rule(Hedged(Or((Is("e", "Z"), Hedged(Is("e", "NB"), "somewhat"))), "any"), LL),
        ),
        ("if T is LL and e is NB then T is LL", Rule(And((Is("T", "LL"), Is("e", "NB"))), LL)),
        ('if e is "very big" or e is "and" then T is LL', Rule(Or((Is("e", "very big"), Is("e", "and"))), LL)),
        ("if e is NB then T is LL, U is on with 1e-1", Rule(NB, (Is("T", "LL"), Is("U", "on")), 0.1)),
    ],
)
def test_reads_what_is_meant(text, rule):
    assert parse_rule(text, SYSTEM) == rule


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("", 1, "expected 'if', found the end of the rule"),
        ("when e is NB", 1, "expected 'if', found 'when'"),
        ("if then T is LL", 4, "expected an input, 'not', a hedge or '(', found 'then'"),
        ("if e NB then T is LL", 6, "expected 'is', found 'NB'"),
        ("if e is NB T is LL", 12, "expected 'then', 'and' or 'or', found 'T'"),
        ("if e is NB then T is LL e", 25, "expected ',', 'with' or the end of the rule, found 'e'"),
        ("if x is NB then T is LL", 4, "unknown variable 'x'; valid: e, de, oil level"),
        ("if d is FL then T is LL", 4, "unknown variable 'd'; did you mean 'de'? valid: e, de, oil level"),
        ("if e is NB then e is LL", 17, "'e' is an input, a consequent names outputs: T, U"),
        ("if de is FX then T is LL", 10, "unknown term of 'de': 'FX'; valid: FL, Z, FR"),
        ("if e is nb then T is LL", 9, "unknown term of 'e': 'nb'; did you mean 'NB'? valid: NB, Z, PB, very big, and"),
        ("if e is and then T is LL", 9, "the name 'and' is a keyword too: write it in double quotes"),
        ("if e is very big then T is LL", 14, "unknown term of 'e': 'big'"),
        ("if (e is NB then T is LL", 13, "expected ')', 'and' or 'or', found 'then'"),
        ("if e is NB) then T is LL", 11, "expected 'then', 'and' or 'or', found ')'"),
        ("if e is NB then T is not LL", 22, "a consequent cannot be negated: expected a term"),
        ("if e is NB then T is LL,", 25, "expected an output, found the end of the rule"),
        ("if e is NB then T is LL with 1.5", 30, "expected a weight from 0 to 1, found '1.5'"),
        ("if e is NB then T is LL with nan", 30, "expected a weight from 0 to 1, found 'nan'"),
        ("if e is NB then T is LL with", 29, "expected a weight from 0 to 1, found the end of the rule"),
        ('if e is "NB then T is LL', 9, "this name in double quotes does not end: expected '\"'"),
        ("if e is e=1\x00 then", 9, "unknown term of 'e': 'e=1?'; valid: NB"),
    ],
)
def test_an_error_names_the_column_the_word_and_what_is_valid(text, column, message):
    with pytest.raises(FormatError) as caught:
        parse_rule(text, SYSTEM)
    assert caught.value.column == column
    assert caught.value.message.startswith(message)


@pytest.mark.parametrize(
    "antecedent",
    [
        "(" * 100_000,
        "not " * 100_000 + "e is NB",
        " and ".join(["e is NB"] * (MAX_PROPOSITIONS + 1)),
        "not (" * (MAX_DEPTH + 1) + "e is NB" + ")" * (MAX_DEPTH + 1),
    ],
    ids=["brackets", "negations", "propositions", "depth"],
)
def test_refuses_what_is_too_deep_or_too_long(antecedent):
    with pytest.raises(FormatError, match=r"more than|at most"):
        parse_rule(f"if {antecedent} then T is LL", SYSTEM)


def test_the_deepest_valid_rule_is_written_and_read():
    expression = NB
    for _ in range(MAX_DEPTH // 2):
        expression = Not(Or((expression, FL)))
    assert depth(expression) == MAX_DEPTH
    rule = Rule(expression, LL)
    assert parse_rule(format_rule(rule), SYSTEM) == rule


@given(st.data())
def test_reading_inverts_writing(data):
    system = data.draw(strategies.systems(name=strategies.names, max_rules=0))
    rule = data.draw(strategies.rules_of(system.inputs, system.outputs))
    text = format_rule(rule)
    assert parse_rule(text, system) == rule
    assert format_rule(parse_rule(text, system)) == text


_WORDS = 'if e is not NB ( ) and or then T LL , with 0.5 "and" " é 1e999 de FL U on'
_words = st.sampled_from(_WORDS.split())


@given(st.one_of(st.text(max_size=60), st.lists(_words, max_size=25).map(" ".join)))
def test_any_text_is_a_rule_or_a_located_error(text):
    column = 1
    try:
        rule = parse_rule(text, SYSTEM)
        assert parse_rule(format_rule(rule), SYSTEM) == rule
    except FormatError as error:
        column = error.column
    assert 1 <= column <= len(text) + 1


@given(strategies.systems())
@settings(max_examples=50)
def test_table_cells_and_numbers_agree(system):
    rules = all_rules(system)
    table = system.rules.table
    indices = table_rule_indices(system)
    cells = [] if table is None else [cell for row in table.cells for cell in row]
    numbers = [number for row in indices for number in row]
    assert [number >= 0 for number in numbers] == [cell is not None for cell in cells]
    assert [number for number in numbers if number >= 0] == list(range(len(rules) - len(system.rules.list)))
    for cell, number in zip(cells, numbers, strict=True):
        if table is not None and cell is not None:
            assert rules[number].consequents == (Is(table.output, cell),)
    assert rules[len(rules) - len(system.rules.list) :] == system.rules.list


def test_a_table_is_read_row_by_row():
    system = FuzzySystem(
        "s",
        SYSTEM.inputs,
        SYSTEM.outputs,
        RuleBase(
            strategies.RuleTable("de", "oil level", "T", (("LL", None), (None, "Z"), ("LR", "LL"))), (Rule(NB, LL),)
        ),
    )
    assert [format_rule(rule) for rule in all_rules(system)] == [
        'if de is FL and "oil level" is low then T is LL',
        'if de is Z and "oil level" is "say ""hi""" then T is Z',
        'if de is FR and "oil level" is low then T is LR',
        'if de is FR and "oil level" is "say ""hi""" then T is LL',
        "if e is NB then T is LL",
    ]
    assert table_rule_indices(system) == ((0, -1), (-1, 1), (2, 3))
