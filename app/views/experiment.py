"""Run, middle part: the experiment, as forms."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import viser

from app import clean, experiment
from app.palette import MUTED
from app.state import AppState, Setup, SetupChanged
from app.store import Shown, Store
from app.widgets import coordinate_label, div, number, on_input, put
from robot import controllers
from robot.arm import PRESETS, Arm

_CONTROLLERS = {
    "pid": "independent PID",
    "pid_gravity": "PID + gravity model",
    "pd_flc": "feedback linearization",
    "pid_flc": "linearization + integral",
    "parallel": "linearization + PID",
    "fuzzy_flc": "linearization + rules",
    "fuzzy_pid": "PID + rules, no model",
    "adaptive_fuzzy_flc": "linearization + learning on the sets",
    "adaptive_fuzzy_pid": "PID + learning on the sets",
    "scaled_pid": "PID scaled by the rules",
}
"""What each control law is, beside its name."""
_DISTURBANCES = {
    "none": "none",
    "force_noise": "force noise",
    "measurement_noise": "noise on the measured position",
    "reference_noise": "noise on the reference",
    "pulse": "pulse on one coordinate",
    "push": "push against the tip",
}
_FREQUENCIES = (1.0, 500.0)
"""Natural frequencies that a controller at 1 kHz can have, rad/s."""
_LIMITS = {"least_force": -60.0, "greatest_force": 60.0}
"""Force limits when they are switched on, N."""
_DEGREES = math.degrees(1.0)

Shows = Callable[[AppState], bool]


def _always(_: AppState) -> bool:
    return True


class Field(NamedTuple):
    """A number of the setup as it stands in the page.

    Attributes:
        name: Of the setup's field.
        label: What stands before it, with the unit.
        low: Least value, in the page's unit.
        high: Greatest value.
        step: Between two values.
        scale: Page's unit per unit of the setup's.
        offset: Added after scaling; a factor 1.3 is shown as +30 % by scale 100 and offset -100.
        hint: A sentence for who points at it.
        shows: Whether it means anything now.
        slides: Whether it is a slider.
    """

    name: str
    label: str
    low: float
    high: float
    step: float
    scale: float = 1.0
    offset: float = 0.0
    hint: str | None = None
    shows: Shows = _always
    slides: bool = False


def _has_gain(gain: str) -> Shows:
    return lambda state: state.runs.current is not None and gain in controllers.gains(state.runs.current.run.controller)


def _moves_with(name: str) -> Shows:
    return lambda state: name in experiment.parameters(state.setup)


def _disturbed_by(*names: str) -> Shows:
    return lambda state: state.setup.disturbance in names


_NOISES = ("force_noise", "measurement_noise", "reference_noise")
_PERCENT: dict[str, Any] = {"scale": 100.0, "offset": -100.0, "slides": True}
_FACTOR: dict[str, Any] = {"slides": True}
_GAIN_LABELS = {
    "kp": "Kp ×", "kd": "Kd ×", "ki": "Ki ×", "gu": "GU ×", "ge": "GE ×", "gc": "GC ×", "gamma": "γ ×",
}  # fmt: skip
_GAIN_HINTS = {
    "kp": "Proportional gain, times its default",
    "kd": "Derivative gain, times its default",
    "ki": "Integral gain, times its default",
    "gu": "How much the fuzzy blocks add, times the default",
    "ge": "Scale of the blocks' input e, times the default",
    "gc": "Scale of the blocks' input de, times the default",
    "gamma": "Rate of learning, times its default",
}

FORMS: dict[str, tuple[Field, ...]] = {
    "Gains": (
        Field("damping_ratio", "ζ", 0.1, 2.0, 0.05, hint="Damping ratio of the error dynamics", slides=True,
              shows=lambda state: controllers.has_natural_frequency(state.setup.controller)),
        *(
            Field(gain, _GAIN_LABELS[gain], 0.0, 5.0, 0.05, hint=_GAIN_HINTS[gain], shows=_has_gain(gain), **_FACTOR)
            for gain in controllers.GAINS
        ),
    ),
    "Scenario": (
        Field("duration", "duration [s]", 0.5, 60.0, 0.5),
        Field("extension", "extension [mm]", -60.0, 60.0, 5.0, 1e3, shows=_moves_with("extension"), slides=True),
        Field("bend", "bend [°]", -60.0, 60.0, 1.0, _DEGREES, shows=_moves_with("bend"), slides=True),
        Field("frequency", "frequency [Hz]", 0.05, 5.0, 0.05, shows=_moves_with("frequency"), slides=True),
        Field("radius", "radius [mm]", 1.0, 100.0, 1.0, 1e3, shows=_moves_with("radius"), slides=True),
        Field("period", "period [s]", 0.5, 20.0, 0.5, shows=_moves_with("period")),
        Field("dwell", "dwell [s]", 0.1, 10.0, 0.1, shows=_moves_with("dwell")),
        Field("prefilter", "prefilter [rad/s]", 0.0, 200.0, 1.0,
              hint="Natural frequency of the filter between target and reference; 0 is none"),
    ),
    "Disturbance": (
        Field("noise_share", "power [%]", 0.0, 500.0, 5.0, 100.0, shows=_disturbed_by(*_NOISES), slides=True,
              hint="Of the force that holds the target, or of the motion's size"),
        Field("noise_hold", "hold [ms]", 1.0, 1000.0, 1.0, 1e3, shows=_disturbed_by(*_NOISES),
              hint="How long a sample holds: the bandwidth"),
        Field("seed", "seed", 0.0, 9999.0, 1.0, shows=_disturbed_by(*_NOISES)),
        Field("pulse_value", "force [N|Nm]", -20.0, 20.0, 0.1, shows=_disturbed_by("pulse"), slides=True,
              hint="N on a length, N m on an angle"),
        Field("push_sideways", "sideways [N]", -20.0, 20.0, 0.5, shows=_disturbed_by("push"), slides=True),
        Field("push_down", "down [N]", -20.0, 20.0, 0.5, shows=_disturbed_by("push"), slides=True),
        Field("event_start", "from [s]", 0.0, 60.0, 0.1, shows=_disturbed_by("pulse", "push")),
        Field("event_duration", "for [s]", 0.01, 10.0, 0.1, shows=_disturbed_by("pulse", "push")),
    ),
    "Mismatch and limits": (
        Field("mass", "mass [%]", -80.0, 200.0, 5.0, **_PERCENT, hint="How much more the arm has than the model"),
        Field("stiffness", "stiffness [%]", -80.0, 200.0, 5.0, **_PERCENT),
        Field("damping", "damping [%]", -80.0, 200.0, 5.0, **_PERCENT),
        Field("friction", "friction [N]", 0.0, 10.0, 0.1, hint="Coulomb friction of every actuator", slides=True),
        Field("payload", "payload [g]", 0.0, 1000.0, 10.0, 1e3, hint="At the tip, unknown to the controller",
              slides=True),
        Field("valve_time", "valves [ms]", 0.0, 200.0, 1.0, 1e3, hint="Time constant; 0 is none", slides=True),
    ),
}  # fmt: skip
"""The folders and what stands in them."""

_LIMIT_FIELDS = (
    Field("least_force", "pull to [N]", -200.0, 0.0, 1.0, hint="0 is an arm that only pushes"),
    Field("greatest_force", "push to [N]", 0.0, 200.0, 1.0),
)


class ExperimentView:
    """Controller, scenario, arm and all their parameters."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        self._choices: dict[str, Any] = {}
        self._options: dict[str, dict[str, str]] = {
            "controller": {f"{name} · {_CONTROLLERS[name]}": name for name in controllers.NAMES},
            "scenario": {name: name for name in experiment.scenario_names()},
            "disturbance": {_DISTURBANCES[name]: name for name in experiment.disturbances("step")},
            "arm": {name: name for name in PRESETS},
        }
        for field, options in self._options.items():
            self._choices[field] = gui.add_dropdown(field, tuple(options))
            on_input(self._choices[field], store.dispatch, partial(self._choose, field))
        self._frequency = gui.add_number("ωn [rad/s]", 1.0, step=1.0, hint="Natural frequency of the error dynamics")
        on_input(self._frequency, store.dispatch, _frequency_event)
        self._fields: list[tuple[Field, Any]] = []
        for title, fields in FORMS.items():
            with gui.add_folder(title, expand_by_default=False):
                if title == "Disturbance":
                    self._nothing = gui.add_html(div("No disturbance is chosen.", f"color:{MUTED}"))
                    self._coordinate: Any = gui.add_dropdown("pulse on", ("–",))
                    on_input(self._coordinate, store.dispatch, self._choose_coordinate)
                self._fields += [(field, _add(gui, store, field)) for field in fields]
                if title == "Gains":
                    self._gains = gui.add_html("")
                if title == "Mismatch and limits":
                    self._limited = gui.add_checkbox("limit forces", initial_value=False)
                    on_input(self._limited, store.dispatch, _limit_event)
                    self._limits = [(field, _add(gui, store, field)) for field in _LIMIT_FIELDS]

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.setup, state.runs.current, state.coordinate

    def render(self, state: AppState) -> None:
        """Show the setup; hide what would do nothing."""
        setup = state.setup
        self._render_choices(setup)
        frequency = experiment.natural_frequency(setup)
        put(self._frequency, visible=frequency is not None)
        if frequency is not None:
            self._frequency.value = frequency
        defaults = experiment.parameters(setup)
        for field, handle in self._fields:
            _render(field, handle, setup, defaults.get(field.name), field.shows(state))
        is_limited = setup.least_force is not None
        self._limited.value = is_limited
        for field, handle in self._limits:
            _render(field, handle, setup, 0.0, is_limited)
        self._gains.content = _gains_html(state)

    def _render_choices(self, setup: Setup) -> None:
        possible = experiment.disturbances(setup.scenario)
        offered: dict[str, str] = {_DISTURBANCES[name]: name for name in possible}
        if self._options["disturbance"] != offered:
            self._options["disturbance"] = offered
            self._choices["disturbance"].options = tuple(offered)
        for field, texts in self._options.items():
            self._choices[field].value = next(text for text, name in texts.items() if name == getattr(setup, field))
        put(self._nothing, visible=setup.disturbance == "none")
        put(self._coordinate, visible=setup.disturbance == "pulse")
        names = tuple(coordinate_label(name) for name in Arm.preset(setup.arm).coordinates)
        put(self._coordinate, options=names)
        self._coordinate.value = coordinate_label(setup.pulse_coordinate)

    def _choose(self, field: str, value: object) -> SetupChanged:
        options = self._options[field]
        name = options[clean.choice(value, options, f"the {field}")]
        changes = {field: name}
        if field == "scenario" and self._store.state.setup.disturbance not in experiment.disturbances(name):
            changes["disturbance"] = "none"
        return SetupChanged(changes)

    def _choose_coordinate(self, value: object) -> SetupChanged:
        names = {coordinate_label(name): name for name in Arm.preset(self._store.state.setup.arm).coordinates}
        return SetupChanged({"pulse_coordinate": names[clean.choice(value, names, "the coordinate")]})


def _add(gui: viser.GuiApi, store: Store, field: Field) -> Any:
    initial = min(max(0.0, field.low), field.high)
    add: Any = gui.add_slider if field.slides else gui.add_number
    handle: Any = add(
        field.label, min=field.low, max=field.high, step=field.step, initial_value=initial, hint=field.hint
    )
    on_input(handle, store.dispatch, partial(_event, field))
    return handle


def _event(field: Field, value: object) -> SetupChanged:
    found = clean.number(value, field.low, field.high, f"the {field.label.partition(' [')[0]}")
    wanted = (found - field.offset) / field.scale
    return SetupChanged({field.name: round(wanted) if field.name == "seed" else wanted})


def _render(field: Field, handle: Any, setup: Setup, default: float | None, shows: bool) -> None:
    put(handle, visible=shows)
    value = getattr(setup, field.name)
    value = default if value is None else value
    if shows and value is not None:
        # Rounded, so that 30 mm does not read 30.000000000000004.
        handle.value = round(min(max(value * field.scale + field.offset, field.low), field.high), 6)


def _frequency_event(value: object) -> SetupChanged:
    return SetupChanged({"natural_frequency": clean.number(value, *_FREQUENCIES, "the natural frequency")})


def _limit_event(value: object) -> SetupChanged:
    if clean.flag(value):
        return SetupChanged({**_LIMITS})
    return SetupChanged(dict.fromkeys(_LIMITS, None))


def _gains_html(state: AppState) -> str:
    """Return the gains of the chosen coordinate, as they are in the control law."""
    if state.runs.current is None:
        return ""
    run = state.runs.current.run
    found = controllers.gains(run.controller)
    texts = [f"{_GAIN_LABELS[gain][:-2]} = {number(values[state.coordinate])}" for gain, values in found.items()]
    name = coordinate_label(run.arm.coordinates[state.coordinate])
    return div(f"{name}: {' · '.join(texts)}", f"color:{MUTED}")
