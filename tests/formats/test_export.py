"""Controllers as C99 and Python code: compiled, run, and compared with the kernel."""

from __future__ import annotations

import ctypes
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.typing import NDArray

from fuzzy import compile_system, edits, formats
from fuzzy.errors import InvalidSystemError
from fuzzy.export.c_code import c_files
from fuzzy.export.python_code import python_file
from fuzzy.shapes import Bell, Linear, Points, Rectangle, Singleton, SShape, Trapezoid, Triangle
from fuzzy.system import (
    And,
    FuzzySystem,
    Hedged,
    Inference,
    Input,
    Is,
    NoFire,
    Not,
    Or,
    Output,
    Rule,
    RuleBase,
    Sampling,
    Term,
)

RULEBASES = Path(__file__).parents[2] / "rulebases"
POINTS = 100_000
COMPILER = shutil.which("gcc")


def mixed(**inference: Any) -> FuzzySystem:
    """A system with curves, hedges, weights, jumps, heights, complements, an input of no rule and two outputs."""
    inputs = (
        Input("x", -2.0, 3.0, (Term("low", SShape(-1, 2), complement=True), Term("high", Bell(2, 1, 1.5), height=0.9))),
        Input(
            "y",
            0.0,
            1.0,
            (Term("n", Triangle(-math.inf, 0, 0.75)), Term("p", Points(((0.2, 0), (0.5, 0.3), (0.5, 0.8))))),
        ),
        Input("unused */ ?? name", 0.0, 1.0, (Term("any", Rectangle(0, 1)),)),
    )
    terms = (
        Term("left", Triangle(-math.inf, -10, 0)),
        Term("wide", Trapezoid(-8, -3, 4, 4), height=0.75),
        Term("right", Triangle(2, 9, 15)),
        Term("not wide", Trapezoid(-8, -3, 4, 4.5), complement=True),
    )
    outputs = (
        Output("u", -10.0, 10.0, terms, no_fire=NoFire("default", 1.5)),
        Output("v", -10.0, 12.0, terms[:3], no_fire=NoFire("midpoint")),
    )
    rules = (
        Rule(And((Is("x", "low"), Not(Is("y", "n")))), (Is("u", "left"), Is("v", "right"))),
        Rule(Or((Hedged(Is("x", "high"), "very"), Is("y", "p"))), (Is("u", "right"),), 0.7),
        Rule(And((Is("x", "high"), Is("y", "n"))), (Is("u", "wide"), Is("v", "wide"))),
        Rule(Hedged(Is("y", "p"), "seldom"), (Is("u", "not wide"), Is("v", "right")), 0.4),
        Rule(Is("y", "p"), (Is("u", "left"), Is("v", "left")), 0.3),
    )
    return FuzzySystem("a */ controller", inputs, outputs, RuleBase(None, rules), Inference(**inference))


def sugeno() -> FuzzySystem:
    system = mixed(defuzzifier="weighted_average", aggregation="sum")
    terms = (
        Term("left", Singleton(-20)),
        Term("wide", Linear((1.0, -2.0, 0.5), 3.0)),
        Term("right", Singleton(7)),
        Term("not wide", Linear((0.0, 0.0, 0.0), -1.0)),
    )
    return replace(system, outputs=tuple(replace(entry, terms=terms) for entry in system.outputs))


EXACT = {
    "diagonal": formats.load(RULEBASES / "diagonal.yaml"),
    "piltan": formats.load(RULEBASES / "piltan.yaml"),
    "clipped": mixed(),
    "scaled": mixed(implication="product", conjunction="product", disjunction="algebraic_sum"),
    "summed": mixed(aggregation="sum"),
    "summed scaled": mixed(implication="product", defuzzifier="center_of_sums"),
    "sampled": mixed(resolution=Sampling(101, "endpoints"), conjunction="einstein_product"),
    "sampled norms": mixed(resolution=Sampling(64), implication="hamacher_product", aggregation="einstein_sum"),
    "trapezoidal": mixed(resolution=Sampling(50, "trapezoid"), disjunction="nilpotent_maximum"),
    "sampled Kleene-Dienes": mixed(resolution=Sampling(64), implication="kleene_dienes", aggregation="hamacher_sum"),
    "sampled sums": mixed(resolution=Sampling(64), implication="algebraic_sum"),
    "bisector": mixed(defuzzifier="bisector"),
    "bisector of Kleene-Dienes": mixed(defuzzifier="bisector", implication="kleene_dienes", aggregation="min"),
    "mean of maxima": mixed(defuzzifier="mom", implication="product"),
    "smallest of maxima": mixed(defuzzifier="som", implication="nilpotent_minimum"),
    "largest of maxima": mixed(defuzzifier="lom", implication="bounded_sum", aggregation="sum"),
    "smallest magnitude": mixed(defuzzifier="som_abs", implication="algebraic_sum"),
    "largest magnitude": mixed(defuzzifier="lom_abs", implication="bounded_difference"),
    "bounded sum": mixed(aggregation="bounded_sum", implication="algebraic_sum"),
    "least Kleene-Dienes": mixed(implication="kleene_dienes", aggregation="min"),
    "drastic product": mixed(implication="drastic_product", aggregation="sum"),
    "sugeno": sugeno(),
    "strongest sugeno": replace(sugeno(), inference=Inference(defuzzifier="weighted_sum")),
}


def compiled(folder: Path, source: str, header: str, *, is_single: bool = False) -> Any:
    """Return the function of a .c file, compiled with every warning an error."""
    assert COMPILER, "the tests of exported C code need gcc"
    (folder / "controller.c").write_text(source, encoding="ascii")
    (folder / "controller.h").write_text(header, encoding="ascii")
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2", "-ffp-contract=off", "-shared", "-fPIC"]
    library = folder / "controller.so"
    command = [COMPILER, *flags, "-o", str(library), str(folder / "controller.c"), "-lm"]
    subprocess.run(command, check=True, capture_output=True)
    function = ctypes.CDLL(str(library)).controller_evaluate
    number = ctypes.c_float if is_single else ctypes.c_double
    function.argtypes = [ctypes.POINTER(number), ctypes.POINTER(number)]
    function.restype = ctypes.c_int
    return function


def random_inputs(system: FuzzySystem, count: int) -> NDArray[np.float64]:
    """Return inputs of which some lie outside their ranges."""
    random = np.random.default_rng(1)
    margins = [(entry.high - entry.low) / 50 for entry in system.inputs]
    columns = [
        random.uniform(entry.low - margin, entry.high + margin, count)
        for entry, margin in zip(system.inputs, margins, strict=True)
    ]
    return np.column_stack(columns)


def evaluated(function: Any, x: NDArray[Any], n_out: int) -> NDArray[Any]:
    y = np.zeros((len(x), n_out), dtype=x.dtype)
    number = ctypes.c_float if x.dtype == np.float32 else ctypes.c_double
    step, out_step, at, out = x.strides[0], y.strides[0], x.ctypes.data, y.ctypes.data
    pointer = ctypes.POINTER(number)
    for i in range(len(x)):
        function(ctypes.cast(at + i * step, pointer), ctypes.cast(out + i * out_step, pointer))
    return y


@pytest.mark.parametrize("name", EXACT)
def test_c_code_gives_the_kernels_outputs(name: str, tmp_path: Path) -> None:
    system = EXACT[name]
    files = c_files(system, "controller")
    function = compiled(tmp_path, files.source, files.header)
    x = random_inputs(system, POINTS if name == "diagonal" else POINTS // 20)
    wanted = compile_system(system).batch(x)
    width = np.array([entry.high - entry.low for entry in system.outputs])
    np.testing.assert_allclose(evaluated(function, x, len(width)) / width, wanted / width, rtol=0, atol=1e-12)
    assert ("math.h" in files.source) == (name not in ("diagonal", "piltan"))
    assert "malloc" not in files.source


@pytest.mark.parametrize("name", ["clipped", "bisector", "mean of maxima", "least Kleene-Dienes"])
def test_all_hundred_thousand_points_of_a_mixed_system(name: str, tmp_path: Path) -> None:
    system = EXACT[name]
    files = c_files(system, "controller")
    x = random_inputs(system, POINTS)
    found = evaluated(compiled(tmp_path, files.source, files.header), x, 2)
    np.testing.assert_allclose(found, compile_system(system).batch(x), rtol=0, atol=2e-11)


@pytest.mark.parametrize(("name", "points"), [("diagonal", 41), ("clipped", 15)])
@pytest.mark.parametrize("is_single", [False, True])
def test_a_lookup_table_is_as_good_as_it_says(name: str, points: int, is_single: bool, tmp_path: Path) -> None:
    system = EXACT[name]
    files = c_files(system, "controller", table=points, is_single=is_single)
    function = compiled(tmp_path, files.source, files.header, is_single=is_single)
    x = random_inputs(system, POINTS)
    if is_single:
        x = np.ascontiguousarray(x[: POINTS // 10], dtype=np.float32)
    error = np.abs(evaluated(function, x, len(files.bounds)) - compile_system(system).batch(x)).max(axis=0)
    assert (error <= files.bounds).all()
    assert (error >= np.array(files.bounds) / 10).all()
    assert f"largest error of the table: {files.bounds[0]:.3g}" in files.source


def test_single_precision_of_curved_inputs(tmp_path: Path) -> None:
    system = EXACT["clipped"]
    files = c_files(system, "controller", is_single=True)
    x = np.ascontiguousarray(random_inputs(system, 2_000), dtype=np.float32)
    found = evaluated(compiled(tmp_path, files.source, files.header, is_single=True), x, 2)
    np.testing.assert_allclose(found, compile_system(system).batch(x.astype(np.float64)), rtol=0, atol=2e-3)


@pytest.mark.parametrize(
    "system",
    [EXACT["diagonal"], *(edits.set_inference(EXACT["diagonal"], defuzzifier=word) for word in ("bisector", "lom"))],
)
def test_single_precision(system: FuzzySystem, tmp_path: Path) -> None:
    files = c_files(system, "controller", is_single=True)
    x = np.ascontiguousarray(random_inputs(system, 5_000), dtype=np.float32)
    found = evaluated(compiled(tmp_path, files.source, files.header, is_single=True), x, 1)
    wanted = compile_system(system).batch(x)
    # Where two plateaus are nearly as high, a float may take the other one.
    is_other = np.abs(found - wanted) > 170 * 2e-5
    assert is_other.mean() <= (0.001 if system.inference.defuzzifier == "lom" else 0)


def test_bad_inputs_and_holding(tmp_path: Path) -> None:
    system = EXACT["diagonal"]
    held = replace(
        system,
        outputs=(replace(system.outputs[0], no_fire=NoFire("hold")),),
        rules=replace(system.rules, table=None, list=(Rule(Is("e", "PB"), (Is("T", "LL"),)),)),
    )
    files = c_files(held, "controller")
    function = compiled(tmp_path, files.source, files.header)
    y = (ctypes.c_double * 1)(42.0)
    for bad in (math.nan, math.inf, -math.inf):
        assert function((ctypes.c_double * 2)(bad, 0.0), y) == -1
        assert y[0] == 42.0
    assert function((ctypes.c_double * 2)(-1.0, 0.0), y) == 0
    assert y[0] == 42.0


@pytest.mark.parametrize(
    "system",
    [
        mixed(defuzzifier="bisector", resolution=Sampling(101)),
        mixed(resolution=Sampling(101, "polygon")),
        mixed(aggregation="min", resolution=Sampling(101)),
        mixed(implication="hamacher_product"),
        mixed(aggregation="einstein_sum"),
        replace(mixed(), outputs=tuple(replace(o, terms=(*o.terms, Term("g", SShape(0, 9)))) for o in mixed().outputs)),
        replace(mixed(), rules=RuleBase(None, (Rule(Is("u", "left"), (Is("v", "left"),)),))),
    ],
)
def test_what_is_not_exported_is_named(system: FuzzySystem) -> None:
    with pytest.raises(InvalidSystemError, match=r"C code has no .*--table N"):
        c_files(system, "controller")
    with pytest.raises(InvalidSystemError, match="Python code has no"):
        python_file(system)


def test_tables_that_are_too_large_or_undefined_are_refused() -> None:
    with pytest.raises(InvalidSystemError, match="at most 1000000 values"):
        c_files(mixed(), "controller", table=200)
    system = mixed()
    nan = replace(system, outputs=tuple(replace(entry, no_fire=NoFire("nan")) for entry in system.outputs))
    nan = replace(nan, rules=RuleBase(None, nan.rules.list[:1]))
    with pytest.raises(InvalidSystemError, match="undefined somewhere"):
        c_files(nan, "controller", table=5)


@pytest.mark.parametrize("name", EXACT)
def test_python_code_gives_the_kernels_outputs(name: str) -> None:
    system = EXACT[name]
    names: dict[str, Any] = {}
    exec(compile(python_file(system), "exported.py", "exec"), names)
    x = random_inputs(system, 300)
    found = np.array([np.atleast_1d(names["controller"](*row)) for row in x])
    width = np.array([entry.high - entry.low for entry in system.outputs])
    np.testing.assert_allclose(found / width, compile_system(system).batch(x) / width, rtol=0, atol=1e-12)


def test_python_code_needs_numpy_alone(tmp_path: Path) -> None:
    path = tmp_path / "exported.py"
    path.write_text(python_file(EXACT["diagonal"]), encoding="utf-8")
    script = "import sys, exported; print(exported.controller(0.2, -1), 'fuzzy' in sys.modules, 'numba' in sys.modules)"
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    found = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, check=True, capture_output=True, text=True, env=environment
    ).stdout.split()
    assert float(found[0]) == pytest.approx(compile_system(EXACT["diagonal"])(0.2, -1), abs=1e-10)
    assert found[1:] == ["False", "False"]
