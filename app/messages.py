"""The messages that viser's page sends and the workbench listens to: their kinds, and exactly their fields.

The names of classes and fields are viser's; what is not listed here never reaches it.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import msgspec

_Id = Annotated[str, msgspec.Meta(max_length=64)]
_Name = Annotated[str, msgspec.Meta(max_length=256)]
_Count = Annotated[int, msgspec.Meta(ge=0, le=1 << 31)]
_Two = tuple[float, float]
_Three = tuple[float, float, float]
_Modifier = Literal["cmd/ctrl", "alt", "shift", "cmd/ctrl+alt", "cmd/ctrl+shift", "alt+shift", "cmd/ctrl+alt+shift"]


class _Message(msgspec.Struct, frozen=True, tag_field="type", tag=True, forbid_unknown_fields=True):
    """A message as viser's page sends it; the names of classes and fields are viser's."""


class ViewerCameraMessage(_Message, frozen=True):
    """Where the viewer looks from."""

    wxyz: tuple[float, float, float, float]
    position: _Three
    fov: float
    near: float
    far: float
    image_height: _Count
    image_width: _Count
    look_at: _Three
    up_direction: _Three


class Update(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The one property that a browser may set."""

    value: Any


class GuiUpdateMessage(_Message, frozen=True):
    """A widget has a new value, or a button was pressed."""

    uuid: _Id
    updates: Update


class CommandTriggerMessage(_Message, frozen=True):
    """A hotkey was pressed, or a command chosen from the palette."""

    uuid: _Id


class SceneNodeClickMessage(_Message, frozen=True):
    """Something in the scene was clicked."""

    name: _Name
    instance_index: _Count | None
    ray_origin: _Three
    ray_direction: _Three
    screen_pos: _Two
    modifier: _Modifier | None
    owner: _Id = ""


class SceneNodeDragMessage(_Message, frozen=True):
    """Something in the scene is dragged."""

    phase: Literal["start", "update", "end"]
    name: _Name
    instance_index: _Count | None
    start_position: _Three
    start_screen_pos: _Two
    end_position: _Three
    end_screen_pos: _Two
    button: Literal["left", "middle", "right"]
    modifier: _Modifier | None
    owner: _Id = ""


class FileTransferStartUpload(_Message, frozen=True):
    """A file is about to be sent."""

    source_component_uuid: _Id
    transfer_uuid: _Id
    filename: Annotated[str, msgspec.Meta(max_length=4096)]
    mime_type: _Name
    part_count: _Count
    size_bytes: Annotated[int, msgspec.Meta(ge=0)]


class FileTransferPart(_Message, frozen=True):
    """A part of a file."""

    source_component_uuid: _Id | None
    transfer_uuid: _Id
    part_index: _Count
    content: bytes


Message = (
    ViewerCameraMessage
    | GuiUpdateMessage
    | CommandTriggerMessage
    | SceneNodeClickMessage
    | SceneNodeDragMessage
    | FileTransferStartUpload
    | FileTransferPart
)

_decoder = msgspec.msgpack.Decoder(Message)


def decode(data: str | bytes) -> Message:
    """Return the message that a frame holds.

    Raises:
        msgspec.MsgspecError: It holds none of these.
    """
    if isinstance(data, str):
        raise msgspec.ValidationError("a text frame")
    try:
        return _decoder.decode(data)
    except (RecursionError, UnicodeDecodeError) as error:
        raise msgspec.ValidationError(str(error)) from error
