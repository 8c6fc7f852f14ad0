"""Names, texts and counts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fuzzy.errors import InvalidSystemError
from fuzzy.limits import MAX_NAME


def check_count(entries: Sequence[object], what: str, path: str, most: int) -> None:
    """Refuse none, and too many."""
    if not 1 <= len(entries) <= most:
        raise InvalidSystemError(f"{len(entries)} {what}: valid are 1 to {most}", path)


def check_name(name: str, path: str, what: str) -> None:
    """Refuse a name that is empty, too long, or not to be read."""
    if not name:
        raise InvalidSystemError(f"{what} is empty", path)
    if len(name) > MAX_NAME:
        raise InvalidSystemError(f"{what} has {len(name)} characters: at most {MAX_NAME}", path)
    if not name.isprintable():
        raise InvalidSystemError(f"{what} {name!r} holds a character that cannot be printed", path)
    if name != name.strip():
        raise InvalidSystemError(f"{what} '{name}' begins or ends with a blank", path)


def check_text(text: str, path: str, most: int) -> None:
    """Refuse a text that is too long or holds what cannot be printed; it may have several lines."""
    if len(text) > most:
        raise InvalidSystemError(f"{len(text)} characters: at most {most}", path)
    if not text.replace("\n", "").replace("\t", "").isprintable():
        wrong = next(letter for letter in text if not (letter.isprintable() or letter in "\n\t"))
        raise InvalidSystemError(f"holds the character {wrong!r}, which cannot be printed", path)


def check_unique(names: Iterable[tuple[str, str]]) -> None:
    """Refuse a name that is used twice, at the path of its second use."""
    seen: set[str] = set()
    for name, path in names:
        if name in seen:
            raise InvalidSystemError(f"the name '{name}' is used twice", path)
        seen.add(name)
