"""fuzzylite's .fll: the traps of the format."""

from __future__ import annotations

import math
import re

import pytest

from fuzzy import formats
from fuzzy.errors import FormatError
from fuzzy.shapes import (
    Concave,
    Gaussian2,
    Linear,
    Points,
    Rectangle,
    SigmoidDifference,
    SigmoidProduct,
    Singleton,
    Triangle,
)
from fuzzy.system import And, FuzzySystem, Hedged, Is, NoFire, Not, Or, Sampling

TEXT = """# a comment
Engine: heater
  description: anything
InputVariable: temperature
  enabled: true
  range: -10.000 10.000
  lock-range: false
  term: cold Triangle -inf -10 0
  term: hot Trapezoid 0 10 inf inf 0.500
InputVariable: rate
  range: -1 1
  term: falling Discrete -1 1 0 0 0.25
  term: rising Ramp 0 1   # a comment at the end
OutputVariable: power
  enabled: true
  range: 0 100
  lock-range: false
  aggregation: Maximum
  defuzzifier: Centroid 200
  default: nan
  lock-previous: false
  term: low Rectangle 0 50
  term: high SShape 50 100
RuleBlock:
  enabled: true
  conjunction: Minimum
  disjunction: none
  implication: AlgebraicProduct
  activation: General
  rule: if temperature is cold and rate is not very falling then power is high
  rule: if temperature is any and (rate is extremely somewhat rising) then power is low with 0.25
"""


def read(text: str) -> FuzzySystem:
    return formats.loads(text, "x.fll")


def test_the_whole_file() -> None:
    system = read(TEXT)
    cold, hot = system.inputs[0].terms
    assert cold.shape == Triangle(-math.inf, -10, 0)
    assert (hot.height, hot.shape.d) == (0.5, math.inf)  # type: ignore[union-attr]
    falling = system.inputs[1].terms[0]
    assert (falling.shape, falling.height) == (Points(((-1, 1), (0, 0))), 0.25)
    inference = system.inference
    assert inference.resolution == Sampling(200, "midpoints")
    assert (inference.conjunction, inference.implication, inference.aggregation) == ("min", "product", "max")
    assert system.outputs[0].no_fire == NoFire("nan")
    first, second = system.rules.list
    assert first.antecedent == And((Is("temperature", "cold"), Not(Hedged(Is("rate", "falling"), "very"))))
    rising = Hedged(Hedged(Is("rate", "rising"), "somewhat"), "intensify")
    assert second.antecedent == And((Hedged(Is("temperature", "cold"), "any"), rising))
    assert second.weight == 0.25


@pytest.mark.parametrize(
    ("written", "shape"),
    [
        ("GaussianProduct 0 1 2 3", Gaussian2(0, 1, 2, 3)),
        ("SigmoidDifference 0 1 2 3", SigmoidDifference(0, 1, 3, 2)),
        ("SigmoidProduct 0 1 -2 3", SigmoidProduct(0, 1, 3, -2)),
        ("Binary 0 inf", Rectangle(0, math.inf)),
        ("Binary 0 -inf", Rectangle(-math.inf, 0)),
        ("Concave 0 1", Concave(0, 1)),
    ],
)
def test_parameters_in_fuzzylites_order(written: str, shape: object) -> None:
    assert read(TEXT.replace("Ramp 0 1", written)).inputs[1].terms[1].shape == shape


def test_and_binds_tighter_than_or() -> None:
    text = TEXT.replace("disjunction: none", "disjunction: Maximum")
    text = text.replace("temperature is cold and rate", "temperature is hot or temperature is cold and rate")
    expression = read(text).rules.list[0].antecedent
    assert isinstance(expression, Or)
    assert expression.operands[0] == Is("temperature", "hot")


def test_rules_may_ask_for_outputs() -> None:
    text = TEXT.replace("temperature is any and", "power is high and")
    assert Is("power", "high") in read(text).rules.list[1].antecedent.operands  # type: ignore[union-attr]


def test_takagi_sugeno() -> None:
    text = TEXT.replace("Centroid 200", "WeightedAverage TakagiSugeno").replace(
        "aggregation: Maximum", "aggregation: none"
    )
    text = text.replace("Rectangle 0 50", "Constant 7").replace("SShape 50 100", "Linear 1 2 3")
    system = read(text)
    assert [term.shape for term in system.outputs[0].terms] == [Singleton(7), Linear((1, 2), 3)]
    assert (system.inference.defuzzifier, system.inference.aggregation) == ("weighted_average", "sum")


def test_the_words_of_fuzzylite_5() -> None:
    text = TEXT.replace("  implication: AlgebraicProduct\n  activation: General", "  activation: AlgebraicProduct")
    assert read(text.replace("aggregation:", "accumulation:")) == read(TEXT)


def test_rule_blocks_join_where_they_agree() -> None:
    block = TEXT[TEXT.index("RuleBlock:") :]
    assert len(read(TEXT + block).rules.list) == 4
    with pytest.raises(FormatError, match="a system has one for all"):
        read(TEXT + block.replace("implication: AlgebraicProduct", "implication: Minimum"))
    assert len(read(TEXT + block.replace("enabled: true", "enabled: false")).rules.list) == 2


OUTPUT = TEXT[TEXT.index("OutputVariable") : TEXT.index("RuleBlock")]


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        (
            "Engine: heater\n  description: anything\n",
            "",
            "expected 'Engine:' first and once, found 'InputVariable:'",
            2,
        ),
        ("range: -1 1", "range: -1", "expected a range of two finite numbers", 11),
        ("range: -1 1", "range: nan 1", "expected a range of two finite numbers", 11),
        ("Ramp 0 1", "Ramp 0", "Ramp has 2 parameters", 13),
        ("Ramp 0 1", "Slope 0 1", "unknown term 'Slope'", 13),
        ("Ramp 0 1", "Function x^2", "'Function' has no shape", 13),
        ("Ramp 0 1", "Ramp 0 0", "start and end must differ", 13),
        ("term: rising", "term: falling", "stands twice", 13),
        ("InputVariable: rate", "InputVariable: temperature", "stands twice", 10),
        ("aggregation: Maximum", "aggregation: Maximal", "unknown aggregation 'Maximal'; did you mean 'Maximum'", 18),
        ("Centroid 200", "Centroid 0", "expected a resolution", 19),
        ("Centroid 200", "CentreOfMass", "unknown defuzzifier", 19),
        ("activation: General", "activation: Threshold > 0.5", "activation 'Threshold > 0.5' has no word", 29),
        ("enabled: true", "enabled: false", "is not enabled", 5),
        ("lock-previous", "lock-prev", "unknown key 'lock-prev'", 21),
        ("temperature is any and", "temperature is any or", "uses dis rules but has no disjunction", 27),
        ("not very falling", "not rather falling", "unknown term of 'rate': 'rather'", 30),
        ("power is high", "power is very high", "'very' in a conclusion", 30),
        ("power is high", "rate is rising", "'rate' is an input", 30),
        ("power is high", "", "expected an output, found the end of the rule", 30),
        ("with 0.25", "with 2", "expected a weight from 0 to 1, found '2'", 31),
        ("(rate", "rate", r"found '\)'", 31),
        (OUTPUT, "", "'OutputVariable:' is missing", 22),
        (OUTPUT, OUTPUT + OUTPUT.replace("power", "p").replace("Centroid", "Bisector"), "a system has one for all", 29),
    ],
)
def test_mistakes_are_named_where_they_stand(old: str, new: str, message: str, line: int) -> None:
    assert old in TEXT
    with pytest.raises(FormatError) as caught:
        read(TEXT.replace(old, new, 1))
    assert re.search(message, caught.value.message), caught.value.message
    assert caught.value.line == line, str(caught.value)


@pytest.mark.parametrize("key", ["range", "enabled", "aggregation", "defuzzifier", "default", "term", "rule"])
def test_a_key_without_a_value_is_refused_where_it_stands(key: str) -> None:
    text = re.sub(rf"^( *{key}:).*$", r"\1", TEXT, count=1, flags=re.M)
    assert text != TEXT
    with pytest.raises(FormatError) as caught:
        read(text)
    assert caught.value.line == text[: text.index(f"{key}:\n")].count("\n") + 1
