"""Every format says what it can, exactly; names what it cannot; and substitutes only when asked to."""

from __future__ import annotations

import contextlib
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy import compile_system, formats
from fuzzy.errors import InvalidSystemError
from fuzzy.formats.detection import FORMATS, Format
from fuzzy.formats.difference import difference
from fuzzy.sets import is_linear
from fuzzy.shapes import (
    Concave,
    Gaussian,
    Gaussian2,
    Linear,
    Points,
    Ramp,
    Rectangle,
    Sigmoid,
    Singleton,
    SShape,
    Trapezoid,
    Triangle,
    ZShape,
)
from fuzzy.shapes import kind as kind_of
from fuzzy.system import (
    And,
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
    RuleBase,
    Sampling,
    Term,
)
from fuzzy.validation import validate
from tests.formats.sayable import sayable

OTHERS: list[Format] = [kind for kind in FORMATS if kind != "yaml"]

WEIGHTED = Inference(aggregation="sum", defuzzifier="weighted_average")


def outputs(system: FuzzySystem, seed: int = 0) -> np.ndarray:
    random = np.random.default_rng(seed)
    rows = np.column_stack([random.uniform(entry.low, entry.high, 40) for entry in system.inputs])
    return compile_system(system).batch(rows)


def plain(system: FuzzySystem) -> FuzzySystem:
    """Return a system that says the middle of the range as a number, as most formats do."""
    outputs = tuple(
        replace(entry, no_fire=NoFire("default", 0.5 * (entry.low + entry.high)))
        if entry.no_fire.policy == "midpoint"
        else entry
        for entry in system.outputs
    )
    return replace(system, outputs=outputs)


def written(system: FuzzySystem, kind: Format, *, lossy: bool = False) -> FuzzySystem:
    return formats.loads(formats.write(system, kind, lossy=lossy).text, f"x.{kind}")


@pytest.mark.parametrize("kind", OTHERS)
@settings(max_examples=30)
@given(data=st.data())
def test_what_a_format_can_say_comes_back_with_the_same_outputs(kind: Format, data: st.DataObject) -> None:
    system = validate(data.draw(sayable(kind)))
    try:
        again = written(system, kind)
    except InvalidSystemError:
        with contextlib.suppress(InvalidSystemError):
            assert written(system, kind, lossy=True).inputs
        return
    assert again.inference.resolution == system.inference.resolution
    width = np.array([entry.high - entry.low for entry in system.outputs])
    np.testing.assert_allclose(outputs(again) / width, outputs(system) / width, rtol=0, atol=1e-12)
    assert written(again, kind) == again


def heater(**inference: Any) -> FuzzySystem:
    terms = (Term("low", Triangle(0, 25, 50)), Term("high", Triangle(50, 75, 100)))
    inputs = tuple(
        Input(name, -1.0, 1.0, (Term("n", Triangle(-2, -1, 1)), Term("p", Gaussian(1, 0.5)))) for name in ("e", "de")
    )
    rules = (
        Rule(And((Is("e", "n"), Is("de", "n"))), (Is("T", "low"),)),
        Rule(Is("e", "p"), (Is("T", "high"),), 0.5),
    )
    output = Output("T", 0.0, 100.0, terms, no_fire=NoFire("midpoint"))
    return FuzzySystem("heater", inputs, (output,), RuleBase(None, rules), Inference(**inference))


def with_rule(antecedent: Any) -> FuzzySystem:
    return replace(heater(), rules=RuleBase(None, (Rule(antecedent, (Is("T", "low"),)),)))


def with_term(term: Term) -> FuzzySystem:
    system = heater()
    first = replace(system.inputs[0], terms=(term, system.inputs[0].terms[1]))
    return replace(system, inputs=(first, system.inputs[1]))


def with_output(**changes: Any) -> FuzzySystem:
    system = heater()
    return replace(system, outputs=(replace(system.outputs[0], **changes),))


@pytest.mark.parametrize("kind", OTHERS)
def test_a_usual_system_can_be_said_by_all(kind: Format) -> None:
    assert plain(written(heater(), kind)) == plain(heater())


CANNOT = [
    ("fis", heater(implication="kleene_dienes"), "'kleene_dienes'", "'min'"),
    ("fll", heater(aggregation="min"), "'min'", "'max'"),
    ("fcl", heater(implication="kleene_dienes"), "'kleene_dienes'", "'min'"),
    ("fcl", heater(aggregation="einstein_sum"), "'einstein_sum'", "'max'"),
    ("fml", heater(aggregation="sum"), "'sum'", "'max'"),
    ("fis", heater(defuzzifier="center_of_sums"), "'center_of_sums'", "'centroid'"),
    ("fll", heater(defuzzifier="height"), "'height'", "'centroid'"),
    ("fis", heater(defuzzifier="som"), "'som'", "'som_abs'"),
    ("fml", heater(defuzzifier="lom_abs"), "'lom_abs'", "'lom'"),
    ("fis", with_output(no_fire=NoFire("hold")), "no_fire: hold", "midpoint"),
    ("fis", with_output(no_fire=NoFire("default", 3.0)), "no_fire: {default: 3}", "midpoint"),
    ("fml", with_output(no_fire=NoFire("nan")), "no_fire: nan", "{default: 50}"),
    ("fis", with_term(Term("n", Concave(0, 1))), "the shape 'concave'", "trapmf"),
    ("fcl", with_term(Term("n", SShape(-1, 1))), "the shape 's_shape'", "("),
    ("fml", with_term(Term("n", Triangle(-1, 0, 1), height=0.5)), "the height 0.5", "height 1"),
    (
        "fml",
        replace(with_output(terms=(Term("low", Sigmoid(40, 0.1)), Term("high", Ramp(0, 100)))), inference=WEIGHTED),
        "the shape 'sigmoid' of a monotone term",
        "65 points",
    ),
    (
        "fml",
        replace(
            with_output(terms=(Term("low", Singleton(1)), Term("high", Singleton(2)))),
            inference=Inference(defuzzifier="weighted_average"),
        ),
        "'max' of a weighted average",
        "'sum'",
    ),
    ("fll", replace(heater(), name="oil heater"), "the name 'oil heater'", "'oil_heater'"),
    ("fcl", with_term(Term("with", Triangle(-2, -1, 1))), "the name 'with'", "'with_'"),
    (
        "fis",
        replace(heater(), inputs=(replace(heater().inputs[0], out_of_range="reject"), heater().inputs[1])),
        "reject",
        "clamp",
    ),
]


@pytest.mark.parametrize(("kind", "system", "what", "instead"), CANNOT)
def test_what_a_format_cannot_say_is_named_and_substituted_when_asked(
    kind: Format, system: FuzzySystem, what: str, instead: str
) -> None:
    if what == "the name 'with'":
        rules = (Rule(Is("e", "with"), (Is("T", "low"),)),)
        system = replace(system, rules=RuleBase(None, rules))
    with pytest.raises(InvalidSystemError) as caught:
        formats.write(system, kind)
    assert "cannot say" in caught.value.message
    assert what in caught.value.message
    assert f"--lossy writes {instead}" in caught.value.message
    found = formats.write(system, kind, lossy=True)
    assert any(what in substitute and instead in substitute for substitute in found.substitutes)
    again = formats.loads(found.text, f"x.{kind}")
    assert difference(system, again).points > 1000


CONSTANTS = replace(
    with_output(terms=(Term("low", Singleton(1)), Term("high", Singleton(2)))),
    inference=Inference(defuzzifier="weighted_sum"),
)


@pytest.mark.parametrize(
    ("kind", "system"),
    [
        ("fis", with_rule(Or((And((Is("e", "n"), Is("de", "n"))), Is("e", "p"))))),
        ("fis", with_rule(And((Is("e", "n"), Is("e", "p"))))),
        ("fis", with_rule(Hedged(Is("e", "n"), "plus"))),
        ("fll", with_rule(Not(And((Is("e", "n"), Is("de", "n")))))),
        ("fll", with_rule(Hedged(Is("e", "n"), "plus"))),
        ("fcl", with_rule(Hedged(Is("e", "n"), "very"))),
        ("fml", with_rule(Not(Hedged(Is("e", "n"), "very")))),
        ("fml", with_rule(Is("T", "high"))),
        ("fml", CONSTANTS),
    ],
)
def test_where_there_is_no_substitute_it_stays_an_error(kind: Format, system: FuzzySystem) -> None:
    for lossy in (False, True):
        with pytest.raises(InvalidSystemError, match="cannot say"):
            formats.write(system, kind, lossy=lossy)


@pytest.mark.parametrize(
    ("kind", "sampling"),
    [
        ("fis", Sampling(101, "endpoints")),
        ("fis", Sampling(101, "trapezoid")),
        ("fll", Sampling(200, "midpoints")),
        ("fcl", Sampling(1000, "left")),
        ("fml", Sampling(2000, "left_with_break_points")),
    ],
)
def test_a_resolution_of_the_engine_needs_no_comment(kind: Format, sampling: Sampling) -> None:
    system = heater(resolution=sampling)
    assert "fuzzy-workbench" not in formats.write(system, kind).text
    assert plain(written(system, kind)) == plain(system)
    assert "fuzzy-workbench/1 resolution: exact" in formats.write(heater(), kind).text


def test_sugeno_round_trips() -> None:
    constants = (Term("low", Singleton(-20.0)), Term("high", Singleton(120.0)))
    functions = (Term("low", Linear((3.0, -7.5), 0.1)), Term("high", Singleton(120.0)))
    for terms in (constants, functions):
        system = replace(with_output(terms=terms), inference=WEIGHTED)
        said_by: list[Format] = OTHERS if terms == constants else ["fis", "fll", "fml"]
        for kind in said_by:
            np.testing.assert_array_equal(outputs(written(system, kind)), outputs(system))


MONOTONE = [
    Triangle(-math.inf, 10, 60),
    Triangle(0, 100, 300),
    Trapezoid(20, 50, 200, 300),
    Trapezoid(20, 50, 50, math.inf),
    Rectangle(30, math.inf),
    Ramp(100, 0),
    Points(((10, 0.2), (40, 0.3), (40, 0.9))),
    Gaussian(120, 50),
    Gaussian(-5, 30),
    Gaussian2(-math.inf, 1, 20, 15),
    Gaussian2(80, 30, 200, 5),
    SShape(0, 50),
    ZShape(20, 120),
]


@pytest.mark.parametrize("shape", MONOTONE, ids=kind_of)
@pytest.mark.parametrize("kind", ["fll", "fml"])
def test_tsukamoto_round_trips(shape: Any, kind: Format) -> None:
    terms = (Term("low", shape), Term("high", Ramp(20, 90)))
    system = replace(with_output(terms=terms), inference=WEIGHTED)
    np.testing.assert_allclose(outputs(written(system, kind)), outputs(system), rtol=0, atol=1e-10)
    for changed in (Term("low", shape, complement=True), Term("low", shape, height=0.75)):
        system = replace(with_output(terms=(changed, terms[1])), inference=WEIGHTED)
        if kind == "fml" and (changed.complement or is_linear(changed)):
            np.testing.assert_allclose(outputs(written(system, kind)), outputs(system), rtol=0, atol=1e-10)


def test_both_in_one_system_become_two_rule_bases() -> None:
    system = replace(with_output(terms=(Term("low", Ramp(0, 50)), Term("high", ZShape(20, 80)))), inference=WEIGHTED)
    other = Output("u", -5.0, 5.0, (Term("f", Linear((1.0, 2.0), 0.5)),), no_fire=NoFire("default", 1.0))
    both = Rule(Is("de", "p"), (Is("T", "low"), Is("u", "f")), 0.5)
    system = replace(system, outputs=(*system.outputs, other), rules=RuleBase(None, (*heater().rules.list, both)))
    text = formats.write(system, "fml").text
    assert ("<tskRuleBase" in text, "<tsukamotoRuleBase" in text, "<mamdaniRuleBase" in text) == (True, True, False)
    np.testing.assert_allclose(outputs(formats.loads(text, "x.xml")), outputs(system), rtol=0, atol=1e-10)
    mixed = replace(with_output(terms=(Term("low", Ramp(0, 50)), Term("high", Singleton(3)))), inference=WEIGHTED)
    with pytest.raises(InvalidSystemError, match="sets beside constants"):
        formats.write(mixed, "fml")


@pytest.mark.parametrize("kind", OTHERS)
def test_an_output_has_as_many_terms_as_a_system_may(kind: Format) -> None:
    """A Sugeno system has a term for each rule."""
    terms = tuple(Term(f"z{number}", Singleton(float(number))) for number in range(256))
    rules = tuple(Rule(Is("e", "n"), (Is("T", term.name),)) for term in terms)
    output = Output("T", -1.0, 256.0, terms, no_fire=NoFire("midpoint"))
    system = replace(heater(), outputs=(output,), rules=RuleBase(None, rules), inference=WEIGHTED)
    assert len(written(system, kind).outputs[0].terms) == 256


def test_points_may_jump() -> None:
    system = with_term(Term("n", Points(((-1, 1), (0, 0.5), (0, 0.25), (1, 0)))))
    for kind in ("fll", "fcl", "fml"):
        assert plain(written(system, kind)) == plain(system)


@pytest.mark.parametrize("kind", OTHERS)
def test_saving_and_loading_a_file(tmp_path: Path, kind: Format) -> None:
    path = tmp_path / f"heater.{'xml' if kind == 'fml' else kind}"
    formats.save(heater(), path)
    assert plain(formats.load(path)) == plain(heater())
