"""IEC 61131-7 .fcl: the standard, jFuzzyLogic's and fuzzylite's dialects."""

from __future__ import annotations

import math
import re

import pytest

from fuzzy import compile_system, formats
from fuzzy.errors import FormatError
from fuzzy.shapes import Bell, Cosine, Gaussian, Points, Sigmoid, Singleton, Trapezoid, Triangle
from fuzzy.system import And, FuzzySystem, Is, NoFire, Not, Or, Sampling

TEXT = """(* the standard *)
FUNCTION_BLOCK heater
VAR_INPUT
  temp : REAL; rate:REAL;
END_VAR
VAR_OUTPUT power : REAL; END_VAR
FUZZIFY temp
  TERM cold := (-10, 1) (0, 0);
  TERM fine := (-10,0)(0,1)(10,0);
  TERM hot:=(0,0)(5,0.5)(10,1);
END_FUZZIFY
FUZZIFY rate
  TERM low := (-1,1)(0,1)(1,0);
  RANGE := (-1..1);
END_FUZZIFY
DEFUZZIFY power
  RANGE := (0 .. 100);
  TERM low := (0,0) (25,1) (50,0);
  TERM high := (50,0) (75,1) (100,0);
  METHOD : COG;
  ACCU : MAX;
  DEFAULT := NC;
END_DEFUZZIFY
RULEBLOCK No1
  and : PROD;
  RULE first : if temp is cold or temp is fine AND rate IS NOT low THEN power IS high WITH 0.8;
  RULE 2 : IF NOT (temp IS hot) AND NOT rate IS low THEN power IS low;
END_RULEBLOCK
END_FUNCTION_BLOCK
"""


def read(text: str) -> FuzzySystem:
    return formats.loads(text, "x.fcl")


def test_the_standard() -> None:
    imported = formats.from_bytes(TEXT.encode(), "x.fcl")
    system = imported.system
    assert [term.shape for term in system.inputs[0].terms] == [
        Triangle(-math.inf, -10, 0),
        Triangle(-10, 0, 10),
        Points(((0, 0), (5, 0.5), (10, 1))),
    ]
    assert system.inputs[1].terms[0].shape == Trapezoid(-math.inf, -1, 0, 1)
    assert (system.inputs[0].low, system.inputs[0].high) == (-10, 10)
    assert [remark.message for remark in imported.remarks] == [
        "'temp' has no RANGE: it is the span of the terms, -10 to 10"
    ]
    assert system.outputs[0].no_fire == NoFire("hold")
    inference = system.inference
    assert (inference.conjunction, inference.disjunction, inference.implication) == ("product", "algebraic_sum", "min")
    assert inference.resolution == Sampling(1000, "left")
    first, second = system.rules.list
    tight = And((Is("temp", "fine"), Not(Is("rate", "low"))))
    assert first.antecedent == Or((Is("temp", "cold"), tight))
    assert first.weight == 0.8
    assert second.antecedent == And((Not(Is("temp", "hot")), Not(Is("rate", "low"))))


def test_jfuzzylogic_reads_and_and_or_from_left_to_right() -> None:
    antecedent = read("// jFuzzyLogic's comment\n" + TEXT).rules.list[0].antecedent
    assert antecedent == And((Or((Is("temp", "cold"), Is("temp", "fine"))), Not(Is("rate", "low"))))


@pytest.mark.parametrize(
    ("written", "shape"),
    [
        ("TRIAN -1 0 1", Triangle(-1, 0, 1)),
        ("trape -1 -1 0 1", Trapezoid(-1, -1, 0, 1)),
        ("GAUSS 0 1", Gaussian(0, 1)),
        ("GBELL 2 3 1", Bell(1, 2, 3)),
        ("SIGM 4 0.5", Sigmoid(0.5, 4)),
        ("COSINE 2 0", Cosine(0, 4)),
        ("Gaussian 0 1", Gaussian(0, 1)),
        ("Bell 1 2 3", Bell(1, 2, 3)),
        ("0.5", Singleton(0.5)),
        ("SINGLETONS (0.5, 1)", Singleton(0.5)),
    ],
)
def test_every_dialects_terms(written: str, shape: object) -> None:
    assert read(TEXT.replace("(-1,1)(0,1)(1,0)", written)).inputs[1].terms[0].shape == shape


def test_fuzzylites_dialect() -> None:
    text = "//Code automatically generated with fuzzylite 6.0.\n" + TEXT.replace("NC;", "nan;")
    text = text.replace("low THEN power IS high WITH 0.8;", "very low then power is high\n")
    system = read(text.replace("DEFUZZIFY power", "DEFUZZIFY power\n  ENABLED : TRUE;"))
    assert system.inference.resolution == Sampling(1000, "midpoints")
    assert system.outputs[0].no_fire == NoFire("nan")


def test_singletons_and_other_methods() -> None:
    text = TEXT.replace("(0,0) (25,1) (50,0)", "25").replace("(50,0) (75,1) (100,0)", "75")
    system = read(text.replace("COG", "COGS"))
    assert (system.inference.defuzzifier, system.inference.aggregation) == ("weighted_average", "max")
    for word, meaning in {"COA": "bisector", "LM": "som", "RM": "lom", "MM": "mom"}.items():
        assert read(TEXT.replace("COG", word)).inference.defuzzifier == meaning


def test_the_sum_is_normalized_by_the_standard_and_limited_by_jfuzzylogic() -> None:
    text = TEXT.replace("ACCU : MAX", "ACCU : NSUM")
    assert read(text).inference.aggregation == "sum"
    assert read(text.replace("(* the standard *)", "/* */")).inference.aggregation == "bounded_sum"


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("END_FUNCTION_BLOCK", "", "found the end of the file", 30),
        ("END_FUNCTION_BLOCK\n", "END_FUNCTION_BLOCK FUNCTION_BLOCK b", r"a second FUNCTION_BLOCK \('b'\)", 29),
        ("(-10, 1)", "(-10, level)", "found the name 'level': variables inside membership functions", 8),
        ("(-10, 1) (0, 0)", "FUNCTION 3*x", "FUNCTION cannot be said", 8),
        ("(-10, 1) (0, 0)", "TRIANGEL 1 2 3", "unknown membership function 'TRIANGEL'", 8),
        ("(-10, 1) (0, 0)", "(0, 1) (-10, 0)", "not in order", 8),
        ("(-10, 1) (0, 0)", "(-10, 2) (0, 0)", "a degree lies outside 0 to 1", 8),
        ("TERM hot", "TERM cold", "the term 'cold' stands twice", 10),
        ("FUZZIFY rate", "FUZZIFY speed", "'speed' is not declared in VAR_INPUT", 12),
        ("rate:REAL", "temp:REAL", "the variable 'temp' stands twice", 4),
        ("METHOD : COG;", "", "'power' has no METHOD", 6),
        ("METHOD : COG", "METHOD : MEAN", "METHOD: unknown operator 'MEAN'", 20),
        ("METHOD : COG", "METHOD : COGS", "is no singleton", 20),
        ("and : PROD", "and : POWER", "AND: unknown operator 'POWER'", 25),
        ("temp is cold", "temp is icy", "unknown term of 'temp': 'icy'", 26),
        ("temp is cold", "power is high", "is an output", 26),
        ("WITH 0.8", "WITH 8", "expected a weight from 0 to 1, found '8'", 26),
        ("VAR_INPUT", "VAR", "VAR cannot be said", 3),
        ("(* the standard *)", "(* the standard", "this comment does not end", 1),
        ("RANGE := (0 .. 100)", "RANGE := (100 .. 0)", "low < high", 17),
        ("rate:REAL;", "rate:BOOL;", "expected 'REAL'|expected REAL, found 'BOOL'", 4),
        ("rate IS NOT", "rate ? NOT", r"unexpected character '\?'", 26),
    ],
)
def test_mistakes_are_named_where_they_stand(old: str, new: str, message: str, line: int) -> None:
    assert old in TEXT
    with pytest.raises(FormatError) as caught:
        read(TEXT.replace(old, new, 1))
    assert re.search(message, caught.value.message), caught.value.message
    assert caught.value.line == line, str(caught.value)


def test_a_default_may_lie_outside_the_range() -> None:
    """As in the standard, in jFuzzyLogic and in fuzzylite: it is no place in the universe of the sets."""
    text = TEXT.replace("DEFAULT := NC", "DEFAULT := -7.5").replace("  RULE 2", "  // RULE 2")
    system = read(text.replace("temp is cold or temp is fine AND rate IS NOT low", "temp is cold"))
    assert (system.outputs[0].low, system.outputs[0].high) == (0, 100)
    assert compile_system(system)(10.0, 0.0) == -7.5
    again = formats.loads(formats.write(system, "fcl").text, "x.fcl")
    assert again.outputs[0].no_fire == NoFire("default", -7.5)
