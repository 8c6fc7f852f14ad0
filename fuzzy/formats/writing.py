"""A system as the text of any format."""

from __future__ import annotations

from typing import NamedTuple, assert_never

from fuzzy.errors import InvalidSystemError
from fuzzy.formats import yaml_writer
from fuzzy.formats.detection import TITLES, Format
from fuzzy.formats.fcl import writer as fcl
from fuzzy.formats.files import MAX_BYTES
from fuzzy.formats.fis import writer as fis
from fuzzy.formats.fll import writer as fll
from fuzzy.formats.fml import writer as fml
from fuzzy.formats.saying import Adapter
from fuzzy.system import FuzzySystem
from fuzzy.validation import validate


class Written(NamedTuple):
    """The text of a file, and what was written instead of what its format cannot say, a sentence each."""

    text: str
    substitutes: tuple[str, ...] = ()


def write(system: FuzzySystem, kind: Format, *, lossy: bool = False) -> Written:
    """Return a system as the text of a file.

    Args:
        system: A valid system.
        kind: The format.
        lossy: Whether something else may be written for what the format cannot say.

    Raises:
        InvalidSystemError: If the system is not valid, too large to be read again, or the format cannot say it.
    """
    system = validate(system)
    adapter = Adapter(TITLES[kind], lossy=lossy)
    match kind:
        case "yaml":
            text = yaml_writer.write(system)
        case "fis":
            text = fis.write(system, adapter)
        case "fll":
            text = fll.write(system, adapter)
        case "fcl":
            text = fcl.write(system, adapter)
        case "fml":
            text = fml.write(system, adapter)
        case _:
            assert_never(kind)
    size = len(text.encode())
    if size > MAX_BYTES:
        raise InvalidSystemError(f"the system takes {size} bytes as a file: at most {MAX_BYTES} are read again")
    return Written(text, tuple(dict.fromkeys(adapter.substitutes)))
