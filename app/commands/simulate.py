"""``simulate``: one scenario, its figures of merit, and the run as a file or a picture."""

from __future__ import annotations

import re
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from app.commands.failure import UsageError, failure

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from robot.arm import Arm
    from robot.controllers import ControlLaw
    from robot.metrics import Metrics
    from robot.run import Run
    from robot.scenario import Mismatch, Scenario

MISMATCHES = ("mass", "stiffness", "damping")


def simulate(
    rulebase: tyro.conf.Positional[
        Annotated[Path | None, tyro.conf.arg(metavar="[RULEBASE]", help_behavior_hint="")]
    ] = None,
    /,
    *,
    controller: Annotated[str, tyro.conf.arg(metavar="NAME")] = "fuzzy_flc",
    scenario: Annotated[str, tyro.conf.arg(metavar="NAME")] = "step",
    arm: Annotated[str, tyro.conf.arg(metavar="NAME")] = "soft",
    mismatch: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]], tyro.conf.arg(metavar="NAME=+P%", help_behavior_hint="")
    ] = (),
    disturbance: Annotated[str | None, tyro.conf.arg(metavar="NAME", help_behavior_hint="")] = None,
    natural_frequency: Annotated[float | None, tyro.conf.arg(metavar="W", help_behavior_hint="")] = None,
    seed: Annotated[int, tyro.conf.arg(metavar="N")] = 0,
    output: Annotated[Path | None, tyro.conf.arg(metavar="RUN.csv|.npz", help_behavior_hint="")] = None,
    plot: Annotated[Path | None, tyro.conf.arg(metavar="RUN.png", help_behavior_hint="")] = None,
    json: bool = False,
) -> int:
    """Simulate the arm under a controller and print the figures of merit.

    Exit code 1 when the run had to be stopped because the arm ran away.

    Args:
        rulebase: The rule base of the fuzzy controllers. By default rulebases/diagonal.yaml.
        controller: pid, pid_gravity, pd_flc, pid_flc, parallel, fuzzy_flc, fuzzy_pid, adaptive_fuzzy_flc,
            adaptive_fuzzy_pid or scaled_pid.
        scenario: step, step_noise, sinus, hold, sequence or circle.
        arm: soft or stiff.
        mismatch: How the real arm differs from the one the controller knows: stiffness=+30%, mass=-10% or damping=...;
            may be given several times.
        disturbance: none or force_noise; by default as the scenario says.
        natural_frequency: Of the feedback linearization's error dynamics, rad/s; by default 12, and 217 where forces
            disturb the arm.
        seed: Of the disturbance's random numbers.
        output: Write the whole run, one row a millisecond.
        plot: Draw positions, references and forces over time.
        json: Print the figures as JSON; what is not defined becomes null.
    """
    if output is not None and output.suffix.lower() not in (".csv", ".npz"):
        raise UsageError(f"--output {output}; valid are names that end in .csv or .npz")

    if seed < 0:
        raise UsageError(f"--seed {seed}; valid is a whole number, 0 or more")

    from robot.errors import RobotError

    try:
        asked = _scenario(scenario, disturbance, seed, mismatch)
        run, wall = _run(rulebase, controller, arm, asked, natural_frequency)
    except RobotError as error:
        raise failure(str(error)) from None
    metrics = run.metrics()
    if json:
        import msgspec

        report = {
            "controller": controller,
            "scenario": scenario,
            "arm": arm,
            "horizon_s": run.scenario.duration,
            "wall_s": wall,
            "stopped": str(run.stopped) if run.stopped else None,
            "metrics": metrics.to_dict(),
        }
        if run.activity.size:
            report["clamped"], report["no_fire"] = (_counts(run, steps) for steps in (run.clamped, run.undefined))
        print(msgspec.json.format(msgspec.json.encode(report)).decode())
    else:
        print(f"{controller} on the {arm} arm, {scenario}: {run.scenario.duration:g} s simulated in {wall:.4f} s")
        _print(metrics)
        for steps, what in ((run.clamped, "an input was clamped"), (run.undefined, "no rule fired")):
            if steps.any():
                found = ", ".join(f"{name} {count}" for name, count in _counts(run, steps).items() if count)
                print(f"{what} in control steps out of {len(run.t)}: {found}")
    if output is not None:
        _write(run, output)
    if plot is not None:
        _draw(run, f"{controller}, {arm} arm, {scenario}", plot)
    if run.stopped:
        raise failure(str(run.stopped))
    return 0


def _counts(run: Run, steps: NDArray[np.int64]) -> dict[str, int]:
    return dict(zip(run.arm.coordinates, steps.tolist(), strict=True))


def _scenario(name: str, disturbance: str | None, seed: int, mismatch: tuple[str, ...]) -> Scenario:
    import msgspec

    from app.experiment import NOISES
    from fuzzy.errors import expected
    from robot.scenario import Scenario

    scenario = Scenario.preset(name)
    chosen = scenario.disturbance
    if disturbance is not None:
        if disturbance not in NOISES:
            raise failure(f"no disturbance is called {expected(disturbance, NOISES)}")
        chosen = NOISES[disturbance]
    if chosen is not None:
        chosen = msgspec.structs.replace(chosen, seed=seed)
    return msgspec.structs.replace(scenario, disturbance=chosen, mismatch=_mismatch(mismatch))


def _mismatch(words: tuple[str, ...]) -> Mismatch:
    """Return the factors that words like ``stiffness=+30%`` say."""
    from fuzzy.errors import expected, shown
    from robot.scenario import Mismatch

    factors: dict[str, float] = {}
    for word in words:
        name, _, text = word.partition("=")
        if name not in MISMATCHES:
            raise UsageError(f"--mismatch names {expected(name, MISMATCHES)}")
        if name in factors:
            raise UsageError(f"--mismatch gives '{name}' twice")
        if not re.fullmatch(r"[+-]?\d{1,6}(\.\d{0,9})?%", text, re.ASCII):
            raise UsageError(f"--mismatch {shown(word)}; valid is a percentage such as {name}=+30%")
        factors[name] = 1 + float(text[:-1]) / 100
    return Mismatch(**factors)


def _run(
    rulebase: Path | None, controller: str, arm_name: str, scenario: Scenario, natural_frequency: float | None
) -> tuple[Run, float]:
    """Return the run and how long it took, without the compilation of kernels."""
    from robot.arm import Arm
    from robot.simulation import Simulation, simulate

    arm = Arm.preset(arm_name)
    law = _law(rulebase, controller, arm, scenario, natural_frequency)
    Simulation(arm, law, scenario).advance(1)
    begin = time.perf_counter()
    run = simulate(arm, law, scenario)
    return run, time.perf_counter() - begin


def _law(rulebase: Path | None, name: str, arm: Arm, scenario: Scenario, natural_frequency: float | None) -> ControlLaw:
    from app.shipped import SHIPPED
    from fuzzy.formats import load
    from fuzzy.inference import compile_system
    from robot import controllers

    needs_rules = rulebase is not None or (name in controllers.NAMES and controllers.needs_rules(name))
    compiled = compile_system(load(rulebase or SHIPPED)) if needs_rules else None
    return controllers.default(name, arm, scenario, compiled, natural_frequency=natural_frequency)


UNITS = {
    "overshoot": "%",
    "rise_time": "s",
    "settling_time": "s",
    "steady_state_error": "%",
    "iae": "s",
    "ise": "s",
    "itae": "s²",
    "rms_error": "%",
    "effort": "N² s",
    "peak_force": "N",
    "saturation": "%",
}
"""Units of the figures of merit."""


def _print(metrics: Metrics) -> None:
    """Print one table for coordinates and one for actuators, the worst first."""
    heading: list[str] = []
    for name, values in metrics._asdict().items():
        columns = ["worst", *(key for key in values if key != "worst")]
        if columns != heading:
            heading = columns
            print(" " * 25 + "".join(f"{column:>11}" for column in columns))
        print(f"{name:<19}{UNITS[name]:<6}" + "".join(f"{values[column]:11.4g}" for column in columns))


def _write(run: Run, path: Path) -> None:
    from app import exports
    from app.commands.files import output

    data = exports.csv(run) if path.suffix.lower() == ".csv" else exports.npz(run)
    with output(path) as temporary:
        temporary.write_bytes(data)


def _draw(run: Run, title: str, path: Path) -> None:
    from app import exports
    from app.commands.files import output

    with output(path) as temporary:
        temporary.write_bytes(exports.picture(run, title, kind=path.suffix[1:]))
