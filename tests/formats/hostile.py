"""Files as large as any that is read, made to take long: read one after the other in a process that may not grow.

``python -m tests.formats.hostile`` prints for each what it was refused with and the CPU time; out of memory ends it.
"""

from __future__ import annotations

import json
import resource
import time
from pathlib import Path

import numpy as np

from fuzzy import formats, sets
from fuzzy.errors import FormatError
from fuzzy.formats import MAX_BYTES
from fuzzy.shapes import Sigmoid
from fuzzy.system import Term

MEMORY = 200 << 20
"""Bytes by which the process may grow."""

TRIES = 3
"""How often a slow file is read again: the least time counts, since other programs run, too."""


def _filled(head: bytes, piece: bytes, tail: bytes = b"") -> bytes:
    """Return a file of just the largest size, with as many pieces as fit."""
    return head + piece * ((MAX_BYTES - len(head) - len(tail)) // len(piece)) + tail


_YAML = b"schema: fuzzy-workbench/1\nname: x\n"
_ONE_TERM = b"{y: {range: [0, 1], terms: {a: {ramp: [0, 1]}}}}\n"
_FLL = b"Engine: x\nInputVariable: y\nrange: 0 1\nterm: a Ramp 0 1\n"
_FLL_RULES = (
    _FLL + b"OutputVariable: z\nrange: 0 1\ndefuzzifier: Centroid\nterm: b Ramp 0 1\nRuleBlock:\n"
    b"conjunction: Minimum\ndisjunction: Maximum\nimplication: Minimum\n"
)
_FCL = (
    b"FUNCTION_BLOCK x\nVAR_INPUT a : REAL; END_VAR\nVAR_OUTPUT b : REAL; END_VAR\n"
    b"FUZZIFY a TERM t := (0,0) (1,1); END_FUZZIFY\nDEFUZZIFY b TERM u := (0,0) (1,1); METHOD : COG; END_DEFUZZIFY\n"
    b"RULEBLOCK r\n"
)
_FIS = b"[System]\nType='mamdani'\nNumInputs=2\nNumOutputs=1\nNumRules=1\n"
_FIS_VARIABLE = b"Range=[0 1]\nNumMFs=1\nMF1='m':'trimf',[0 0.5 1]\n"
_FIS_RULES = _FIS + b"".join(
    b"[%b]\nName='%b'\n%b" % (name, name, _FIS_VARIABLE) for name in (b"Input1", b"Input2", b"Output1")
)
_XML = b'<fuzzySystem name="x"><knowledgeBase>'
_XML_VARIABLE = b'<fuzzyVariable name="a" domainleft="0" domainright="1">'

FILES = {
    "empty": b"",
    "one byte": b"\x00",
    "noise": bytes(range(256)) * 4096,
    "blanks": _filled(b"", b" \n"),
    "line ends": _filled(b"Engine: x\n", b"\n"),
    "carriage returns": _filled(b"[System]\r", b"\r"),
    "brackets": _filled(b"", b"("),
    "wide characters": ("[System]\n" + "é" * 500_000).encode("utf-16"),
    "sections": b"[System]\n" + b"".join(b"[Input%d]\n" % i for i in range(50_000)),
    "entries": b"[System]\n" + b"".join(b"k%d=1\n" % i for i in range(60_000)),
    "comments": _filled(b"[System]\n", b"%\n"),
    "quotes": _filled(b"[System]\nName='", b"'", b"\n"),
    "rules": _filled(b"[System]\n[Rules]\n", b"1 1, 1 (1) : 1\n"),
    "codes": _filled(_FIS_RULES + b"[Rules]\n", b"1 ", b", 1 (1) : 1\n"),
    "parameters": _filled(_FIS + b"[Input1]\nName='x'\nRange=[", b"0 ", b"]\n"),
    "surplus": _filled(_FIS_RULES.replace(b"[0 0.5 1]", b"[0 0.5 1"), b" 2", b"]\n"),
    "blocks": _filled(b"Engine: x\n", b"InputVariable: y\n"),
    "keys": _filled(b"Engine: x\n", b"a: 1\n"),
    "terms": _filled(b"Engine: x\nInputVariable: y\nrange: 0 1\n", b"term: a Triangle 0 1 2\n"),
    "numbers": _filled(b"Engine: x\nInputVariable: y\nrange: 0 1\nterm: a Discrete ", b"0 1 ", b"\n"),
    "coefficients": _filled(
        _FLL + b"OutputVariable: z\nrange: 0 1\ndefuzzifier: WeightedAverage\nterm: b Linear ", b"1 ", b"\n"
    ),
    "nested rule": _filled(_FLL_RULES + b"rule: if ", b"(", b"y is a then z is b\n"),
    "long rules": _filled(_FLL_RULES, b"rule: if " + b"(" * 9000 + b" y is a then z is b\n"),
    "hedges": _filled(_FLL_RULES + b"rule: if y is ", b"not ", b"a then z is b\n"),
    "long name": _filled(b"Engine: ", b"x"),
    "words": _filled(b"", b"FUNCTION_BLOCK x "),
    "comment": _filled(b"FUNCTION_BLOCK x (* ", b"* "),
    "many comments": _filled(b"FUNCTION_BLOCK x\n", b"(**)"),
    "declarations": b"FUNCTION_BLOCK x\nVAR_INPUT " + b"".join(b"a%d : REAL; " % i for i in range(70_000)),
    "points": _filled(b"FUNCTION_BLOCK x VAR_INPUT a : REAL; END_VAR FUZZIFY a TERM t := ", b"(1,1)"),
    "digits": _filled(b"FUNCTION_BLOCK x VAR_INPUT a : REAL; END_VAR FUZZIFY a TERM t := (", b"1"),
    "negations": _filled(_FCL + b"RULE 1 : IF ", b"NOT "),
    "alternatives": _filled(_FCL + b"RULE 1 : IF ", b"a IS t OR "),
    "conclusions": _filled(_FCL + b"RULE 1 : IF a IS t THEN ", b"b IS u, "),
    "elements": _filled(b"<fuzzySystem>", b"<a/>"),
    "attributes": b"<fuzzySystem " + b"".join(b'a%d="" ' % i for i in range(80_000)) + b"/>",
    "nested elements": _filled(b"", b"<a>"),
    "references": _filled(_XML, b"&lt;"),
    "sections of text": _filled(_XML, b"<![CDATA[x]]>"),
    "points of XML": _filled(
        _XML + _XML_VARIABLE + b'<fuzzyTerm name="t"><pointSetShape>', b'<point x="0" y="1"/>', b"</pointSetShape>"
    ),
    "clauses": _filled(_XML, b"<clause><variable>de</variable><term>Z</term></clause>"),
    "long number": _filled(_YAML + b"inputs: {y: {range: [0, ", b"9", b"]}}"),
    "scalars": _filled(_YAML + b"rules: {list: [", b"a,", b"]}"),
    "mappings": _filled(_YAML + b"inputs: ", b"{a: "),
    "lists": _filled(_YAML + b"inputs: ", b"["),
    "dashes": _filled(_YAML, b"- "),
    "question marks": _filled(_YAML, b"? "),
    "anchors": _filled(_YAML, b"&a "),
    "documents": _filled(_YAML, b"---\n"),
    "names": _YAML + b"inputs: {" + b",".join(b"%x" % i for i in range(150_000)) + b"}",
    "escapes": _filled(_YAML + b'notes: "', b"\\n", b'"\n'),
    "folded text": _filled(_YAML + b"notes: ", b"a\n  ", b"\n"),
    "more rules": _filled(
        _YAML + b"inputs: " + _ONE_TERM + b"outputs: " + _ONE_TERM.replace(b"y", b"z", 1) + b"rules:\n  list:\n",
        b"  - if y is a then z is a\n",
    ),
}

UNKNOWN = ("empty", "one byte", "noise", "blanks", "brackets")
"""Those whose content names no format."""


def _read(name: str, suffix: str) -> tuple[str, float]:
    """Return what a file is refused with, nothing if it is not, and the CPU time."""
    message, best = "", float("inf")
    for _ in range(TRIES):
        start = time.process_time()
        try:
            formats.from_bytes(FILES[name], f"x{suffix}")
        except FormatError as error:
            message = str(error)
        best = min(best, time.process_time() - start)
        if best < 0.5:
            break
    return message, best


def main() -> None:
    """Read all files."""
    formats.load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")
    sets.degrees(Term("a", Sigmoid(0.0, 1.0)), np.zeros(3))  # whatever is compiled and loaded is so from here on
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    limit = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    found = {name: _read(name, "") for name in FILES}
    print(json.dumps(found | {f"{name}.yaml": _read(name, ".yaml") for name in UNKNOWN}))


if __name__ == "__main__":
    main()
