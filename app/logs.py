"""Logs: one line for every event that matters, to standard error and, if wanted, to a file; never a secret."""

from __future__ import annotations

import logging
import logging.handlers
import sys
from pathlib import Path
from typing import Literal, assert_never

from app.state import (
    Asked,
    Conflict,
    Edit,
    Event,
    Noticed,
    Opened,
    Question,
    Recovered,
    Recovery,
    RunFinished,
    Saved,
)

Level = Literal["debug", "info", "warning", "error"]

_FORM = "%(asctime)s %(levelname)-7s %(name)s: %(message)s"
_PACKAGES = ("app", "fuzzy", "robot")
_MOST_BYTES, _FILES = 10 << 20, 3
"""A log file grows to 10 MiB, then begins anew; the two before it are kept."""

_log = logging.getLogger("app.events")


class _OneLine(logging.Formatter):
    """Keeps a message on its line, whatever names hold; only an error's traceback has several."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 - logging's name
        line = super().formatMessage(record)
        return "".join(character if character.isprintable() else repr(character)[1:-1] for character in line)


def configure(level: Level, file: Path | None) -> None:
    """Send this program's log lines to standard error and to ``file``; of other libraries, warnings only.

    Raises:
        OSError: The file cannot be written.
    """
    handlers: list[logging.Handler] = [logging.StreamHandler(sys.stderr)]
    if file is not None:
        handlers.append(
            logging.handlers.RotatingFileHandler(file, maxBytes=_MOST_BYTES, backupCount=_FILES - 1, encoding="utf-8")
        )
    for handler in handlers:
        handler.setFormatter(_OneLine(_FORM))
    logging.basicConfig(level=logging.WARNING, handlers=handlers, force=True)
    for name in _PACKAGES:
        logging.getLogger(name).setLevel(level.upper())
    # At the level debug it would write requests down, and with them tokens and cookies.
    logging.getLogger("app.guard.websockets").setLevel(logging.WARNING)


def log_event(event: Event) -> None:
    """Write down what happened, if it matters."""
    match event:
        case Edit():
            _log.debug("edit: %s", event.label)
        case Opened():
            _log.info("opened %s", event.file)
        case Saved():
            _log.info("saved %s", event.file)
        case Recovered():
            _log.info("recovered the unsaved work of %s", event.work.source.file)
        case Asked():
            _log_question(event.question)
        case RunFinished():
            for who, result in (("the run", event.result), ("the run under PID control", event.pid)):
                if result.run.stopped is not None:
                    _log.warning("%s %s", who, result.run.stopped)
        case Noticed(notice=notice) if notice is not None and notice.is_error:
            _log.warning("%s", notice.text)
        case _:
            _log.debug("%s", type(event).__name__)


def _log_question(question: Question | None) -> None:
    match question:
        case None:
            pass
        case Conflict():
            _log.warning("%s was changed on disk by somebody else", question.file)
        case Recovery():
            _log.warning("unsaved work of %s was found: %s", question.work.source.file, question.journal)
        case _:
            assert_never(question)
