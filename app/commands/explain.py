"""``explain``: why a controller gives what it gives."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fuzzy.inference import Trace
    from fuzzy.system import FuzzySystem


def explain(
    file: tyro.conf.Positional[Annotated[Path, tyro.conf.arg(metavar="FILE")]],
    values: tyro.conf.Positional[
        Annotated[tuple[str, ...], tyro.conf.arg(metavar="NAME=VALUE...", help_behavior_hint="")]
    ],
    /,
    *,
    json: bool = False,
) -> int:
    """Show one inference step by step: degrees, rules that fire, outputs.

    Args:
        file: The rule base, in any format; - reads standard input.
        values: A value for every input, such as e=0.2 de=-1.
        json: Print the steps as JSON; values that are not defined become null.
    """
    from app.commands.rulebases import load
    from fuzzy.inference import compile_system

    system = load(file)
    given = _inputs(values, [variable.name for variable in system.inputs])
    trace = compile_system(system).explain(*given)
    if json:
        import msgspec

        print(msgspec.json.format(msgspec.json.encode(_as_builtins(trace))).decode())
    else:
        _print(system, trace)
    return 0


def _inputs(values: tuple[str, ...], names: list[str]) -> list[float]:
    """Return the numbers in ``NAME=VALUE`` words in the order of the inputs."""
    from app.commands.failure import UsageError
    from fuzzy.errors import expected

    usage = " ".join(f"{name}=VALUE" for name in names)
    given: dict[str, float] = {}
    for word in values:
        name, is_pair, text = word.rpartition("=")
        if not is_pair:
            raise UsageError(f"'{word}' is not of the form NAME=VALUE; valid: {usage}")
        if name not in names:
            raise UsageError(f"no input is called {expected(name, names)}")
        if name in given:
            raise UsageError(f"the input '{name}' is given twice")
        try:
            given[name] = float(text)
        except ValueError:
            given[name] = math.nan
        if not math.isfinite(given[name]):
            raise UsageError(f"{name} is '{text}'; valid is a finite number")
    missing = [name for name in names if name not in given]
    if missing:
        raise UsageError(f"no value for {', '.join(missing)}; valid: {usage}")
    return [given[name] for name in names]


def _as_builtins(trace: Trace) -> dict[str, Any]:
    from fuzzy.language import format_rule

    return {
        "inputs": trace.inputs,
        "clamped": trace.clamped,
        "memberships": trace.memberships,
        "rules": [
            {"number": rule.number, "rule": format_rule(rule.rule), "strength": rule.strength} for rule in trace.rules
        ],
        "outputs": {
            name: {"value": output.value, "fired": output.fired, "heights": output.heights}
            for name, output in trace.outputs.items()
        },
    }


def _print(system: FuzzySystem, trace: Trace) -> None:
    from fuzzy.language import format_rule

    units = {variable.name: f" {variable.unit}".rstrip() for variable in (*system.inputs, *system.outputs)}
    for name, value in trace.inputs.items():
        note = " (outside its range, taken as the nearer end)" if name in trace.clamped else ""
        print(f"{name} = {value:g}{units[name]}{note}: {_degrees(trace.memberships[name])}")
    print(f"{len(trace.rules)} of {trace.strength.size} rules fire:" if trace.rules else "no rule fires")
    for rule in trace.rules:
        print(f"  {rule.strength:.6f}  {format_rule(rule.rule)}")
    for name, output in trace.outputs.items():
        note = "" if output.fired else " (no rule concludes on it)"
        print(f"{name} = {output.value:.17g}{units[name]}{note}: {_degrees(output.heights)}")


def _degrees(degrees: Mapping[str, float]) -> str:
    return ", ".join(f"{term} {degree:.4g}" for term, degree in degrees.items() if degree > 0) or "none"
