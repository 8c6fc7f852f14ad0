"""What is remembered of objects by their identity."""

from __future__ import annotations

import gc

from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy import compile_system
from fuzzy.identity import ByIdentity, remembered
from fuzzy.system import FuzzySystem, Is, RuleBase
from tests import strategies


def test_the_same_object_is_known_and_an_equal_one_is_not():
    known: ByIdentity[str] = ByIdentity(2)
    one, other = (1.5, "a"), (2.5,)
    equal = (one[0], one[1])
    known.put("both", one, other)
    known.put("one", one)
    assert known.get(one, other) == "both"
    assert known.get(equal, other) is None
    assert known.get_each([one, other]) == ["one", None]


def test_what_can_change_is_not_kept():
    known: ByIdentity[str] = ByIdentity(2)
    growing = ([1],)
    known.put("found", growing)
    assert known.get(growing) is None


def test_the_oldest_are_forgotten_and_no_identity_is_confused():
    known: ByIdentity[int] = ByIdentity(3)
    for number in range(200):
        known.put(number, (number, "text"))  # the tuple itself is kept alive by nothing else
        gc.collect(0)
        fresh = (number + 1000, "text")
        assert known.get(fresh) is None
    kept = [("kept", number) for number in range(5)]
    for number, each in enumerate(kept):
        known.put(number, each)
    assert known.get_each(kept) == [None, None, 2, 3, 4]


def test_a_function_computes_once_for_the_same_objects():
    calls = []

    @remembered(2)
    def measured(text: tuple[str, ...]) -> int:
        calls.append(text)
        return len(text)

    one = ("a", "b")
    assert measured(one) == measured(one) == 2
    assert measured(("a", *one[1:])) == 2
    assert len(calls) == 2


@given(strategies.systems(), st.data())
def test_after_an_edit_of_a_rule_the_tables_are_those_of_a_new_system(system: FuzzySystem, data: st.DataObject):
    compile_system(system)
    listed = list(system.rules.list)
    if not listed:
        return
    number = data.draw(st.integers(0, len(listed) - 1))
    output = data.draw(st.sampled_from(system.outputs))
    term = data.draw(st.sampled_from(output.terms))
    listed[number] = replace(
        listed[number], consequents=(Is(output.name, term.name),), weight=data.draw(st.floats(0, 1))
    )
    edited = replace(system, rules=RuleBase(system.rules.table, tuple(listed)))
    quick = compile_system(edited).tables
    # The same document of new objects has to be compiled from the beginning.
    inputs, outputs = (tuple(replace(variable) for variable in group) for group in (edited.inputs, edited.outputs))
    fresh = compile_system(replace(edited, inputs=inputs, outputs=outputs)).tables
    for part, other in zip(quick[:3], fresh[:3], strict=True):
        for array, wanted in zip(part, other, strict=True):
            assert array.tobytes() == wanted.tobytes()
            assert array.shape == wanted.shape
