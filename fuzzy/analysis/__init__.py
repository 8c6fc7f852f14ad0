"""What a compiled controller does over its whole input space: surface, gains, coverage, reach, use and work of rules.

Pure functions of a :class:`fuzzy.Controller`; nothing here draws. Every inference is independent of the others: an
output with the hold policy has its start value where no rule fires, as in ``Controller.batch``.
"""

from fuzzy.analysis.contributions import OTHERS, Contribution, Contributions, Shares, contributions, shares
from fuzzy.analysis.gains import EquivalentGains, LocalGains, equivalent_gains, local_gains
from fuzzy.analysis.reach import Reach, output_range
from fuzzy.analysis.remedies import culprits, stepped
from fuzzy.analysis.surfaces import MAX_POINTS, Section, Surface, section, surface
from fuzzy.analysis.usage import Coverage, RuleUsage, coverage, rule_usage

__all__ = [
    "MAX_POINTS",
    "OTHERS",
    "Contribution",
    "Contributions",
    "Coverage",
    "EquivalentGains",
    "LocalGains",
    "Reach",
    "RuleUsage",
    "Section",
    "Shares",
    "Surface",
    "contributions",
    "coverage",
    "culprits",
    "equivalent_gains",
    "local_gains",
    "output_range",
    "rule_usage",
    "section",
    "shares",
    "stepped",
    "surface",
]
