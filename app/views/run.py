"""The panels on the right: Run above Response."""

from __future__ import annotations

from typing import Any

import viser

from app.store import Store
from app.views.baselines import BaselinesView
from app.views.experiment import ExperimentView
from app.views.export import ExportView
from app.views.metrics import MetricsView
from app.views.playback import PlaybackView
from app.views.plots import PlotsView
from app.views.robustness import RobustnessView
from app.views.stage import StageView
from app.views.why import WhyView


class RunPanels:
    """Builds both panels.

    Attributes:
        playback: The controls of time, for the hotkeys.
        views: All views, in the order in which they are rendered.
        live_views: Those that follow the moving arm.
        response: The lower panel, to be docked.
    """

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self.playback = PlaybackView(gui, store)
        experiment = ExperimentView(gui, store)
        with gui.add_folder("Baselines", expand_by_default=False):
            baselines = BaselinesView(gui, store)
        with gui.add_folder("View", expand_by_default=False):
            stage = StageView(gui, store)
        with gui.add_folder("Save", expand_by_default=False):
            ExportView(gui, store)
        self.response = gui.add_panel()
        with self.response.add_tab("Plots", viser.Icon.CHART_LINE):
            plots = PlotsView(gui, store)
        with self.response.add_tab("Metrics", viser.Icon.LIST_NUMBERS):
            metrics = MetricsView(gui)
            with gui.add_folder("Robustness", expand_by_default=False):
                robustness = RobustnessView(gui, store)
        with self.response.add_tab("Why", viser.Icon.QUESTION_MARK):
            why = WhyView(gui, store)
        self.views: tuple[Any, ...] = (self.playback, experiment, baselines, stage, plots, metrics, robustness, why)
        self.live_views: tuple[Any, ...] = (self.playback, plots, why)
