"""Files that come from the browser and go to it: what an import left out is shown before it replaces the document."""

from __future__ import annotations

import asyncio
from pathlib import PurePath
from typing import Any

import viser

from app import clean
from app.clean import Refused
from app.palette import BAD, MUTED
from app.state import AppState, Event, Imported, Notice, Noticed, Upload, Uploaded
from app.store import Shown, Store
from app.widgets import div, escape, on_input
from fuzzy import formats
from fuzzy.check import check
from fuzzy.errors import FuzzyError
from fuzzy.formats import Format
from fuzzy.system import FuzzySystem

_SUFFIXES: dict[str, Format] = {".yaml": "yaml", ".fis": "fis", ".fll": "fll", ".fcl": "fcl", ".xml": "fml"}
_TAKE, _DISCARD = "replace the document", "discard"
_MOST_REMARKS = 8


class ExchangeView:
    """Upload, what it brought, and download."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        download = gui.add_button_group("download", tuple(_SUFFIXES), hint="The document, in the format of the suffix")
        download.on_click(self._download)
        kinds = formats.READABLE
        upload = gui.add_upload_button(
            "Upload a file", icon=viser.Icon.UPLOAD, hint=" ".join(kinds), mime_type=",".join(kinds)
        )
        upload.on_upload(self._receive)
        self._found = gui.add_html("")
        self._answer = gui.add_button_group("", (_TAKE, _DISCARD))
        on_input(self._answer, store.dispatch, _answered)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return (state.upload,)

    def render(self, state: AppState) -> None:
        """Show what was uploaded and waits for an answer."""
        self._answer.visible = state.upload is not None
        self._found.content = "" if state.upload is None else _upload_html(state.upload)

    async def _receive(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is None:
            return
        uploaded = event.target.value
        try:
            name, content = clean.upload(uploaded.name, uploaded.content)
            self._store.dispatch(Uploaded(await asyncio.to_thread(read_upload, name, content)))
        except Refused as refusal:
            self._store.dispatch(_failed(f"Refused: {refusal}."))
        except FuzzyError as error:
            self._store.dispatch(_failed(f"Not read: {error}."))

    async def _download(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is None:
            return
        state = self._store.state
        try:
            suffix = clean.choice(event.target.value, _SUFFIXES, "the format")
            name = f"{file_stem(state)}{suffix}"
            written = await asyncio.to_thread(formats.write, state.document, _SUFFIXES[suffix], lossy=True)
        except Refused as refusal:
            self._store.dispatch(_failed(f"Refused: {refusal}."))
            return
        except FuzzyError as error:
            self._store.dispatch(_failed(f"Not written: {error}."))
            return
        event.client.send_file_download(name, written.text.encode(), save_immediately=True)
        instead = f" Written otherwise: {'; '.join(written.substitutes)}." if written.substitutes else ""
        self._store.dispatch(Noticed(Notice(f"Sent {name}.{instead}")))


def read_upload(name: str, content: bytes) -> Upload:
    """Read an uploaded file.

    Raises:
        FormatError: It is no file of a known format; with line and column.
    """
    imported = formats.from_bytes(content, name)
    remarks = tuple(f"line {remark.line}: {remark.message}" for remark in imported.remarks)
    findings = tuple(f"{finding.level}: {finding.message}" for finding in check(imported.system))
    return Upload(name, imported.system, remarks, findings)


def file_stem(state: AppState) -> str:
    """Return the document's file name without its suffix, or a plain form of its own name."""
    if state.file is not None:
        return PurePath(state.file).stem
    plain = "".join(letter if letter.isascii() and letter.isalnum() else "-" for letter in state.document.name)
    return plain.strip("-")[: clean.MAX_NAME - 8] or "rulebase"


def _answered(value: object) -> Event:
    return Imported() if clean.choice(value, (_TAKE, _DISCARD), "the answer") == _TAKE else Uploaded(None)


def _upload_html(upload: Upload) -> str:
    lines = [f"<b>{escape(upload.name)}</b> {_size(upload.document)}"]
    if upload.remarks:
        lines.append(f'<span style="color:{BAD}">Left out, or taken otherwise than written:</span>')
    lines += [f"▲ {escape(remark)}" for remark in (*upload.remarks, *upload.findings)[:_MOST_REMARKS]]
    more = len(upload.remarks) + len(upload.findings) - _MOST_REMARKS
    if more > 0:
        lines.append(f'<span style="color:{MUTED}">and {more} more</span>')
    if not upload.remarks and not upload.findings:
        lines.append(f'<span style="color:{MUTED}">All of it was read; the check finds nothing.</span>')
    return div("<br>".join(lines), f"border-left:3px solid {BAD};margin:0.35em 0.75em")


def _size(system: FuzzySystem) -> str:
    table = 0 if system.rules.table is None else sum(c is not None for row in system.rules.table.cells for c in row)
    names = ", ".join(escape(variable.name) for variable in (*system.inputs, *system.outputs))
    return f"{escape(system.name)}: {names}; {table + len(system.rules.list)} rules"


def _failed(text: str) -> Noticed:
    return Noticed(Notice(text, is_error=True))
