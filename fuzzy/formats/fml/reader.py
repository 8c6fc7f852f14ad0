"""An FML file to the document, which evaluates as JFML does: 2000 left ends of intervals and the sets' break points."""

from __future__ import annotations

from fuzzy.errors import shown
from fuzzy.formats.assembly import Imported, marked_resolution, rule_base, with_complements
from fuzzy.formats.fml import tree, words
from fuzzy.formats.fml.agreement import Agreement
from fuzzy.formats.fml.rules import Rules
from fuzzy.formats.fml.variables import Variables
from fuzzy.system import WEIGHTED_VALUES, FuzzySystem, Inference, Sampling

_JFML = Sampling(2000, "left_with_break_points")


def read(text: str, name: str) -> Imported:
    """Read a file's text.

    Args:
        text: The XML.
        name: Name of the file, for errors.

    Raises:
        FormatError: With line and column of the first mistake, what was found and what is valid.
    """
    root = tree.parse(text, name)
    if root.tag != "fuzzySystem":
        raise root.error(f"expected <fuzzySystem>, found <{shown(root.tag)}>")
    agreement = Agreement()
    variables = Variables(root.only("knowledgeBase"), agreement)
    found = Rules(variables, agreement)
    bases = [child for child in root.children if child.tag != "knowledgeBase"]
    for base in bases:
        found.add(base)
    if not bases:
        raise root.error(f"<fuzzySystem> has no rule base; valid: {', '.join(words.RULE_BASES)}")
    outputs = with_complements(variables.outputs, agreement.negated)
    defuzzifier = agreement.operator("defuzzifier", "centroid")
    inference = Inference(
        agreement.operator("andMethod", "min"),
        agreement.operator("orMethod", "max"),
        agreement.operator("activation method", "min"),
        agreement.operator("accumulation", "max"),
        defuzzifier,
        marked_resolution(text, "exact" if defuzzifier in WEIGHTED_VALUES else _JFML),
    )
    title = " ".join(root.attributes.get("name", "").split()) or "fuzzySystem"
    rule_set = rule_base(variables.inputs, outputs, found.rules)
    return agreement.imported(FuzzySystem(title, tuple(variables.inputs), outputs, rule_set, inference), root)
