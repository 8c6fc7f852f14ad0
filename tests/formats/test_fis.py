"""MATLAB's, Octave's and fuzzylite's .fis: the traps of the format."""

from __future__ import annotations

import math
import re

import pytest

from fuzzy import formats
from fuzzy.errors import FormatError
from fuzzy.shapes import (
    Bell,
    Gaussian,
    Gaussian2,
    Linear,
    PiShape,
    Points,
    Ramp,
    Rectangle,
    Sigmoid,
    SigmoidDifference,
    SigmoidProduct,
    Singleton,
    Spike,
    SShape,
    Trapezoid,
    Triangle,
    ZShape,
)
from fuzzy.system import And, FuzzySystem, Hedged, Is, NoFire, Not, Or, Rule, Sampling

TEXT = """% a comment
[System]
Name = 'oil heater'
Type='mamdani'
NumInputs=2
NumOutputs=1
NumRules=2
AndMethod='prod'
OrMethod='probor'
ImpMethod='min'
AggMethod='sum'
DefuzzMethod='centroid'

[Input1]
Name='room temperature'
Range=[-10 10]
NumMFs=2
MF1='it''s cold':'trimf',[-10 -10 0 7]
MF2='hot':'trapmf',[0 10 Inf Inf]

[Input2]
Name='rate-of-change'
Range = [ -1,1 ]
NumMFs=2
MF1='falling':'gaussmf',[0.5 -1]
MF2='rising':'sigmf',[4 0]

[Output1]
Name='power'
Range=[0 100]
NumMFs=2
MF1='low':'zmf',[0 50]
MF2='high':'smf',[50 100]

[Rules]
1 -2, 2 (1) : 1
2 0, -1 (0.5) : 2"""


def read(text: str) -> FuzzySystem:
    return formats.loads(text, "x.fis")


def refused(text: str) -> FormatError:
    with pytest.raises(FormatError) as caught:
        read(text)
    return caught.value


def test_the_whole_file() -> None:
    imported = formats.from_bytes(TEXT.encode(), "x.fis")
    system = imported.system
    assert system.name == "oil heater"
    first, second = system.inputs
    assert (first.name, first.low, first.high) == ("room temperature", -10, 10)
    assert [term.shape for term in first.terms] == [Triangle(-10, -10, 0), Trapezoid(0, 10, 10, math.inf)]
    assert [term.shape for term in second.terms] == [Gaussian(-1, 0.5), Sigmoid(0, 4)]
    assert [term.name for term in system.outputs[0].terms] == ["low", "high", "not low"]
    assert [term.complement for term in system.outputs[0].terms] == [False, False, True]
    assert system.outputs[0].no_fire == NoFire("midpoint")
    inference = system.inference
    assert (inference.conjunction, inference.disjunction) == ("product", "algebraic_sum")
    assert (inference.implication, inference.aggregation, inference.defuzzifier) == ("min", "sum", "centroid")
    assert inference.resolution == Sampling(101, "endpoints")
    assert system.rules.list == (
        Rule(
            And((Is("room temperature", "it''s cold"), Not(Is("rate-of-change", "rising")))),
            (Is("power", "high"),),
            1.0,
        ),
        Rule(Is("room temperature", "hot"), (Is("power", "not low"),), 0.5),
    )
    assert [remark.message for remark in imported.remarks] == ["trimf has 3 parameters: the rest (7) is left out"]
    assert imported.remarks[0].line == 18


@pytest.mark.parametrize(
    ("written", "shape"),
    [
        ("'trapmf',[-Inf -Inf 1 2]", Trapezoid(-math.inf, 1, 1, 2)),
        ("'gauss2mf',[1 -2 3 4]", Gaussian2(-2, 1, 4, 3)),
        ("'gbellmf',[2 3 1]", Bell(1, 2, 3)),
        ("'dsigmf',[5 1 6 2]", SigmoidDifference(1, 5, 2, 6)),
        ("'psigmf',[5 1 -6 2]", SigmoidProduct(1, 5, 2, -6)),
        ("'smf',[0 1]", SShape(0, 1)),
        ("'zmf',[0 1]", ZShape(0, 1)),
        ("'pimf',[0 1 2 3]", PiShape(0, 1, 2, 3)),
        ("'linsmf',[0 1]", Ramp(0, 1)),
        ("'linzmf',[0 1]", Ramp(1, 0)),
        ("'rectmf',[0 1]", Rectangle(0, 1)),
        ("'binarymf',[0 inf]", Rectangle(0, math.inf)),
        ("'spikemf',[0 2]", Spike(0, 2)),
        ("'discretemf',[0 0 1 1 2 0]", Points(((0, 0), (1, 1), (2, 0)))),
        ("'TRIMF',[ -1e0, .5 ; 1. ]", Triangle(-1, 0.5, 1)),
    ],
)
def test_every_shape(written: str, shape: object) -> None:
    assert read(TEXT.replace("'gaussmf',[0.5 -1]", written)).inputs[1].terms[0].shape == shape


@pytest.mark.parametrize(
    ("code", "hedges"),
    [("1.05", ["somewhat"]), ("1.2", ["very"]), ("1.20", ["very"]), ("1.3", ["extremely"]), ("1.4", ["very", "very"])],
)
def test_hedges_are_fractions(code: str, hedges: list[str]) -> None:
    rule = read(TEXT.replace("1 -2, 2", f"{code} 0, 2")).rules.list[0]
    expression = rule.antecedent
    for hedge in reversed(hedges):
        assert isinstance(expression, Hedged)
        assert expression.hedge == hedge
        expression = expression.operand
    assert isinstance(expression, Is)


def test_or_and_fuzzylites_own_words() -> None:
    text = TEXT.replace("1 -2, 2 (1) : 1", "1.3 2, 2 (1) : 2")
    rule = read("# written by fuzzylite\n" + text).rules.list[0]
    assert rule.antecedent == Or(
        (Hedged(Is("room temperature", "it''s cold"), "intensify"), Is("rate-of-change", "rising"))
    )
    system = read("# written by fuzzylite\n" + text.replace("[Output1]", "[Output1]\nDefault=40\nLockPrevious=0"))
    assert system.outputs[0].no_fire == NoFire("default", 40)
    assert system.inference.resolution == Sampling(1000, "midpoints")


def test_sugeno() -> None:
    text = TEXT.replace("'mamdani'", "'sugeno'").replace("'centroid'", "'wtaver'").replace("-1 (0.5)", "1 (0.5)")
    text = text.replace("'zmf',[0 50]", "'constant',[7]").replace("'smf',[50 100]", "'linear',[1 2 3]")
    system = read(text)
    assert system.inference.defuzzifier == "weighted_average"
    assert [term.shape for term in system.outputs[0].terms] == [Singleton(7), Linear((1, 2), 3)]


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("[System]", "[Interface]\nNinputs=2", "FisPro", 3),
        ("NumMFs=2\nMF1='it", "NumMFs=3\nMF1='it", "NumMFs=3, but the file has 2 membership functions", 17),
        ("NumRules=2", "NumRules=7", "NumRules=7, but the file has 2 rules", 7),
        ("NumInputs=2", "NumInputs=1", "NumInputs=1, but the file has 2 input sections", 5),
        ("[Input2]", "[Input3]", r"expected \[Input2\], found \[Input3\]", 21),
        ("'gaussmf'", "'mymf'", "unknown membership function 'mymf'", 25),
        ("[0.5 -1]", "[0.5]", "gaussmf has 2 parameters", 25),
        ("[0.5 -1]", "[0.5 x]", "expected a number, found 'x'", 25),
        ("[0.5 -1]", "[0.5 NaN]", "expected a number, found 'NaN'", 25),
        ("[0.5 -1]", "[0.5 1e999]", "must be finite", 25),
        ("'prod'", "'my_and'", "unknown operator 'my_and'", 8),
        ("DefuzzMethod='centroid'", "DefuzzMethod='wtaver'", "does not go with a mamdani system", 12),
        ("1 -2, 2", "1 -3, 2", "has no term 3; valid: 0 to 2", 36),
        ("1 -2, 2", "1, 2", "1 terms for the 2 inputs", 36),
        ("1 -2, 2", "1.7 -2, 2", "unknown hedge '.7'", 36),
        ("1 -2, 2", "0 0, 2", "asks for no input", 36),
        ("1 -2, 2", "1 2, 0", "concludes on no output", 36),
        ("(1) : 1", "(1.5) : 1", "expected a weight from 0 to 1", 36),
        ("(1) : 1", "(1) : 3", r"expected 1 \(and\) or 2 \(or\)", 36),
        ("1 -2, 2 (1) : 1", "1 -2 2 (1)", "expected a rule", 36),
        ("Range=[-10 10]", "Range=[10 -10]", "low < high", 16),
        ("Range=[-10 10]", "Range=[-10 10 3]", "expected a range", 16),
        ("Name='rate-of-change'", "Name='room temperature'", "a variable called 'room temperature' stands twice", 22),
        ("MF2='hot'", "MF2='it''s cold'", "stands twice", 19),
        ("[Rules]", "[Exceptions]", "FisPro", 35),
        ("Type='mamdani'", "Type='mamdanitype2'", "unknown type 'mamdanitype2'", 4),
        ("Type='mamdani'", "Type='mamdani'\nTypeReductionMethod='km'", "type-2", 5),
        ("NumInputs=2", "NumInputs=2\nNumInputs=2", "stands twice", 6),
        ("[Output1]", "[Output1]\nEnabled=0", "is disabled", 28),
        (TEXT, "", "the file is empty", 1),
        (TEXT, "[System]\n", r"\[Input1\] is missing", 2),
    ],
)
def test_mistakes_are_named_where_they_stand(old: str, new: str, message: str, line: int) -> None:
    assert old in TEXT
    error = refused(TEXT.replace(old, new, 1))
    assert error.line == line, str(error)
    assert re.search(message, error.message), error.message


def test_a_latin_1_file_is_read() -> None:
    text = TEXT.replace("power", "größe")
    assert formats.from_bytes(text.encode("latin-1"), "x.fis").system.outputs[0].name == "größe"
    assert formats.from_bytes(text.encode("utf-16"), "x.fis").system.outputs[0].name == "größe"


def test_unknown_lines_are_remarked() -> None:
    imported = formats.from_bytes(TEXT.replace("[Input1]", "[Input1]\nColour='red'").encode(), "x.fis")
    assert imported.remarks[0].message == "'Colour' in [Input1] is not known and left out"
