"""Run, upper part: what happens now, and how time passes."""

from __future__ import annotations

import viser

from app import clean
from app.palette import BAD, ERROR, GOOD, MUTED
from app.runner import Frame
from app.state import SPEEDS, AppState, Event, Playback, PlaybackChanged, ResetRequested
from app.store import Shown, Store
from app.widgets import MARK, div, escape, on_input, put

_SPEEDS = {f"{speed:g}×": speed for speed in SPEEDS}
_SOURCES = {"live simulation": "live", "replay of the run": "replay"}
_BUTTONS = ("play / pause", "◂", "▸", "reset", "loop")
_TIME_STEP = 0.01
_SLOW = 0.9
"""Share of the wanted speed below which it is said that the machine is slower."""


class PlaybackView:
    """Notice, play, pause, steps, reset, loop, the time, live or replay, and the speed."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._duration = 3.0
        self._now = 0.0
        self._has_moved = False
        self._notice = gui.add_html("")
        self._buttons = gui.add_button_group("time", _BUTTONS)
        on_input(self._buttons, store.dispatch, self._press)
        self._time = gui.add_slider("t [s]", 0.0, self._duration, _TIME_STEP, 0.0)
        on_input(self._time, store.dispatch, self._scrub)
        self._source = gui.add_dropdown("source", tuple(_SOURCES))
        on_input(
            self._source, store.dispatch, lambda v: PlaybackChanged({"source": _SOURCES[clean.choice(v, _SOURCES)]})
        )
        self._speed = gui.add_dropdown("speed", tuple(_SPEEDS))
        on_input(self._speed, store.dispatch, lambda v: PlaybackChanged({"speed": _SPEEDS[clean.choice(v, _SPEEDS)]}))
        self._status = gui.add_html("")
        self._store = store

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.playback, state.runs.current, state.progress, state.notice, state.past

    def render(self, state: AppState) -> None:
        """Show the notice and how time passes."""
        playback = state.playback
        self._source.value = next(text for text, name in _SOURCES.items() if name == playback.source)
        self._speed.value = next(text for text, speed in _SPEEDS.items() if speed == playback.speed)
        options = tuple(f"{MARK}{name}" if name == "loop" and playback.loops else name for name in _BUTTONS)
        put(self._buttons, options=options)
        if state.runs.current is not None:
            self._duration = state.runs.current.run.scenario.duration
            self._time.max = self._duration
        if not playback.is_playing and playback.source == "replay":
            time = min(playback.time, self._duration)
            self._now = time
            if self._has_moved:
                # Frames that were on their way have moved the browser's slider since: equal values would not be sent.
                self._has_moved = False
                self._time.value = time + _TIME_STEP / 2
            self._time.value = time
        self._notice.content = _notice_html(state)

    def show(self, frame: Frame) -> None:
        """Show where time is, and how fast it passes."""
        state = self._store.state
        self._now = min(frame.t, self._duration)
        if state.playback.is_playing:
            self._has_moved = True
            self._time.value = round(self._now / _TIME_STEP) * _TIME_STEP
        self._status.content = _status_html(state, frame)

    def step(self, direction: int) -> Event:
        """Return the event that shows the moment before or after the present one, standing still."""
        count = round(self._now / _TIME_STEP) + direction
        time = min(max(count * _TIME_STEP, 0.0), self._duration)
        return PlaybackChanged({"source": "replay", "is_playing": False, "time": time})

    def _press(self, value: object) -> Event:
        text = value.removeprefix(MARK) if isinstance(value, str) else value
        playback: Playback = self._store.state.playback
        match clean.choice(text, _BUTTONS):
            case "reset":
                return ResetRequested()
            case "◂":
                return self.step(-1)
            case "▸":
                return self.step(1)
            case "loop":
                return PlaybackChanged({"loops": not playback.loops})
            case _:
                return PlaybackChanged({"is_playing": not playback.is_playing})

    def _scrub(self, value: object) -> PlaybackChanged:
        time = clean.number(value, 0.0, self._duration, "the time")
        return PlaybackChanged({"source": "replay", "is_playing": False, "time": time})


def _notice_html(state: AppState) -> str:
    """Return the notice; there is always one, so that the widgets below stay where they are."""
    if state.progress is not None:
        wrong = state.notice.text if state.notice is not None and state.notice.is_error else ""
        return div(f'{escape(state.progress)} …<div style="color:{ERROR}">{escape(wrong)}</div>', f"color:{BAD}")
    if state.notice is not None:
        text, color = state.notice.text, ERROR if state.notice.is_error else GOOD
    elif state.past:
        text, color = f"{state.past[-1].label} · Ctrl+Z takes it back", MUTED
    else:
        text, color = "Paint a cell or drag a point: the arm answers.", MUTED
    return div(escape(text), f"color:{color};min-height:1.45em")


def _status_html(state: AppState, frame: Frame) -> str:
    playback = state.playback
    playing = "▶" if playback.is_playing else "❚❚"
    if frame.stopped is not None:
        return div(escape(frame.stopped), f"color:{ERROR}")
    color = MUTED
    if state.progress is not None:
        what = "waiting for the kernels"
    elif playback.source == "live":
        what = "live simulation · paused"
        if playback.is_playing and frame.t > _duration(state):
            what = "live simulation · at its end"
        elif playback.is_playing:
            what = f"live simulation · {frame.factor:.2f}× real time"
            if 0.0 < frame.factor < _SLOW * playback.speed:
                what, color = f"live simulation · {frame.factor:.2f}×, no faster here", BAD
    else:
        what = "replay of the last run"
    return div(f"{playing} {what} · t = {frame.t:.2f} s", f"color:{color};font-variant-numeric:tabular-nums")


def _duration(state: AppState) -> float:
    """Return how long the present scenario is, s; without a run yet, endless."""
    return float("inf") if state.runs.current is None else state.runs.current.run.scenario.duration
