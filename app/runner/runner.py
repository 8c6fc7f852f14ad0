"""Keeps the background work in step with the state, and gives the latest frame."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from app.runner.frames import Frame, ghosts, resting_frame, sample_at
from app.runner.live import LiveSimulation
from app.runner.previews import Post, Previews
from app.state import AppState, Notice, Noticed, Playback, Setup
from app.store import Shown
from fuzzy.inference import Controller
from fuzzy.kernels.address import Directory
from fuzzy.kernels.inference import compiled_call
from fuzzy.system import FuzzySystem
from robot import controllers
from robot.arm import Arm
from robot.controllers import ControlLaw
from robot.pull import Pull
from robot.run import Sample

Array = NDArray[np.float64]


class Runner:
    """Keeps the background work in step with the state, and gives the latest frame."""

    def __init__(self, post: Post, warm_up: Callable[[Post], None]) -> None:
        self._live = LiveSimulation(lambda sentence: post(Noticed(Notice(f"{sentence}.", is_error=True))))
        self._previews = Previews(post, self._live, warm_up)
        self._requested: tuple[FuzzySystem, Setup] | None = None
        self._playback: Playback | None = None
        self._replay_time = 0.0
        self._blocks: tuple[Controller, Directory] | None = None

    def shows(self, state: AppState) -> Shown:
        """Return what the background work depends on."""
        return state.document, state.setup, state.playback

    def render(self, state: AppState) -> None:
        """Order what a changed state needs."""
        if self._requested is None or self._requested[0] is not state.document or self._requested[1] != state.setup:
            self._requested = (state.document, state.setup)
            self._previews.request(state.document, state.setup)
        if state.playback != self._playback:
            before, self._playback = self._playback, state.playback
            self._live.follow(state.playback)
            if before is None or (before.time, before.resets) != (state.playback.time, state.playback.resets):
                self._replay_time = state.playback.time
            elif state.playback.is_playing and not before.is_playing and self._is_at_end(state):
                self._replay_time = 0.0

    def pull(self, pull: Pull | None) -> None:
        """Let a hand pull the arm of the live simulation, or let go."""
        self._live.pull(pull)

    def frame(self, state: AppState, elapsed: float) -> Frame:
        """Return the present frame.

        Args:
            state: Tells what is shown.
            elapsed: Wall time since the last call, s; a replay goes on by it.
        """
        current = state.runs.current
        if state.playback.source == "live" or current is None or not len(current.run.t):
            moment = self._live.moment
            if moment is None:
                return resting_frame(Arm.preset(state.setup.arm))
            frame = self._frame(state, moment.arm, moment.law, moment.sample)
            return frame._replace(factor=moment.factor, stopped=moment.stopped, pull=moment.pull)
        run = current.run
        if state.playback.is_playing:
            self._replay_time += elapsed * state.playback.speed
            if self._replay_time > run.t[-1]:
                self._replay_time = 0.0 if state.playback.loops else float(run.t[-1])
        return self._frame(state, run.arm, run.controller, sample_at(run, self._replay_time))

    def _is_at_end(self, state: AppState) -> bool:
        current = state.runs.current
        return current is not None and len(current.run.t) > 0 and self._replay_time >= current.run.t[-1]

    def stop(self) -> None:
        """End the threads."""
        self._previews.stop()
        self._live.stop()

    def _frame(self, state: AppState, arm: Arm, law: ControlLaw, sample: Sample) -> Frame:
        inputs = sample.inputs[state.coordinate]
        inference = controllers.inference_of(law)
        return Frame(
            arm=arm,
            t=sample.t,
            q=sample.q,
            target=sample.reference,
            forces=sample.forces,
            inputs=inputs,
            inference=inference,
            strength=None if inference is None else self._strength(inference, inputs),
            factor=0.0,
            stopped=None,
            blocks=sample.inputs,
            outputs=sample.output,
            ghosts=ghosts(state.runs.kept, arm, sample.t),
        )

    def _strength(self, controller: Controller, inputs: Array) -> Array | None:
        """Return the firing strengths by the kernel that controls; None where the inputs are not finite."""
        if not np.isfinite(inputs).all():
            return None
        if self._blocks is None or self._blocks[0] is not controller:
            self._blocks = (controller, controller.directory())
        directory = self._blocks[1]
        compiled_call(len(inputs))(directory.address, tuple(inputs.tolist()))
        return directory.workspace.strength.copy()
