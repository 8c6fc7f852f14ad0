"""What every operator computes, as it stands in the page; an operator without a formula shows its name."""

from __future__ import annotations

from fuzzy.system import Inference

_T_NORMS = {
    "min": "min({a}, {b})",
    "product": "{a} · {b}",
    "bounded_difference": "max(0, {a} + {b} − 1)",
    "drastic_product": "{a} if {b} = 1, {b} if {a} = 1, otherwise 0",
    "einstein_product": "{a} {b} / (2 − ({a} + {b} − {a} {b}))",
    "hamacher_product": "{a} {b} / ({a} + {b} − {a} {b})",
    "nilpotent_minimum": "min({a}, {b}) if {a} + {b} &gt; 1, otherwise 0",
}
_S_NORMS = {
    "max": "max({a}, {b})",
    "algebraic_sum": "{a} + {b} − {a} · {b}",
    "bounded_sum": "min(1, {a} + {b})",
    "drastic_sum": "{a} if {b} = 0, {b} if {a} = 0, otherwise 1",
    "einstein_sum": "({a} + {b}) / (1 + {a} {b})",
    "hamacher_sum": "({a} + {b} − 2 {a} {b}) / (1 − {a} {b})",
    "nilpotent_maximum": "max({a}, {b}) if {a} + {b} &lt; 1, otherwise 1",
}
_IMPLICATIONS = {
    **_T_NORMS,
    "algebraic_sum": _S_NORMS["algebraic_sum"],
    "bounded_sum": _S_NORMS["bounded_sum"],
    "kleene_dienes": "max(1 − {a}, {b})",
}
_WORDS = {"min": "clips its set: ", "product": "scales its set: "}
_SUMS = {
    "max": "max<sub>r</sub> μ<sub>r</sub>(u)",
    "sum": "Σ<sub>r</sub> μ<sub>r</sub>(u)",
    "min": "min<sub>r</sub> μ<sub>r</sub>(u)",
}
_DEFUZZIFIERS = {
    "centroid": "centroid: y = ∫ u μ(u) du / ∫ μ(u) du &nbsp;(34; the paper's COA, IEC's COG)",
    "center_of_sums": (
        "center of sums: y = Σ<sub>r</sub> ∫ u μ<sub>r</sub>(u) du / Σ<sub>r</sub> ∫ μ<sub>r</sub>(u) du "
        "&nbsp;(33; the paper's COG): every rule counts, whatever the aggregation"
    ),
    "bisector": "bisector: ∫ μ left of y = ∫ μ right of y &nbsp;(IEC's and fuzzylite's COA)",
    "mom": "mean of maxima: y = the middle of the places where μ is largest",
    "som": "smallest of maxima: y = the leftmost place where μ is largest",
    "lom": "largest of maxima: y = the rightmost place where μ is largest",
    "som_abs": "smallest of maxima in magnitude &nbsp;(MATLAB's som)",
    "lom_abs": "largest of maxima in magnitude &nbsp;(MATLAB's lom)",
    "height": "height: y = Σ w c / Σ w over the middles c of the sets' tops",
    "weighted_average": (
        "weighted average: y = Σ w z / Σ w; z is a singleton, a function of the inputs (Sugeno), "
        "or where a rising or falling set has the degree w (Tsukamoto)"
    ),
    "weighted_sum": "weighted sum: y = Σ w z, with z as in the weighted average",
}


def lines(inference: Inference) -> list[str]:
    """Return one line of HTML for each option, in the order of inference."""
    implication = inference.implication
    implied = _filled(_IMPLICATIONS.get(implication, implication), "w<sub>r</sub>", "μ(u)")
    aggregation = inference.aggregation
    joined = _SUMS.get(aggregation) or f"of two sets: {_filled(_S_NORMS.get(aggregation, aggregation), 'μ', 'ν')}"
    return [
        f"a AND b = {_filled(_T_NORMS.get(inference.conjunction, inference.conjunction), 'a', 'b')}",
        f"a OR b = {_filled(_S_NORMS.get(inference.disjunction, inference.disjunction), 'a', 'b')}",
        f"rule r {_WORDS.get(implication, '')}μ<sub>r</sub>(u) = {implied}",
        f"output set: μ(u) = {joined}",
        _DEFUZZIFIERS.get(inference.defuzzifier, inference.defuzzifier),
        _resolution(inference),
    ]


def _filled(formula: str, a: str, b: str) -> str:
    return formula.replace("{a}", a).replace("{b}", b)


def _resolution(inference: Inference) -> str:
    if inference.resolution == "exact":
        return "exact: closed forms for piecewise-linear sets; no samples, no step in the surface"
    rule = inference.resolution.rule.replace("_", " ")
    return f"as other engines do: {inference.resolution.points} points ({rule})"
