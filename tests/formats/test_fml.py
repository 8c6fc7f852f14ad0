"""IEEE 1855 FML: the traps of the format, and hostile XML."""

from __future__ import annotations

import math
import re

import pytest

from fuzzy import compile_system, formats
from fuzzy.errors import FormatError
from fuzzy.shapes import Gaussian2, Linear, PiShape, Points, Ramp, Singleton
from fuzzy.system import FuzzySystem, Hedged, Is, NoFire, Not, Or, Rule, Sampling

TEXT = """<?xml version="1.0" encoding="ISO-8859-1"?>
<!-- a comment -->
<fuzzySystem xmlns="http://www.ieee1855.org" name="heater">
  <knowledgeBase>
    <fuzzyVariable name="temp" domainleft="-10" domainright="10" scale="degrees">
      <fuzzyTerm name="very cold or  cold"><leftGaussianShape param1="-5" param2="2"/></fuzzyTerm>
      <fuzzyTerm name="hot" complement="True"><leftLinearShape param1="0" param2="5"/></fuzzyTerm>
      <fuzzyTerm name="fine"><piShape param1="-2" param2="0"/></fuzzyTerm>
    </fuzzyVariable>
    <fuzzyVariable name="power" domainleft="0" domainright="100" type="output" defaultValue="7">
      <fuzzyTerm name="low"><triangularShape param1="0" param2="20" param3="40"/></fuzzyTerm>
      <fuzzyTerm name="high">
        <pointSetShape><point x="90" y="1"/><point x="50" y="0"/></pointSetShape>
      </fuzzyTerm>
    </fuzzyVariable>
  </knowledgeBase>
  <mamdaniRuleBase name="r" orMethod="PROBOR">
    <rule name="1" connector="OR">
      <antecedent>
        <clause modifier="very"><variable>temp</variable><term> very cold or cold </term></clause>
        <clause modifier="not"><variable>temp</variable><term>hot</term></clause>
      </antecedent>
      <consequent>
        <then><clause><variable>power</variable><term>high</term></clause></then>
        <else><clause modifier="not"><variable>power</variable><term>high</term></clause></else>
      </consequent>
    </rule>
  </mamdaniRuleBase>
</fuzzySystem>
"""
CLAUSE = "<clause><variable>power</variable><term>high</term></clause>"


def read(text: str) -> FuzzySystem:
    return formats.loads(text, "x.xml")


def test_the_whole_file() -> None:
    system = read(TEXT)
    cold, hot, fine = system.inputs[0].terms
    assert (cold.name, cold.shape) == ("very cold or cold", Gaussian2(-math.inf, 2, -5, 2))
    assert (hot.shape, hot.complement) == (Ramp(5, 0), True)
    assert fine.shape == PiShape(-2, 0, 0, 2)
    assert system.inputs[0].unit == "degrees"
    (output,) = system.outputs
    assert output.no_fire == NoFire("default", 7)
    assert [term.name for term in output.terms] == ["low", "high", "not high"]
    assert output.terms[1].shape == Points(((50, 0), (90, 1)))
    assert system.inference.disjunction == "algebraic_sum"
    assert system.inference.resolution == Sampling(2000, "left_with_break_points")
    antecedent = Or((Hedged(Is("temp", "very cold or cold"), "very"), Not(Is("temp", "hot"))))
    assert system.rules.list == (
        Rule(antecedent, (Is("power", "high"),)),
        Rule(Not(antecedent), (Is("power", "not high"),)),
    )


def test_other_interpolations_are_taken_as_lines_with_a_remark() -> None:
    text = TEXT.replace("<pointSetShape>", '<pointSetShape interpolationMethod="spline">')
    imported = formats.from_bytes(text.encode(), "x.xml")
    assert imported.system == read(TEXT)
    assert "not by 'spline'" in imported.remarks[0].message


BOMB = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;">]>\n'


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("<!-- a comment -->\n", BOMB, "a document type", 2),
        ("<!-- a comment -->\n", '<!DOCTYPE x SYSTEM "file:///etc/passwd">\n', "a document type", 2),
        ("</fuzzySystem>", "", "this is not XML: no element found", 30),
        ("hot</term>", "&hot;</term>", "this is not XML: undefined entity", 21),
        (
            "<mamdaniRuleBase",
            "<tskRuleBase><x/></tskRuleBase><mamdaniRuleBase",
            "unknown element <x>; valid: tskRule",
            17,
        ),
        ("<mamdaniRuleBase", "<anYaRuleBase/><mamdaniRuleBase", "a <anYaRuleBase> cannot be read; valid: mamdani", 17),
        ("<leftLinearShape", "<customShape", "a <customShape> cannot be read", 7),
        ("<leftLinearShape", "<leftShape", "unknown shape 'leftShape'; did you mean 'leftLinearShape'", 7),
        ('param1="0" param2="5"', 'param1="0"', "<leftLinearShape> has no attribute 'param2'", 7),
        ('param1="0" param2="5"', 'param1="0" param2="five"', "is 'five', expected a number", 7),
        ('domainleft="-10"', "", "no attribute 'domainleft'", 5),
        ('name="power"', 'name="temp"', "the variable 'temp' stands twice", 10),
        ('name="high"', 'name="low"', "the term 'low' stands twice", 12),
        ('type="output"', 'type="both"', "unknown word 'both'", 10),
        ('type="output"', 'type="output" accumulation="NSUM"', "unknown word 'NSUM'", 10),
        ('type="output"', 'type="output" defuzzifier="custom_x"', "unknown word 'custom_x'", 10),
        ("<variable>temp</variable><term>hot", "<variable>tmp</variable><term>hot", "unknown input 'tmp'", 21),
        ("<term>hot", "<term>cool", "unknown term of 'temp': 'cool'", 21),
        ('modifier="very"', 'modifier="slightly"', "'slightly' has no word", 20),
        ('modifier="very"', 'modifier="veri"', "unknown modifier 'veri'", 20),
        ('connector="OR"', 'connector="XOR"', "unknown word 'XOR'", 18),
        ('connector="OR"', 'connector="OR" weight="2"', "weight 2", 18),
        ('connector="OR"', 'connector="OR" weight="0.5"', "<else> in a rule with a weight", 25),
        ('defaultValue="7"', 'defaultValue="7e12"', r"default 7e\+12: valid is a finite number", 10),
        ("fuzzySystem", "fuzzySet", "expected <fuzzySystem>, found <fuzzySet>", 3),
    ],
)
def test_mistakes_are_named_where_they_stand(old: str, new: str, message: str, line: int) -> None:
    assert old in TEXT
    with pytest.raises(FormatError) as caught:
        read(TEXT.replace(old, new) if old == "fuzzySystem" else TEXT.replace(old, new, 1))
    assert re.search(message, caught.value.message), caught.value.message
    assert caught.value.line == line, str(caught.value)


def test_a_declared_encoding_does_not_matter() -> None:
    for encoding in ("utf-8", "latin-1"):
        content = TEXT.replace("degrees", "größe").encode(encoding)
        assert formats.from_bytes(content, "x.xml").system.inputs[0].unit == "größe"
    assert read(TEXT.replace("ISO-8859-1", "no-such-one")) == read(TEXT)


def test_deep_nesting_is_refused() -> None:
    with pytest.raises(FormatError, match="nested more than 16 deep"):
        read("<fuzzySystem>" * 10_000)


def test_rules_with_other_norms_are_refused_by_name() -> None:
    rule = TEXT[TEXT.index("    <rule") : TEXT.index("  </mamdani")]
    other = rule.replace('connector="OR"', 'connector="OR" orMethod="BSUM"').replace('name="1"', 'name="2"')
    with pytest.raises(FormatError, match="the orMethod of the rule '2' is bounded_sum, that of the rule '1' is"):
        read(TEXT.replace(rule, rule + other))


INPUTS = """
    <fuzzyVariable name="x" domainleft="0" domainright="10" type="input">
      <fuzzyTerm name="low"><leftLinearShape param1="0" param2="10"/></fuzzyTerm>
      <fuzzyTerm name="high"><rightLinearShape param1="0" param2="10"/></fuzzyTerm>
    </fuzzyVariable>
    <fuzzyVariable name="y" domainleft="-1" domainright="1" type="input">
      <fuzzyTerm name="negative"><leftLinearShape param1="-1" param2="1"/></fuzzyTerm>
    </fuzzyVariable>"""

TSK = f"""<fuzzySystem xmlns="http://www.ieee1855.org" name="plane">
  <knowledgeBase>
    <tskVariable name="z" scale="V" type="output" combination="WA" defaultValue="2">
      <tskTerm name="constant" order="0"><tskValue>1.5</tskValue></tskTerm>
      <tskTerm name="plane" order="1"><tskValue>1</tskValue><tskValue>2</tskValue><tskValue>-3</tskValue></tskTerm>
      <tskTerm name="slope" order="1"><tskValue>-1</tskValue><tskValue>0.5</tskValue></tskTerm>
    </tskVariable>{INPUTS}
  </knowledgeBase>
  <tskRuleBase name="rules" activationMethod="PROD" andMethod="PROD">
    <tskRule name="1" connector="and">
      <antecedent>
        <clause><variable>x</variable><term>low</term></clause>
        <clause><variable>y</variable><term>negative</term></clause>
      </antecedent>
      <tskConsequent>
        <tskThen><tskClause><variable>z</variable><term>plane</term></tskClause></tskThen>
        <tskElse><tskClause><variable>z</variable><term>constant</term></tskClause></tskElse>
      </tskConsequent>
    </tskRule>
    <tskRule name="2" weight="0.5">
      <antecedent><clause modifier="very"><variable>x</variable><term>high</term></clause></antecedent>
      <tskConsequent><tskThen><tskClause><variable>z</variable><term>slope</term></tskClause></tskThen></tskConsequent>
    </tskRule>
  </tskRuleBase>
</fuzzySystem>
"""

TSUKAMOTO = f"""<fuzzySystem xmlns="http://www.ieee1855.org" name="valve">
  <knowledgeBase>{INPUTS}
    <tsukamotoVariable name="z" domainleft="0" domainright="20" type="output" defaultValue="4">
      <tsukamotoTerm name="small"><leftLinearShape param1="2" param2="12"/></tsukamotoTerm>
      <tsukamotoTerm name="large"><rightGaussianShape param1="20" param2="5"/></tsukamotoTerm>
      <tsukamotoTerm name="by points">
        <pointSetMonotonicShape><point x="0" y="0"/><point x="20" y="1"/></pointSetMonotonicShape>
      </tsukamotoTerm>
    </tsukamotoVariable>
  </knowledgeBase>
  <tsukamotoRuleBase name="rules">
    <rule name="1">
      <antecedent><clause><variable>x</variable><term>low</term></clause></antecedent>
      <consequent><then><clause><variable>z</variable><term>small</term></clause></then></consequent>
    </rule>
    <rule name="2" weight="0.8">
      <antecedent><clause><variable>x</variable><term>high</term></clause></antecedent>
      <consequent><then><clause><variable>z</variable><term>large</term></clause></then></consequent>
    </rule>
    <rule name="3">
      <antecedent><clause><variable>y</variable><term>negative</term></clause></antecedent>
      <consequent><then><clause><variable>z</variable><term>by points</term></clause></then></consequent>
    </rule>
  </tsukamotoRuleBase>
</fuzzySystem>
"""


def test_a_tsk_system_gives_the_weighted_average_of_its_functions() -> None:
    system = read(TSK)
    (output,) = system.outputs
    assert [term.shape for term in output.terms] == [Singleton(1.5), Linear((2.0, -3.0), 1.0), Linear((0.5, 0.0), -1.0)]
    assert (output.low, output.high) == (-2.0, 24.0)  # all values over the inputs' ranges
    assert (output.unit, output.no_fire) == ("V", NoFire("default", 2.0))
    controller = compile_system(system)
    for x, y in ((3.0, 0.5), (10.0, -1.0), (0.0, 1.0)):
        degrees = (1 - x / 10) * (1 - y) / 2, 1 - (1 - x / 10) * (1 - y) / 2, 0.5 * (x / 10) ** 2
        values = 1 + 2 * x - 3 * y, 1.5, -1 + 0.5 * x
        wanted = sum(w * z for w, z in zip(degrees, values, strict=True)) / sum(degrees)
        assert controller(x, y) == pytest.approx(wanted, abs=1e-12)


def test_a_tsukamoto_system_gives_the_weighted_average_of_places() -> None:
    controller = compile_system(read(TSUKAMOTO))
    for x, y in ((3.0, 0.5), (9.0, -1.0)):
        degrees = 1 - x / 10, 0.8 * x / 10, (1 - y) / 2
        values = 12 - 10 * degrees[0], 20 - math.sqrt(-50 * math.log(degrees[1])), 20 * degrees[2]
        wanted = sum(w * z for w, z in zip(degrees, values, strict=True)) / sum(degrees)
        assert controller(x, y) == pytest.approx(wanted, abs=1e-9)
    silent = read(TSUKAMOTO.replace("<term>high", "<term>low"))
    assert compile_system(silent)(10.0, 1.0) == 4.0


@pytest.mark.parametrize(
    ("text", "old", "new", "message"),
    [
        (TSK, 'combination="WA"', 'combination="custom_x"', "unknown word 'custom_x'; valid: WA"),
        (
            TSK,
            "<tskValue>-3</tskValue>",
            "<tskValue>-3</tskValue><tskValue>4</tskValue>",
            "4 values; valid are at most 3",
        ),
        (TSK, "<tskValue>-3<", "<tskValue>many<", "<tskValue> is 'many', expected a number"),
        (TSK, "<tskValue>1.5</tskValue>", "", "holds no <tskValue>"),
        (TSK, '"plane" order="1"', '"plane" order="2"', "unknown word '2'"),
        (TSK, '"plane" order="1"', '"plane"', "no attribute 'order'"),
        (TSK, 'type="output"', 'type="input"', "a <tskVariable> is an output"),
        (TSK, "<term>plane", "<term>plain", "unknown term of 'z': 'plain'; did you mean 'plane'"),
        (TSK, "tskRuleBase", "mamdaniRuleBase", "unknown element <tskRule>; valid: rule"),
        (TSUKAMOTO, 'leftLinearShape param1="2"', 'triangularShape param1="2"', "unknown shape 'triangularShape'"),
        (
            TSUKAMOTO,
            '<point x="20" y="1"/>',
            '<point x="5" y="1"/><point x="9" y="0"/>',
            "rise or fall all over the range",
        ),
        (TSUKAMOTO, "tsukamotoRuleBase", "tskRuleBase", "unknown element <rule>; valid: tskRule"),
        (
            TSUKAMOTO,
            "  </knowledgeBase>",
            '<fuzzyVariable name="u" domainleft="0" domainright="1" type="output">'
            '<fuzzyTerm name="t"><zShape param1="0" param2="1"/></fuzzyTerm></fuzzyVariable></knowledgeBase>',
            "the defuzzifier of 'u' is centroid, that of 'z' is weighted_average",
        ),
    ],
)
def test_mistakes_in_tsk_and_tsukamoto_systems_are_named(text: str, old: str, new: str, message: str) -> None:
    assert old in text
    with pytest.raises(FormatError) as caught:
        read(text.replace(old, new))
    assert message in caught.value.message, caught.value.message


def test_values_that_jfml_does_not_read_or_reads_otherwise_are_remarks() -> None:
    surplus = TSK.replace("<tskValue>1.5</tskValue>", "<tskValue>1.5</tskValue><tskValue>7</tskValue>")
    imported = formats.from_bytes(surplus.encode(), "x.xml")
    assert imported.system == read(TSK)
    assert "of order 0 the first value counts" in imported.remarks[0].message
    complement = TSUKAMOTO.replace('name="small"', 'name="small" complement="true"')
    imported = formats.from_bytes(complement.encode(), "x.xml")
    assert imported.system.outputs[0].terms[0].complement
    assert "JFML takes 1 minus the place" in imported.remarks[0].message


def test_without_a_default_it_is_0_also_where_the_range_is_elsewhere() -> None:
    text = TSUKAMOTO.replace(' defaultValue="4"', "").replace('name="z" domainleft="0"', 'name="z" domainleft="1"')
    assert read(text).outputs[0].no_fire == NoFire("default", 0.0)
