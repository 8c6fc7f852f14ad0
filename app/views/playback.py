"""Run: the experiment, and how its time passes."""

from __future__ import annotations

from functools import partial
from typing import Any

import viser

from app import clean, experiment
from app.palette import BAD, ERROR, GOOD, MUTED
from app.runner import Frame
from app.state import SPEEDS, AppState, PlaybackChanged, ResetRequested, SetupChanged
from app.store import Dispatch
from app.widgets import div, escape, on_input
from robot import controllers
from robot.arm import PRESETS

_SPEEDS = {f"{speed:g}×": speed for speed in SPEEDS}
_SOURCES = {"live simulation": "live", "replay of the run": "replay"}
_DISTURBANCES = {"none": "none", "force_noise": "force noise, 30 % of the holding force"}
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
_TIME_STEP = 0.01
_FREQUENCIES = (1.0, 500.0)
"""Natural frequencies that a controller at 1 kHz can have, rad/s."""


class PlaybackView:
    """Controls of the experiment and of time."""

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch) -> None:
        self._duration = 3.0
        self._notice = gui.add_html("")
        buttons = gui.add_button_group("time", ("play / pause", "reset"))
        on_input(buttons, dispatch, self._press)
        self._time = gui.add_slider("t [s]", 0.0, self._duration, _TIME_STEP, 0.0)
        on_input(self._time, dispatch, self._scrub)
        self._source = gui.add_dropdown("source", tuple(_SOURCES))
        on_input(self._source, dispatch, lambda v: PlaybackChanged({"source": _SOURCES[clean.choice(v, _SOURCES)]}))
        self._speed = gui.add_dropdown("speed", tuple(_SPEEDS))
        on_input(self._speed, dispatch, lambda v: PlaybackChanged({"speed": _SPEEDS[clean.choice(v, _SPEEDS)]}))
        self._setup: dict[str, Any] = {}
        self._options = _setup_options()
        for field, options in self._options.items():
            self._setup[field] = gui.add_dropdown(field, tuple(options))
            on_input(self._setup[field], dispatch, partial(_setup_event, field, options))
        self._frequency = gui.add_number("ωn [rad/s]", 1.0, step=1.0, hint="Natural frequency of the error dynamics")
        on_input(self._frequency, dispatch, _frequency_event)
        self._status = gui.add_html("")
        self._state: AppState | None = None

    def render(self, state: AppState) -> None:
        """Show the experiment and the notice."""
        before, self._state = self._state, state
        playback = state.playback
        self._source.value = _shown(_SOURCES, playback.source)
        self._speed.value = _shown(_SPEEDS, playback.speed)
        for field, options in self._options.items():
            self._setup[field].value = _shown(options, getattr(state.setup, field))
        frequency = experiment.natural_frequency(state.setup)
        self._frequency.visible = frequency is not None
        if frequency is not None:
            self._frequency.value = frequency
        if state.runs.current is not None:
            self._duration = state.runs.current.run.scenario.duration
            self._time.max = self._duration
        if not playback.is_playing and playback.source == "replay":
            time = min(playback.time, self._duration)
            if before is not None and before.playback.is_playing:
                # Frames that were on their way have moved the browser's slider since: equal values would not be sent.
                self._time.value = time + _TIME_STEP / 2
            self._time.value = time
        self._notice.content = _notice_html(state)

    def show(self, frame: Frame) -> None:
        """Show where time is, and how fast it passes."""
        state = self._state
        if state is None:
            return
        if state.playback.is_playing:
            self._time.value = round(min(frame.t, self._duration) / _TIME_STEP) * _TIME_STEP
        self._status.content = _status_html(state, frame)

    def _press(self, value: object) -> PlaybackChanged | ResetRequested:
        assert self._state is not None
        if clean.choice(value, ("play / pause", "reset")) == "reset":
            return ResetRequested()
        return PlaybackChanged({"is_playing": not self._state.playback.is_playing})

    def _scrub(self, value: object) -> PlaybackChanged:
        time = clean.number(value, 0.0, self._duration, "the time")
        return PlaybackChanged({"source": "replay", "is_playing": False, "time": time})


def _setup_options() -> dict[str, dict[str, str]]:
    """Return, for each field of the experiment, the offered texts and the names that they stand for."""
    return {
        "controller": {f"{name} · {_CONTROLLERS[name]}": name for name in controllers.NAMES},
        "scenario": {name: name for name in experiment.scenario_names()},
        "disturbance": {_DISTURBANCES[name]: name for name in experiment.DISTURBANCES},
        "arm": {name: name for name in PRESETS},
    }


def _setup_event(field: str, options: dict[str, str], value: object) -> SetupChanged:
    return SetupChanged({field: options[clean.choice(value, options, f"the {field}")]})


def _frequency_event(value: object) -> SetupChanged:
    return SetupChanged({"natural_frequency": clean.number(value, *_FREQUENCIES, "the natural frequency")})


def _shown(options: dict[str, Any], value: object) -> str:
    return next(text for text, name in options.items() if name == value)


def _notice_html(state: AppState) -> str:
    """Return the notice; there is always one, so that the widgets below stay where they are."""
    if state.progress is not None:
        text, color = f"{state.progress} …", BAD
    elif state.notice is not None:
        text, color = state.notice.text, ERROR if state.notice.is_error else GOOD
    elif state.past:
        text, color = f"{state.past[-1].label} · Ctrl+Z takes it back", MUTED
    else:
        text, color = "Paint a cell or drag a point: the arm answers.", MUTED
    return div(escape(text), f"color:{color};min-height:1.45em")


def _status_html(state: AppState, frame: Frame) -> str:
    playing = "▶" if state.playback.is_playing else "❚❚"
    if frame.stopped is not None:
        return div(escape(frame.stopped), f"color:{ERROR}")
    if state.progress is not None:
        what = "waiting for the kernels"
    elif state.playback.source == "live":
        factor = f"{frame.factor:.2f}× real time" if state.playback.is_playing else "paused"
        what = f"live simulation · {factor}"
    else:
        what = "replay of the last run"
    return div(f"{playing} {what} · t = {frame.t:.2f} s", f"color:{MUTED};font-variant-numeric:tabular-nums")
