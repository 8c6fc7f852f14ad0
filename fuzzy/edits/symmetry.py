"""Symmetric editing: the terms on one side of a variable's middle are the mirror image of those on the other."""

from __future__ import annotations

import math

from msgspec.structs import replace

from fuzzy import motion, partition, shapes
from fuzzy.edits.access import changed, find, path_of, term_number
from fuzzy.errors import InvalidSystemError
from fuzzy.shapes import Shape
from fuzzy.system import FuzzySystem, Term


def follow_in_mirror(before: FuzzySystem, after: FuzzySystem, variable: str, term: str) -> FuzzySystem:
    """Return ``after`` with the other side of a variable as the mirror image of the side that was edited.

    Opposite terms are paired by where they stand; the mirror is the middle of the range. The middle term of an odd
    number keeps what was moved and gets the mirror image of that.

    Args:
        before: The system before an edit of shapes.
        after: The system after it, with the same terms.
        variable: The variable that was edited.
        term: The term that was edited.

    Raises:
        InvalidSystemError: If the middle term would leave the middle.
    """
    old, new = find(before, variable), find(after, variable)
    middle = (new.low + new.high) / 2
    order = partition.order(old.terms)
    edited = order.index(term_number(old, term))
    count = len(order)
    is_left = edited <= (count - 1) / 2
    terms = list(new.terms)
    for place in range(count // 2):
        source, target = order[place], order[count - 1 - place]
        if not is_left:
            source, target = target, source
        terms[target] = replace(terms[target], shape=motion.reflected(terms[source].shape, middle))
    if count % 2:
        number = order[count // 2]
        path = f"{path_of(new)}.terms.{old.terms[number].name}"
        terms[number] = _symmetric(old.terms[number], new.terms[number], middle, path)
    return changed(after, new, terms=tuple(terms))


def _symmetric(before: Term, after: Term, middle: float, path: str) -> Term:
    """Return the middle term with the moved points and their images."""
    image = motion.reflected(after.shape, middle)
    values_before = shapes.parameters(before.shape)
    if type(before.shape) is not type(image) or len(values_before) != len(shapes.parameters(image)):
        values = shapes.parameters(after.shape)
    else:
        moved = zip(values_before, shapes.parameters(after.shape), strict=True)
        pairs = zip(moved, shapes.parameters(image), strict=True)
        values = [new if new != old else mirror for (old, new), mirror in pairs]
    shape = shapes.build(shapes.kind(after.shape), values)
    if not _is_near(motion.reflected(shape, middle), shape):
        message = f"'{after.name}' is the middle term: while editing is symmetric it stays in the middle, {middle:g}"
        raise InvalidSystemError(message, path)
    return replace(after, shape=shape)


def _is_near(one: Shape, other: Shape) -> bool:
    if type(one) is not type(other):
        return False
    pairs = zip(shapes.parameters(one), shapes.parameters(other), strict=True)
    return all(math.isclose(first, second, rel_tol=1e-9, abs_tol=1e-12) for first, second in pairs)
