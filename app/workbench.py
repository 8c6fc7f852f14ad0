"""The workbench: builds the store, the runner and the views, and streams frames. No other module knows them all."""

from __future__ import annotations

import asyncio
import logging
import sys
import time
from pathlib import Path
from typing import Protocol

import viser

from app.filing import Filing
from app.guard import start_server
from app.journal import Journal
from app.page import add_commands, install
from app.runner import Frame, Runner
from app.scene.scene import Scene
from app.state import Asked, Notice, Noticed, initial
from app.storage import Storage
from app.store import Store
from app.studies import Studies
from app.views.files import FilesView
from app.views.inference import ExplainView, InferenceView
from app.views.membership import MembershipView
from app.views.question import QuestionView
from app.views.rules import RulesView
from app.views.run import RunPanels
from app.warmup import warm_up

FRAME_RATE = 30.0
"""Frames of the live view a second."""

_PANEL_WIDTH = 380
_SWITCH_SECONDS = 0.0005
"""How long a thread that computes in Python may keep the interpreter from the event loop, which asks for it anew after
every wait; Python's own 5 ms add up."""
_BREATH_SECONDS = 0.005
"""What the stream leaves to everything else between two frames, however late it is."""
_RECOVERY_SECONDS = 5.0
"""How long the stream waits after an error before it tries again."""

_log = logging.getLogger(__name__)


class LiveView(Protocol):
    """A view that follows the moving arm."""

    def show(self, frame: Frame) -> None:
        """Show a frame."""
        ...


class Workbench:
    """A running workbench.

    Args:
        path: Rule base to open; its folder is where files are opened and saved.
        host: Address to listen on.
        port: Port to listen on; 0 takes a free one.
        token: Secret that a browser must show; None for none.

    Raises:
        PortBusyError: The port is taken.
        FuzzyError: The rule base cannot be read.
    """

    def __init__(self, path: Path, *, host: str = "127.0.0.1", port: int = 8080, token: str | None = None) -> None:
        sys.setswitchinterval(_SWITCH_SECONDS)
        storage = Storage(path.parent)
        opened = storage.open(path.name)
        self.server = start_server(host=host, port=port, token=token, on_refused=self._refuse)
        self._loop = self.server.get_event_loop()
        self.store = Store(
            initial(opened.system, file=path.name, stamp=opened.stamp, files=storage.names()), self._loop
        )
        self._filing = Filing(storage, lambda: self.store.state)
        self._journal = Journal(storage.folder, self._warn)
        self._runner = Runner(self.store.post, lambda post: warm_up(opened.system, post))
        self._studies = Studies(self.store.post)
        self._live_views: list[LiveView] = []
        asyncio.run_coroutine_threadsafe(self._build(), self._loop).result()
        self.store.post(Asked(self._journal.found()))
        self.server.on_client_connect(self._greet)
        self.server.on_client_disconnect(self._greet)
        background = (self._stream_frames(), self._filing.watch(self.store.dispatch))
        self._background = [asyncio.run_coroutine_threadsafe(work, self._loop) for work in background]

    def keep_work(self) -> bool:
        """Keep unsaved work for the next start; what is edited from now on is lost.

        Returns:
            Whether there is any, and it is on the disk.
        """
        return self._journal.close()

    def stop(self) -> None:
        """Keep unsaved work for the next start, then end the background work and the server."""
        for work in self._background:
            work.cancel()
        self.keep_work()
        self._studies.stop()
        self._runner.stop()
        self.store.close()
        self.server.stop()

    async def _greet(self, client: viser.ClientHandle) -> None:
        count = len(self.server.get_clients())
        came = client.client_id in self.server.get_clients()
        if came:
            install(client)
        _log.info("browser %d %s, %d there", client.client_id, "came" if came else "went", count)

    def _refuse(self, sentence: str) -> None:
        self.store.dispatch(Noticed(Notice(f"Refused: {sentence}.", is_error=True)))

    def _warn(self, sentence: str) -> None:
        self.store.post(Noticed(Notice(f"{sentence}.", is_error=True)))

    async def _build(self) -> None:
        """Lay out the panels and fill them; on the event loop, as all that touches widgets."""
        gui = self.server.gui
        gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False, brand_color=(79, 143, 247))
        gui.set_panel_label("Run")
        design = gui.add_panel()
        with design.add_tab("Rules", viser.Icon.TABLE):
            rules = RulesView(gui, self.store)
        with design.add_tab("Membership", viser.Icon.CHART_AREA):
            membership = MembershipView(gui, self.store)
        with design.add_tab("Inference", viser.Icon.MATH_FUNCTION):
            inference = InferenceView(gui, self.store)
            explanation = ExplainView(gui, self.store)
        with design.add_tab("Files", viser.Icon.FOLDER):
            files = FilesView(gui, self.store, self._filing)
        run = RunPanels(gui, self.store)
        design.dock_left()
        design.set_width(_PANEL_WIDTH)
        gui.main_panel.dock_right()
        gui.main_panel.set_width(_PANEL_WIDTH)
        run.response.dock_below(gui.main_panel)
        question = QuestionView(gui, self.store.dispatch, self._filing, self._journal)
        scene = Scene(self.server, self.store, self._runner.pull)
        self._live_views = [scene, rules, membership, explanation, *run.live_views]
        self.store.add(self._journal, self._runner, self._studies)
        self.store.add(*rules.views, *membership.views, *inference.views, explanation, *files.views, question)
        self.store.add(*scene.views, *run.views)
        add_commands(gui, self.store, run.playback, self._filing)

    async def _stream_frames(self) -> None:
        """Show the latest frame at ``FRAME_RATE`` while anybody looks; one that stands still is shown once."""
        last = due = time.perf_counter()
        shown = None
        while True:
            due = max(due + 1.0 / FRAME_RATE, time.perf_counter() + _BREATH_SECONDS)  # what is late is not caught up
            await asyncio.sleep(due - time.perf_counter())
            now = time.perf_counter()
            try:
                frame = self._runner.frame(self.store.state, now - last)
            except Exception as error:
                _log.exception("there is no frame")
                self._warn(f"The arm cannot be shown, an error of the program: {error!r}")
                await asyncio.sleep(_RECOVERY_SECONDS)
                continue
            finally:
                last = now
            key = (frame.t, self.store.state, len(self.server.get_clients()))
            if key == shown or not self.server.get_clients():
                continue
            shown = key
            with self.server.atomic():
                for view in tuple(self._live_views):
                    self._show(view, frame)

    def _show(self, view: LiveView, frame: Frame) -> None:
        """Show a frame in one view; a view that fails is left out from then on, and the others go on."""
        try:
            view.show(frame)
        except Exception:
            name = type(view).__name__
            _log.exception("%s cannot show a frame and is left out", name)
            self._warn(f"{name} no longer follows the arm, an error of the program; start again to bring it back")
            self._live_views.remove(view)
