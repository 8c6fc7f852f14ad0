"""Colours mean values: what an output term is worth, wherever it stands among the others."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.palette import RGB, ink, scale_colors, term_colors
from fuzzy.shapes import Linear, Singleton, Trapezoid, Triangle
from fuzzy.system import Input, Output, Term

INF = float("inf")
VALUES = st.lists(st.integers(-100, 100), min_size=1, max_size=12, unique=True)


def output(*values: float) -> Output:
    return Output("T", -100.0, 100.0, tuple(Term(f"t{n}", Singleton(value)) for n, value in enumerate(values)))


def of_share(share: float) -> RGB:
    red, green, blue = scale_colors(np.array([share]))[0].round().astype(int).tolist()
    return red, green, blue


def warmth(color: RGB) -> int:
    return color[0] - color[2]


@given(VALUES, st.randoms())
def test_a_value_has_its_colour_in_any_order(values: list[int], chance: object) -> None:
    shuffled = sorted(values, key=lambda _: chance.random())  # type: ignore[attr-defined]
    by_value = dict(zip(values, term_colors(output(*values)), strict=True))
    assert dict(zip(shuffled, term_colors(output(*shuffled)), strict=True)) == by_value
    greatest = [warmth(by_value[value]) for value in sorted(values)]
    assert greatest == sorted(greatest), "what is greater is not bluer"


@pytest.mark.parametrize(
    ("shape", "share"),
    [
        (Singleton(0.0), 0.5),
        (Singleton(-100.0), 0.0),
        (Singleton(1e6), 1.0),
        (Triangle(-20.0, 50.0, 60.0), 0.75),
        (Triangle(-INF, -100.0, -50.0), 0.0),
        (Trapezoid(-INF, -INF, 0.0, 50.0), 0.25),
        (Linear((3.0, -2.0), 40.0), 0.7),
    ],
)
def test_the_colour_is_that_of_the_surface_at_the_place_of_the_set(shape: object, share: float) -> None:
    terms = (Term("it", shape),)  # type: ignore[arg-type]
    assert term_colors(Output("T", -100.0, 100.0, terms)) == (of_share(share),)


def test_terms_of_an_input_differ_as_much_as_they_can() -> None:
    terms = tuple(Term(f"t{n}", Triangle(0.1 * n, 0.1 * n + 0.1, 0.1 * n + 0.2)) for n in range(3))
    near = Input("e", -100.0, 100.0, terms)
    assert term_colors(near) == (of_share(0.0), of_share(0.5), of_share(1.0))
    assert term_colors(msgspec.structs.replace(near, terms=terms[:1])) == (of_share(0.5),)


@given(st.floats(0.0, 1.0))
def test_names_are_legible_on_every_colour(share: float) -> None:
    def luminance(color: RGB) -> float:
        linear = [c / 255 / 12.92 if c <= 10 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in color]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    color = of_share(share)
    text = ink(color)
    there = luminance((int(text[1:3], 16), int(text[3:5], 16), int(text[5:7], 16)))
    light, dark = sorted((luminance(color), there), reverse=True)
    assert (light + 0.05) / (dark + 0.05) >= 3.0, f"{text} on {color}"
