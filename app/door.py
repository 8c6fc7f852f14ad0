"""What a browser may send: every websocket message passes here before viser, and thereby any callback, sees it.

A message must be one of the few kinds that the workbench's page sends, with exactly their fields. A new value must be
one that its widget declares: of its type, in its range, among its options, and the widget shown and enabled. Whatever
kinds viser knows besides, and whatever widgets of other kinds it offers, is refused until it is listed here. What a
value *means* (whether a name is taken, a number fits the document) is the business of the callbacks.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
import time
from collections.abc import Callable, Iterable
from typing import Any, assert_never

import msgspec
import viser
from viser import _messages
from websockets.asyncio.server import ServerConnection
from websockets.frames import CloseCode
from websockets.typing import Data

from app import clean
from app.clean import MAX_UPLOAD, Refused
from app.messages import (
    CommandTriggerMessage,
    FileTransferPart,
    FileTransferStartUpload,
    GuiUpdateMessage,
    SceneNodeClickMessage,
    SceneNodeDragMessage,
    Update,
    ViewerCameraMessage,
    decode,
)

MAX_MESSAGE = MAX_UPLOAD + (1 << 16)
"""Most bytes of one message: an upload's part and its envelope."""

MAX_NUMBER = 1e12
"""Greatest magnitude of a number whose field declares no bounds, and of coordinates."""

MAX_LINE, MAX_TEXT = 2_000, 20_000
"""Most characters of a text field with one line and with several."""

TELL_SECONDS = 0.2
"""How soon after one refusal the next is told."""

_MAX_PARTS = 64
"""Most parts of an upload, and most uploads at once: 1 MiB comes in two parts."""

_log = logging.getLogger(__name__)


class StaleError(Refused):
    """A message for what is no longer there, or not at the moment: nobody's fault, and nothing to say about it."""


class Door:
    """Decides which messages viser receives.

    Attributes:
        server: The server that the messages are for; None until it runs.
        on_refused: Called on the event loop with a sentence about what was refused, five times a second at most.
    """

    def __init__(self, on_refused: Callable[[str], None]) -> None:
        self.server: viser.ViserServer | None = None
        self.on_refused = on_refused
        self._silent_until = 0.0

    def connection_class(self) -> type[ServerConnection]:
        """Return the class of connections that give viser only what passes."""
        door = self

        class GuardedConnection(ServerConnection):
            _is_shut = False

            async def recv(self, decode: bool | None = None) -> Any:
                while True:
                    # What came before is handled first, and other browsers get their turn.
                    await asyncio.sleep(0)
                    data = await super().recv(decode)
                    try:
                        if not self._is_shut:
                            door.check(data)
                    except msgspec.MsgspecError as error:  # nothing that the page sends
                        _log.warning("a browser sent what the page never sends, and is disconnected: %s", error)
                        self._is_shut = True
                        await self.close(CloseCode.POLICY_VIOLATION, "not a message of this page")
                    except StaleError as stale:
                        _log.debug("ignored: %s", stale)
                    except Refused as refusal:
                        door.tell(str(refusal))
                    else:
                        if not self._is_shut:
                            return data

        return GuardedConnection

    def tell(self, sentence: str) -> None:
        """Pass a refusal on, unless one was passed on a moment ago: each is shown to everybody."""
        now = time.monotonic()
        if now >= self._silent_until:
            self._silent_until = now + TELL_SECONDS
            self.on_refused(sentence)

    def check(self, data: Data) -> None:
        """Return if viser may have a message.

        Raises:
            msgspec.MsgspecError: It is none that the page sends.
            Refused: Its value is not one that its widget declares; the browser is told the present one.
        """
        message = decode(data)
        server = self.server
        if server is None:
            raise StaleError("the workbench is starting")
        match message:
            case GuiUpdateMessage(uuid=uuid, updates=Update(value=value)):
                self._check_update(server, uuid, value)
            case CommandTriggerMessage(uuid=uuid):
                if uuid not in server.gui._command_handle_from_uuid:
                    raise StaleError("a command that is not there")
            case SceneNodeClickMessage() | SceneNodeDragMessage():
                _check_finite(message)
                _check_instance(server, message.name, message.instance_index)
            case ViewerCameraMessage():
                _check_finite(message)
                if not (message.image_height and message.image_width):  # its aspect would be a division by zero
                    raise StaleError("a page that is not to be seen")
            case FileTransferStartUpload():
                try:
                    _check_upload(server, message)
                except Refused:
                    _end_upload(server, message)
                    raise
            case FileTransferPart():
                _check_part(server, message)
            case _:
                assert_never(message)

    def _check_update(self, server: viser.ViserServer, uuid: str, value: object) -> None:
        handle = server.gui._gui_input_handle_from_uuid.get(uuid)
        if handle is None or handle._impl.removed:
            raise StaleError("a widget that is not there")
        try:
            check_value(handle, value)
        except Refused:
            # The browser shows what it sent: tell it, and with it all others, what is.
            if not isinstance(handle, viser.GuiButtonHandle | viser.GuiUploadButtonHandle):
                handle._queue_update("value", handle._impl.value)
            raise


def check_value(handle: Any, value: object) -> None:
    """Return if a browser may give ``value`` to a widget.

    Raises:
        Refused: The widget does not declare it, or cannot be changed.
    """
    props, present = handle._impl.props, handle._impl.value
    what = f"'{props.label}'" if getattr(props, "label", None) else "the value"
    if props.disabled or not props.visible:
        raise StaleError(f"{what} cannot be changed now")
    match handle:
        case viser.GuiButtonHandle() | viser.GuiCheckboxHandle():
            clean.flag(value, what)
        case viser.GuiButtonGroupHandle() | viser.GuiDropdownHandle():
            clean.choice(value, props.options, what)
        case viser.GuiSliderHandle():
            _check_number(value, present, props.min, props.max, what)
        case viser.GuiMultiSliderHandle():
            _check_numbers(value, present, [props.min] * len(present), [props.max] * len(present), what)
        case viser.GuiNumberHandle():
            low = -MAX_NUMBER if props.min is None else props.min
            _check_number(value, present, low, MAX_NUMBER if props.max is None else props.max, what)
        case viser.GuiVector2Handle() | viser.GuiVector3Handle():
            low = props.min or [-MAX_NUMBER] * len(present)
            _check_numbers(value, present, low, props.max or [MAX_NUMBER] * len(present), what)
        case viser.GuiRgbHandle() | viser.GuiRgbaHandle():
            _check_numbers(value, present, [0] * len(present), [255] * len(present), what)
        case viser.GuiTextHandle():
            _check_text(value, props.multiline, what)
        case _:
            raise Refused(f"{what} is no widget that a browser gives a value")


def _check_number(value: object, present: float, low: float, high: float, what: str) -> None:
    number = clean.number(value, low, high, what)
    if isinstance(present, int) and not number.is_integer():
        raise Refused(f"{what} is {number:.12g}; valid is a whole number")


def _check_numbers(
    value: object, present: tuple[float, ...], low: Iterable[float], high: Iterable[float], what: str
) -> None:
    if not isinstance(value, list) or len(value) != len(present):
        raise Refused(f"{what} are not {len(present)} numbers")
    for one, was, least, most in zip(value, present, low, high, strict=True):
        _check_number(one, was, least, most, what)


def _check_text(value: object, is_multiline: bool, what: str) -> None:
    text = clean.text(value, MAX_TEXT if is_multiline else MAX_LINE, what)
    allowed = "\t\n\r" if is_multiline else "\t"
    if any((character < " " and character not in allowed) or character == "\x7f" for character in text):
        raise Refused(f"{what} holds control characters")


def _check_finite(value: object) -> None:
    """Refuse a message with a coordinate that is not finite."""
    match value:
        case float():
            if not math.isfinite(value) or abs(value) > MAX_NUMBER:
                raise Refused(f"a coordinate is {value:g}")
        case msgspec.Struct():
            _check_finite(msgspec.structs.astuple(value))
        case tuple():
            for one in value:
                _check_finite(one)


def _check_instance(server: viser.ViserServer, name: str, index: int | None) -> None:
    handle = server.scene._handle_from_node_name.get(name)
    if handle is None:
        raise StaleError("something in the scene that is not there")
    if index is not None:
        positions = getattr(handle, "batched_positions", ())
        if index >= len(positions):
            raise StaleError(f"{name} has {len(positions)} instances, not a number {index}")


def _check_upload(server: viser.ViserServer, message: FileTransferStartUpload) -> None:
    """Refuse an upload that is not for a button, has no plain name of a known kind, or is too large with the others.

    Viser buffers whatever arrives; its own table of transfers in flight is the truth about who still uploads.
    """
    handle = server.gui._gui_input_handle_from_uuid.get(message.source_component_uuid)
    if not isinstance(handle, viser.GuiUploadButtonHandle) or handle.disabled or not handle.visible:
        raise StaleError("an upload that nobody asked for")
    clean.upload_name(message.filename)
    in_flight = server.gui._current_file_upload_states
    promised = sum(state["total_bytes"] for state in in_flight.values())
    if message.transfer_uuid in in_flight or len(in_flight) >= _MAX_PARTS or message.part_count > _MAX_PARTS:
        raise Refused(f"{message.filename} comes in {message.part_count} parts, or with too many others")
    if message.size_bytes > MAX_UPLOAD - promised:
        raise Refused(
            f"{message.filename} has {message.size_bytes} bytes; valid are {MAX_UPLOAD} for all uploads together"
        )


def _end_upload(server: viser.ViserServer, message: FileTransferStartUpload) -> None:
    """Tell the browser that an upload is over: its button waits for the last part to be acknowledged."""
    if message.transfer_uuid not in server.gui._current_file_upload_states:
        server._websock_server.queue_message(
            _messages.FileTransferPartAck(
                message.source_component_uuid, message.transfer_uuid, message.size_bytes, message.size_bytes
            )
        )


def _check_part(server: viser.ViserServer, message: FileTransferPart) -> None:
    state = server.gui._current_file_upload_states.get(message.transfer_uuid)
    if state is None:
        raise StaleError("a part of no upload")
    if state["transferred_bytes"] + len(message.content) > state["total_bytes"]:
        with contextlib.suppress(KeyError):
            del server.gui._current_file_upload_states[message.transfer_uuid]
        raise Refused(f"{state['filename']} is longer than was announced")
