"""The rule bases that come with the program, and where they are opened for editing."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

SHIPPED = Path(__file__).resolve().parents[1] / "rulebases" / "diagonal.yaml"
"""The rule base that is opened where none is named."""


def is_checkout() -> bool:
    """Tell whether the program runs from its sources rather than from an installed wheel."""
    return (SHIPPED.parents[1] / "pyproject.toml").is_file()


def own_folder() -> Path:
    """Return the folder in which an installed program edits: below ``XDG_DATA_HOME``, by default ``~/.local/share``."""
    home = os.environ.get("XDG_DATA_HOME")
    return (Path(home) if home else Path.home() / ".local" / "share") / "fuzzy-workbench" / "rulebases"


def editable() -> Path:
    """Return the shipped rule base where it can be edited.

    In a checkout that is the file itself. The folder of an installed program may be read-only, and is replaced with
    the next version: there it is a copy in the user's own folder, made when it is missing and never replaced.

    Raises:
        OSError: The copy cannot be made.
    """
    if is_checkout():
        return SHIPPED
    folder = own_folder()
    folder.mkdir(parents=True, exist_ok=True)
    for source in sorted(SHIPPED.parent.iterdir()):
        target = folder / source.name
        if source.is_file() and source.suffix != ".py" and not target.exists():
            shutil.copyfile(source, target)
    return folder / SHIPPED.name
