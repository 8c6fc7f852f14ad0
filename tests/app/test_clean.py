"""What a browser may send: every hostile value is refused with a sentence, every valid one comes back unchanged."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app import clean
from app.clean import Refused

HOSTILE: list[Any] = [None, True, math.nan, math.inf, -math.inf, 10**400, "1", b"1", [1], {}, "x" * 10_000]


@given(st.floats(-5, 5))
def test_a_number_in_range_comes_back(value: float) -> None:
    assert clean.number(value, -5, 5) == value


@given(st.floats())
def test_a_number_is_in_range_or_refused(value: float) -> None:
    try:
        assert -5 <= clean.number(value, -5, 5) <= 5
    except Refused:
        assert not -5 <= value <= 5


@pytest.mark.parametrize("value", HOSTILE, ids=lambda value: repr(value)[:20])
def test_a_number_refuses_what_is_not_a_finite_number(value: Any) -> None:
    with pytest.raises(Refused, match=r"^the weight is .{1,60}; valid is a number from 0 to 1$"):
        clean.number(value, 0, 1, "the weight")


def test_an_integer_becomes_a_float() -> None:
    assert type(clean.number(1, 0, 1)) is float


def test_a_value_just_outside_is_shown_with_enough_digits() -> None:
    with pytest.raises(Refused, match=r"is 1\.0000001;"):
        clean.number(1.0000001, 0, 1)


def test_a_choice_is_listed_or_refused_with_what_is_valid() -> None:
    assert clean.choice("max", ["min", "max"]) == "max"
    with pytest.raises(Refused, match=r"^the norm is 'mx'; did you mean 'max'\? valid: min, max$"):
        clean.choice("mx", ["min", "max"], "the norm")


@pytest.mark.parametrize("value", [None, 3, math.nan, [], "x" * 10_000], ids=lambda value: repr(value)[:20])
def test_a_choice_refuses_what_is_not_listed(value: Any) -> None:
    with pytest.raises(Refused) as refused:
        clean.choice(value, ["min", "max"])
    assert len(str(refused.value)) < 200


def test_a_switch_is_true_or_false() -> None:
    assert clean.flag(True) is True
    for value in (0, 1, "true", None):
        with pytest.raises(Refused, match="valid are true and false"):
            clean.flag(value)


@pytest.mark.parametrize("value", ["NB", "ė", "very negative", "NO", "<img src=x onerror=alert(1)>", "x" * 64])
def test_printable_names_are_valid(value: str) -> None:
    assert clean.name(f" {value} ") == value


@pytest.mark.parametrize("value", ["", "  ", "a\nb", "a\x00", "\u202eabc", "\ud800", "x" * 65, "x" * 10**6, 5, None])
def test_names_that_cannot_be_shown_are_refused(value: Any) -> None:
    with pytest.raises(Refused) as refused:
        clean.name(value, "the term's name")
    assert str(refused.value).startswith("the term's name ")
    assert str(refused.value).isprintable()


@pytest.mark.parametrize("value", ["diagonal.yaml", "a.b-c_D9.yaml", "x" * 59 + ".yaml"])
def test_plain_file_names_are_valid(value: str) -> None:
    assert clean.file_name(value) == value


@pytest.mark.parametrize(
    "value",
    [
        *["", ".yaml", ".a.yaml", "..", "../a.yaml", "a/b.yaml", "a\\b.yaml", "/etc/passwd", "a.yml", "a.yaml\n"],
        *["a b.yaml", "ä.yaml", "x" * 60 + ".yaml", "a.yaml\x00", None, b"a.yaml", "C:a.yaml"],
    ],
)
def test_file_names_with_a_folder_or_another_ending_are_refused(value: Any) -> None:
    with pytest.raises(Refused):
        clean.file_name(value)


@given(st.text())
def test_a_valid_file_name_is_its_own_last_part(value: str) -> None:
    name = f"{value}.yaml"
    try:
        assert clean.file_name(name) == name
    except Refused:
        return
    assert "/" not in name
    assert "\\" not in name
    assert not name.startswith(".")


def test_uploads_are_capped() -> None:
    assert clean.upload("a.yaml", b"x") == ("a.yaml", b"x")
    with pytest.raises(Refused, match=r"a\.yaml has 1048577 bytes; valid are at most 1048576"):
        clean.upload("a.yaml", b"x" * (clean.MAX_UPLOAD + 1))
    with pytest.raises(Refused, match="valid are bytes"):
        clean.upload("a.yaml", "text")
