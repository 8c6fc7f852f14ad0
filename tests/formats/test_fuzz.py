"""Damaged files of every format: read, or refused with a place, in time; never a traceback.

``make fuzz`` runs a hundred thousand inputs (FUZZ_EXAMPLES); here it is a quick share.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy import formats
from fuzzy.errors import FormatError
from fuzzy.formats.detection import FORMATS
from fuzzy.shapes import Linear, Ramp, Singleton, ZShape
from fuzzy.system import Inference, Term
from fuzzy.validation import validate
from tests.formats.conformance import FILES, FOLDER

EXAMPLES = int(os.environ.get("FUZZ_EXAMPLES", "800"))
ROOT = Path(__file__).parents[2]
RULEBASES = ROOT / "rulebases"
LINE_ENDS = (b"\n", b"\r", b"\xc2\x85", b"\xe2\x80\xa8", b"\xe2\x80\xa9")
SUFFIXES = (".yaml", ".fis", ".fll", ".fcl", ".xml", "")


def seeds() -> list[bytes]:
    """Return the public cases, and our own rule bases in every format."""
    own = [formats.load(path) for path in sorted(RULEBASES.glob("*.yaml"))[:2]]
    found = [formats.write(system, kind, lossy=True).text.encode() for system in own for kind in FORMATS]
    for shapes in ((Singleton(1.0), Linear((2.0, -3.0), 1.0)), (Ramp(-85, 85), ZShape(-40, 85))):
        terms = tuple(Term(term.name, shapes[i % 2]) for i, term in enumerate(own[0].outputs[0].terms))
        weighted = Inference(aggregation="sum", defuzzifier="weighted_average")
        system = replace(own[0], outputs=(replace(own[0].outputs[0], terms=terms),), inference=weighted)
        found += [formats.write(system, kind, lossy=True).text.encode() for kind in ("fll", "fml")]
    return found + [(FOLDER / file).read_bytes() for file in FILES] if FOLDER else found


SEEDS = seeds()

_marks = b"[ ] ( ) ' \" , ; : := .. % # // /* (* <!-- &lt;".split()
_numbers = b"nan inf -inf 1e999 -1e308 0 -0.0 99999999999999999999 1e-320 0x1 1_0".split()
_bytes = [b"\n", b"\r", b"\t", b"\x00", b"\xff", b"\xfe\xff", b"\xef\xbb\xbf", b"\xc3(", b"\xe2\x80\xa8", b"\x1a"]
_words = [
    b"not ",
    b"very ",
    b"any ",
    b"and ",
    b" or ",
    b" is ",
    b"if ",
    b"then ",
    b"with ",
    b"RULE 1 : ",
    b"TERM x := ",
]
_lines = [b"[Rules]\n", b"[Input1]\n", b"Engine: x\n", b"RuleBlock:\n", b"END_RULEBLOCK", b"<rule>", b"</clause>"]
_pieces = st.one_of(
    *(st.sampled_from(kind) for kind in (_marks, _numbers, _bytes, _words, _lines)), st.binary(max_size=6)
)


@st.composite
def damaged(draw: st.DrawFn) -> tuple[bytes, str]:
    """A file with a few pieces replaced, moved, doubled or cut off."""
    content = draw(st.sampled_from(SEEDS))
    for _ in range(draw(st.integers(0, 4))):
        start = draw(st.integers(0, len(content)))
        end = min(len(content), start + draw(st.integers(0, 40)))
        match draw(st.integers(0, 5)):
            case 0 | 1:
                content = content[:start] + draw(_pieces) + content[end:]
            case 2:
                content = content[:end] + content[start:end] * draw(st.integers(1, 50)) + content[end:]
            case 3:
                content = content[:start] + content[end:]
            case 4:
                content = content[:start] + draw(st.sampled_from(SEEDS))[start:]
            case _:
                content = content[:start]
    return content, "x" + draw(st.sampled_from(SUFFIXES))


@settings(max_examples=EXAMPLES)
@given(damaged())
def test_a_damaged_file_is_read_whole_or_refused_with_a_place(case: tuple[bytes, str]) -> None:
    content, name = case
    refused = None
    try:
        imported = formats.from_bytes(content, name)
        assert validate(imported.system) == imported.system
    except FormatError as error:
        refused = error
    if refused is not None:
        assert str(refused).startswith(f"{name}:{refused.line}:{refused.column}: error: ")
        assert len(str(refused)) < 4000
        assert refused.line <= sum(content.count(end) for end in LINE_ENDS) + 2


@pytest.fixture(scope="module")
def hostile() -> dict[str, tuple[str, float]]:
    """What every hostile file is refused with, and the CPU time, in a process that may grow by 200 MiB only."""
    command = [sys.executable, "-m", "tests.formats.hostile"]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr[-2000:]
    return json.loads(found.stdout)


def test_hostile_files_are_refused_in_a_second_and_200_megabytes(hostile: dict[str, tuple[str, float]]) -> None:
    for name, (message, seconds) in hostile.items():
        assert re.match(r"x(\.yaml)?:\d+:\d+: error: ", message), name
        assert len(message) < 1000, name
        assert seconds < 1, name


def test_files_that_are_none(tmp_path: Path) -> None:
    for suffix in (".fis", ".fll", ".fcl", ".xml", ".yaml"):
        folder = tmp_path / f"folder{suffix}"
        folder.mkdir()
        with pytest.raises(FormatError, match="folder"):
            formats.load(folder)
        with pytest.raises(FormatError, match="No such file"):
            formats.load(tmp_path / f"missing{suffix}")
        pipe = tmp_path / f"pipe{suffix}"
        os.mkfifo(pipe)
        with pytest.raises(FormatError, match="no regular file"):
            formats.load(pipe)
        huge = tmp_path / f"huge{suffix}"
        with huge.open("wb") as file:
            file.truncate(100 << 20)
        with pytest.raises(FormatError, match="larger than 1048576 bytes"):
            formats.load(huge)
