"""The workbench's own script in the browser, and how it is reached.

Viser offers neither the choice of a tab by the server nor a window for one browser alone. ``page.js`` does both in the
page; it is the one place that relies on the elements that viser's page consists of. It goes to each browser by itself
rather than to all, since what goes to all also goes into recordings of the scene.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Literal

import viser
from viser import _messages

from app.page.texts import CONTENT

Function = Literal["showTab", "help", "tour"]


def install(client: viser.ClientHandle) -> None:
    """Give a browser that came the script; one that came back after a restart gets it anew."""
    _run(client, _source())


def call(client: viser.ClientHandle, function: Function, *arguments: str) -> None:
    """Call one of the script's functions in one browser."""
    given = ", ".join(json.dumps(argument) for argument in arguments)
    _run(client, f"window.fuzzyWorkbench?.{function}({given})")


@cache
def _source() -> str:
    script = Path(__file__).with_name("page.js").read_text(encoding="utf-8")
    return f"const content = {json.dumps(CONTENT)};\n{script}"


def _run(client: viser.ClientHandle, source: str) -> None:
    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source))
