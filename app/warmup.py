"""The first start compiles the kernels; this says what is going on, in the page and on the terminal."""

from __future__ import annotations

import gc
import sys
import threading
from collections.abc import Callable

from app import experiment
from app.state import Event, Progressed, Setup
from fuzzy import compile_system
from fuzzy.analysis import contributions
from fuzzy.system import FuzzySystem
from robot import dynamics
from robot.arm import Arm
from robot.simulation import Simulation

_NOTEWORTHY = 1.0
"""Seconds after which the terminal says what takes so long; from the cache all steps together take less."""


def warm_up(document: FuzzySystem, post: Callable[[Event], None]) -> None:
    """Compile every kernel that the workbench uses, or load it from the cache.

    Args:
        document: A valid system.
        post: Receives the progress, and the news that all is ready.
    """
    for number, (name, step) in enumerate(_STEPS, 1):
        text = f"Compiling kernels, {number} of {len(_STEPS)}: {name} (once after an installation or update)"
        post(Progressed(text))
        say = threading.Timer(_NOTEWORTHY, print, (text,), {"file": sys.stderr, "flush": True})
        say.start()
        try:
            step(document)
        finally:
            say.cancel()
    # Modules, kernels and widgets stay for good. To look for garbage among them would stop all threads for 0.1 s.
    gc.collect()
    gc.freeze()
    post(Progressed(None))


def _inference(document: FuzzySystem) -> None:
    middle = [(variable.low + variable.high) / 2 for variable in document.inputs]
    controller = compile_system(document)
    controller.explain(*middle)
    contributions(controller, middle)


def _dynamics(_: FuzzySystem) -> None:
    dynamics.equilibrium(Arm.preset(Setup().arm))


def _closed_loop(document: FuzzySystem) -> None:
    # Any law compiles the one kernel of all laws, and this one asks nothing of the document.
    Simulation(*experiment.prepare(Setup(), compile_system(document), law="pid"), history=1.0).advance(1)


_STEPS = (("fuzzy inference", _inference), ("the arm's dynamics", _dynamics), ("the closed loop", _closed_loop))
