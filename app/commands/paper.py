"""``paper``: the source paper's experiments beside ours, and what had to be chosen for them."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from app.commands.failure import UsageError

if TYPE_CHECKING:
    from robot.controllers.fuzzy import Controller
    from robot.experiments import Overshoots, Robustness
    from robot.run import Run

RULEBASE = Path(__file__).resolve().parents[2] / "rulebases" / "piltan.yaml"

TITLES = {"pid": "PID", "fuzzy_flc": "PID with fuzzy FLC (proposed)", "pd_flc": "PD with FLC, no fuzzy blocks"}


def paper(
    *,
    seeds: Annotated[int, tyro.conf.arg(metavar="N")] = 100,
    plants: Annotated[int, tyro.conf.arg(metavar="N")] = 1000,
    plot: Annotated[Path | None, tyro.conf.arg(metavar="DIR", help_behavior_hint="")] = None,
    json: bool = False,
) -> int:
    """Repeat the source paper's experiments, with its figures beside ours.

    The paper prints no parameters. Those used here were chosen such that its four overshoots come out: that is a
    calibration and no verification. The values are printed, and docs/reproduction.md explains them.

    Args:
        seeds: Number of random disturbances.
        plants: Number of random arms in the study of robustness; 0 leaves it out.
        plot: Draw figures in the manner of the paper's Figures 5 and 6 into this folder, which is made if need be.
        json: Print everything as JSON.
    """
    if not 1 <= seeds <= 100_000:
        raise UsageError(f"--seeds {seeds}; valid is 1 to 100000")
    if not 0 <= plants <= 100_000:
        raise UsageError(f"--plants {plants}; valid is 0 to 100000")

    from fuzzy.formats import load
    from fuzzy.inference import compile_system
    from robot import experiments

    inference = compile_system(load(RULEBASE))
    with _Bar("overshoots") as bar:
        rows = experiments.overshoots(inference, seeds, bar)
    with _Bar("sinus") as bar:
        following = {name: experiments.sinus(name, inference).metrics().rms_error["s1"] for name in TITLES}
    spread: list[Robustness] = []
    if plants:
        with _Bar("robustness") as bar:
            spread = experiments.robustness(inference, plants, progress=bar)
    if json:
        _print_json(rows, following, spread, seeds, plants)
    else:
        _print_overshoots(rows, seeds)
        _print_sinus(following)
        if spread:
            _print_robustness(spread, plants)
        _print_calibration()
    if plot is not None:
        _draw(plot, inference)
    return 0


class _Bar:
    """A bar on the terminal's standard error; nothing where that is no terminal."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._shown = -1

    def __call__(self, share: float) -> None:
        filled = int(30 * share)
        if sys.stderr.isatty() and filled != self._shown:
            self._shown = filled
            bar = "█" * filled + "·" * (30 - filled)
            print(f"\r{self._title:<12}{bar}", end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Callable[[float], None]:
        self(0.0)
        return self

    def __exit__(self, *_: object) -> None:
        if sys.stderr.isatty():
            print("\r\x1b[2K", end="", file=sys.stderr, flush=True)


def _print_json(
    rows: list[Overshoots], following: dict[str, float], spread: list[Robustness], seeds: int, plants: int
) -> None:
    import msgspec

    from robot.experiments import CALIBRATION, SINUS_FREQUENCY

    report: dict[str, Any] = {
        "calibration": {**msgspec.to_builtins(CALIBRATION), "seeds": seeds},
        "rows": [
            {
                "case": row.case,
                "variant": row.variant,
                "controller": row.controller,
                "overshoot": {"mean": row.mean, "p5": row.p5, "p95": row.p95},
                "paper": row.paper,
            }
            for row in rows
        ],
        "sinus": {"frequency_hz": SINUS_FREQUENCY, "rms_error_percent": following},
        "robustness": {"plants": plants, "rows": [row._asdict() for row in spread]},
    }
    print(msgspec.json.format(msgspec.json.encode(report)).decode())


def _print_overshoots(rows: list[Overshoots], seeds: int) -> None:
    from robot.experiments import CALIBRATION

    limit = CALIBRATION.feasible_force_limit_n
    titles = {
        "raw": "raw step, as the paper simulates",
        "feasible": f"feasible: prefilter of {CALIBRATION.feasible_prefilter_rad_s:g} rad/s, |F| ≤ {limit:g} N",
    }
    print(f"Overshoot of {CALIBRATION.coordinate}, %; the noisy case over {seeds} seeds. Calibrated, not verified.")
    for variant, title in titles.items():
        print(f"\n{title}")
        print(f"{'':<32}{'':<8}{'paper':>8}{'mean':>8}{'5 %':>8}{'95 %':>8}{'peak force / N':>17}")
        for row in rows:
            if row.variant == variant:
                said = "-" if row.paper is None else f"{row.paper:.1f}"
                figures = f"{said:>8}{row.mean:8.2f}{row.p5:8.2f}{row.p95:8.2f}{row.peak_force:17.0f}"
                print(f"{TITLES[row.controller]:<32}{row.case:<8}{figures}")


def _print_sinus(following: dict[str, float]) -> None:
    print("\nsinus of 0.5 Hz, error of s1 in % of the amplitude (root mean square)")
    for name, value in following.items():
        print(f"{TITLES[name]:<40}{value:8.2f}")


def _print_robustness(spread: list[Robustness], plants: int) -> None:
    print(f"\nrobustness: {plants} arms, every mass, inertia, spring and damper off by up to ± 30 %; feasible step")
    print(f"{'':<22}{'overshoot / %':>20}{'steady error / %':>20}{'ran away / %':>16}")
    print(f"{'':<22}{'median':>10}{'95 %':>10}{'median':>10}{'95 %':>10}")
    for row in spread:
        over = f"{row.overshoot_median:10.2f}{row.overshoot_p95:10.2f}"
        print(f"{row.controller:<22}{over}{row.error_median:10.2f}{row.error_p95:10.2f}{row.stopped:16.1f}")


def _print_calibration() -> None:
    import msgspec

    from robot.experiments import CALIBRATION

    print("\nchosen, because the paper prints none of it (see docs/reproduction.md)")
    for name, value in msgspec.structs.asdict(CALIBRATION).items():
        text = ", ".join(f"{x:g}" for x in value) if isinstance(value, tuple) else value
        print(f"  {name:<26}{text}")


def _draw(folder: Path, inference: Controller) -> None:
    from matplotlib.figure import Figure

    from app.commands.failure import failure
    from app.commands.files import output
    from robot import experiments

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise failure(f"the folder cannot be made: {error.strerror}", folder) from None

    def figure(name: str, title: str, runs: dict[str, dict[str, Run]]) -> None:
        """Draw one row a variant: the whole response and its overshoot enlarged."""
        picture = Figure(figsize=(10, 4 * len(runs)), layout="constrained")
        picture.suptitle(title)
        for axes, (subtitle, answers) in zip(picture.subplots(len(runs), 2, squeeze=False), runs.items(), strict=True):
            for place in axes:
                for label, run in answers.items():
                    place.plot(run.t, 1e3 * (run.q[:, 0] - run.start[0]), label=label, linewidth=1.2)
                target = next(iter(answers.values()))
                place.plot(target.t, 1e3 * (target.reference[:, 0] - target.start[0]), "k--", linewidth=0.8)
                place.set_xlabel("time / s")
                place.set_ylabel("s1 - start / mm")
                place.grid(alpha=0.3)
            axes[0].set_title(subtitle, fontsize="medium")
            axes[0].legend(fontsize="small")
            axes[1].set_title("enlarged", fontsize="medium")
            size = 1e3 * experiments.CALIBRATION.step_extension_m
            axes[1].set_ylim(0.8 * size, 1.25 * size)
        with output(folder / name) as temporary:
            picture.savefig(temporary, dpi=120)

    titles = {
        "clean": "In the manner of Figure 5: step without disturbance",
        "noisy": "In the manner of Figure 6: step under band-limited white noise (seed 0)",
    }
    for number, case in enumerate(experiments.CASES, 5):
        figure(
            f"figure{number}.png",
            titles[case],
            {
                variant: {
                    TITLES[law]: experiments.example(law, case, variant, inference) for law in ("pid", "fuzzy_flc")
                }
                for variant in experiments.VARIANTS
            },
        )
    figure("sinus.png", "Sinus of 0.5 Hz", {"": {TITLES[law]: experiments.sinus(law, inference) for law in TITLES}})
