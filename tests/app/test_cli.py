"""The command line: results, exit codes, and a sentence instead of a traceback for whatever a user can do wrong."""

from __future__ import annotations

import csv
import math
import os
import socket
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

import robot.simulation
from app.__main__ import COMMANDS, main
from fuzzy.formats import load
from fuzzy.inference import compile_system
from robot import controllers
from robot.arm import Arm
from robot.disturbance import BandLimitedNoise
from robot.run import Run
from robot.scenario import Mismatch, Scenario

ROOT = Path(__file__).parents[2]
DIAGONAL = ROOT / "rulebases" / "diagonal.yaml"


def run(capsys: pytest.CaptureFixture[str], *words: str | Path) -> tuple[int, str, str]:
    """Return exit code, standard output and standard error of one command."""
    try:
        code = main([str(word) for word in words])
    except SystemExit as end:  # tyro ends the process on wrong use and after --help
        code = int(end.code or 0)
    said = capsys.readouterr()
    return code, said.out, said.err


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "in.csv"
    path.write_text("e,de\n0.2,-1\n-0.5,3\n0,0\n", encoding="utf-8")
    return path


@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_every_command_explains_itself(capsys: pytest.CaptureFixture[str], command: str) -> None:
    code, out, err = run(capsys, *command.split(), "--help")
    assert code == 0
    assert out.startswith("usage: fuzzy-workbench")
    assert "None" not in out
    assert err == ""


def test_help_is_quick_because_it_loads_no_kernels() -> None:
    script = (
        "import sys, app.__main__; print([m for m in ('numba', 'numpy', 'viser', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_an_unknown_command_is_wrong_use(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, "chek", "x")
    assert code == 2
    assert "serve, check, infer, explain, convert, simulate" in out + err


def test_infer_computes_every_row(capsys: pytest.CaptureFixture[str], table: Path) -> None:
    output = table.with_name("out.csv")
    assert run(capsys, "infer", DIAGONAL, "--inputs", table, "--output", output) == (0, "", "")
    controller = compile_system(load(DIAGONAL))
    with output.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["T"]
    assert [float(row[0]) for row in rows] == [controller(0.2, -1), controller(-0.5, 3), controller(0, 0)]
    assert sorted(entry.name for entry in output.parent.iterdir()) == ["in.csv", "out.csv"]
    assert stat.S_IMODE(output.stat().st_mode) == stat.S_IMODE(table.stat().st_mode)


def test_infer_takes_columns_in_any_order_and_skips_empty_lines(
    capsys: pytest.CaptureFixture[str], table: Path
) -> None:
    swapped = table.with_name("swapped.csv")
    swapped.write_text('\ufeff"de", e\r\n-1,0.2\r\n\r\n3,-0.5\r\n0,0\r\n,\r\n', encoding="utf-8")
    for source in (table, swapped):
        assert run(capsys, "infer", DIAGONAL, "--inputs", source, "--output", f"{source}.out")[0] == 0
    assert Path(f"{table}.out").read_bytes() == Path(f"{swapped}.out").read_bytes()


def test_infer_samples_as_it_is_told(capsys: pytest.CaptureFixture[str], table: Path) -> None:
    found = {}
    for resolution in ("exact", "50", "100000"):
        output = table.with_name(f"{resolution}.csv")
        words = ("infer", DIAGONAL, "--inputs", table, "--output", output, "--resolution", resolution)
        assert run(capsys, *words) == (0, "", "")
        found[resolution] = np.loadtxt(output, skiprows=1)
    np.testing.assert_allclose(found["100000"], found["exact"], atol=1e-4)
    assert np.abs(found["50"] - found["exact"]).max() > 1e-4


def test_infer_writes_nan_where_nothing_fires(capsys: pytest.CaptureFixture[str], table: Path) -> None:
    rulebase = table.with_name("gap.yaml")
    rulebase.write_text(
        "schema: fuzzy-workbench/1\nname: gap\n"
        "inputs: {e: {range: [-1, 1], terms: {P: {triangle: [0, 0.5, 1]}}}}\n"
        "outputs: {T: {range: [-1, 1], no_fire: nan, terms: {P: {triangle: [0, 0.5, 1]}}}}\n"
        "rules: {list: [if e is P then T is P]}\n",
        encoding="utf-8",
    )
    table.write_text("e\n-0.5\n0.5\n", encoding="utf-8")
    assert run(capsys, "infer", rulebase, "--inputs", table, "--output", table.with_name("o.csv")) == (0, "", "")
    lines = table.with_name("o.csv").read_text(encoding="utf-8").splitlines()
    assert lines[:2] == ["T", "nan"]
    assert float(lines[2]) == 0.5


def test_infer_leaves_an_existing_output_alone_when_it_fails(capsys: pytest.CaptureFixture[str], table: Path) -> None:
    output = table.with_name("out.csv")
    output.write_text("precious", encoding="utf-8")
    table.write_text("e,de\n0,0\n0,x\n", encoding="utf-8")
    assert run(capsys, "infer", DIAGONAL, "--inputs", table, "--output", output)[0] == 1
    assert output.read_text(encoding="utf-8") == "precious"


@pytest.mark.parametrize(
    ("content", "place", "sentence"),
    [
        ("", "0:0", "the file is empty; the first line names the inputs: e,de"),
        ("e\n1\n", "1:1", "the header does not name 'de'; valid: e,de"),
        ("e,dee\n", "1:3", "the header names 'dee'; did you mean 'de'? valid: e, de"),
        ("e,de,e\n", "1:6", "the header names 'e' twice"),
        ("0.1,0.2\n", "1:1", "the header names '0.1'; valid: e, de"),
        ("e,de\n0,0\n0\n", "3:1", "1 fields; valid: 2 (e, de)"),
        ("e,de\n0,0,0\n", "2:1", "3 fields; valid: 2 (e, de)"),
        ("e,de\n\n0.25,abc\n", "3:6", "field 2 is 'abc'; valid is a finite number"),
        ("e,de\n0,nan\n", "2:3", "field 2 is 'nan'; valid is a finite number"),
        ("e,de\n-inf,0\n", "2:1", "field 1 is '-inf'; valid is a finite number"),
        ("e,de\n1e999,0\n", "2:1", "field 1 is '1e999'; valid is a finite number"),
        ("e,de\n1_0,0\n", "2:1", "field 1 is '1_0'; valid is a finite number"),
        ("e,de\n,0\n", "2:1", "field 1 is ''; valid is a finite number"),
        ('e,de\n"0,0\n', "2:1", "unexpected end of data"),
        ("e;de\n0;0\n", "1:1", "the header names 'e;de'; did you mean 'de'? valid: e, de"),
    ],
)
def test_infer_names_line_and_column_of_a_bad_table(
    capsys: pytest.CaptureFixture[str], table: Path, content: str, place: str, sentence: str
) -> None:
    table.write_text(content, encoding="utf-8")
    code, out, err = run(capsys, "infer", DIAGONAL, "--inputs", table, "--output", table.with_name("out.csv"))
    assert (code, out, err) == (1, "", f"{table}:{place}: error: {sentence}\n")
    assert not table.with_name("out.csv").exists()


def test_infer_refuses_bytes_that_are_no_text(capsys: pytest.CaptureFixture[str], table: Path) -> None:
    table.write_bytes(b"e,de\n\xff,0\n")
    code, _, err = run(capsys, "infer", DIAGONAL, "--inputs", table, "--output", table.with_name("out.csv"))
    assert (code, err) == (1, f"{table}:0:0: error: byte 0xff is not UTF-8 text\n")


def test_infer_names_the_row_that_a_range_rejects(capsys: pytest.CaptureFixture[str], table: Path) -> None:
    strict = table.with_name("strict.yaml")
    text = DIAGONAL.read_text(encoding="utf-8")
    strict.write_text(text.replace("range: [-1, 1]", "range: [-1, 1]\n    out_of_range: reject", 1), encoding="utf-8")
    table.write_text("de,e\n0,1\n\n9,1.5\n", encoding="utf-8")
    code, _, err = run(capsys, "infer", strict, "--inputs", table, "--output", table.with_name("out.csv"))
    assert (code, err) == (1, f"{table}:4:1: error: e is 1.5; valid: -1 to 1\n")


@pytest.mark.parametrize(("output", "reason"), [("", "folder"), ("no/out.csv", "No such file"), ("a\0b", "null")])
def test_an_output_that_cannot_be_written_is_named(
    capsys: pytest.CaptureFixture[str], table: Path, output: str, reason: str
) -> None:
    place = table.parent / output
    code, _, err = run(capsys, "infer", DIAGONAL, "--inputs", table, "--output", place)
    assert code == 1
    assert err.startswith(f"{place}:0:0: error: ")
    assert reason in err


def test_a_device_is_written_directly(capsys: pytest.CaptureFixture[str], table: Path) -> None:
    assert run(capsys, "infer", DIAGONAL, "--inputs", table, "--output", os.devnull) == (0, "", "")
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


@pytest.mark.parametrize("resolution", ["1", "0", "-5", "1e3", "exakt", "100001", "9" * 5000, "٣٣"])
def test_infer_refuses_a_resolution_that_is_none(
    capsys: pytest.CaptureFixture[str], table: Path, resolution: str
) -> None:
    words = ("infer", DIAGONAL, "--inputs", table, "--output", table.with_name("o"), "--resolution", resolution)
    code, _, err = run(capsys, *words)
    assert code == 2
    assert err.endswith("valid: exact, or a number of points from 2 to 100000\n")


def test_explain_shows_what_fires(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "explain", DIAGONAL, "de=-1", "e=0.2")
    assert code == 0
    lines = out.splitlines()
    trace = compile_system(load(DIAGONAL)).explain(0.2, -1)
    assert lines[0].startswith("e = 0.2: ")
    assert lines[2] == f"{len(trace.rules)} of 49 rules fire:"
    assert len(lines) == 4 + len(trace.rules)
    assert lines[-1].startswith(f"T = {trace.outputs['T'].value:.17g}: ")


def test_explain_says_when_an_input_is_clamped(capsys: pytest.CaptureFixture[str]) -> None:
    assert "e = 5 (outside its range, taken as the nearer end): " in run(capsys, "explain", DIAGONAL, "e=5", "de=0")[1]


def test_explain_reports_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = run(capsys, "explain", DIAGONAL, "e=0.2", "de=-1", "--json")
    assert code == 0
    report = msgspec.json.decode(out)
    assert report["inputs"] == {"e": 0.2, "de": -1}
    assert report["outputs"]["T"]["value"] == compile_system(load(DIAGONAL))(0.2, -1)
    assert math.isclose(max(report["outputs"]["T"]["heights"].values()), report["rules"][0]["strength"])


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["e=0.2"], "no value for de; valid: e=VALUE de=VALUE"),
        (["e=0.2", "de"], "'de' is not of the form NAME=VALUE; valid: e=VALUE de=VALUE"),
        (["e=0.2", "dde=1"], "no input is called 'dde'; did you mean 'de'? valid: e, de"),
        (["e=0.2", "e=0.3"], "the input 'e' is given twice"),
        (["e=nan", "de=1"], "e is 'nan'; valid is a finite number"),
        (["e=x", "de=1"], "e is 'x'; valid is a finite number"),
    ],
)
def test_explain_refuses_inputs_that_are_none(
    capsys: pytest.CaptureFixture[str], words: list[str], sentence: str
) -> None:
    assert run(capsys, "explain", DIAGONAL, *words) == (2, "", f"fuzzy-workbench: error: {sentence}\n")


@pytest.mark.parametrize("command", ["serve", "infer", "explain"])
@pytest.mark.parametrize(
    ("name", "content", "place", "words"),
    [
        ("none.yaml", None, "0:0", "No such file"),
        ("rules.toml", "x", "0:0", "valid: .yaml, .yml"),
        ("broken.yaml", "schema: fuzzy-workbench/1\nname: [", "", ""),
        ("other.yaml", "schema: fuzzy-workbench/2\nname: x\n", "1:9", "fuzzy-workbench/1"),
        ("empty.yaml", "", "1:1", "fuzzy-workbench/1"),
    ],
)
def test_a_bad_rulebase_is_an_error_with_its_place(
    capsys: pytest.CaptureFixture[str],
    table: Path,
    command: str,
    name: str,
    content: str | None,
    place: str,
    words: str,
) -> None:
    file = table.with_name(name)
    if content is not None:
        file.write_text(content, encoding="utf-8")
    further = {"serve": [], "infer": ["--inputs", table, "--output", "x.csv"], "explain": ["e=1", "de=1"]}[command]
    code, out, err = run(capsys, command, file, *further)
    assert (code, out) == (1, "")
    assert err.startswith(f"{file}:{place}")
    assert ": error: " in err
    assert words in err
    assert err.count("\n") == 1


def test_without_a_command_the_workbench_is_served(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "none.yaml") == run(capsys, "serve", "none.yaml")
    assert run(capsys, "--port", "0") == run(capsys, "serve", "--port", "0")


@pytest.mark.parametrize("port", ["0", "-1", "65536"])
def test_a_port_that_is_none_is_wrong_use(capsys: pytest.CaptureFixture[str], port: str) -> None:
    assert run(capsys, "serve", "--port", port) == (
        2,
        "",
        f"fuzzy-workbench: error: port {port}; valid are 1 to 65535\n",
    )


def test_a_busy_port_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as busy:
        port = busy.getsockname()[1]
        sentence = f"fuzzy-workbench: error: port {port} on 127.0.0.1 is busy; choose another with --port\n"
        assert run(capsys, "serve", "--port", str(port)) == (1, "", sentence)


def test_an_address_that_is_not_this_machines_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = run(capsys, "serve", "--host", "192.0.2.1")
    assert code == 1
    assert err.startswith("fuzzy-workbench: error: cannot listen on 192.0.2.1:8080: ")


def test_a_short_token_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = run(capsys, "serve", "--token", "secret")
    assert code == 2
    assert "16 to 128" in err
    assert "secret" not in err


def test_a_reader_that_stops_early_is_no_error() -> None:
    script = f"{sys.executable} -m app explain {DIAGONAL} e=0.2 de=-1 | head -n 0; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", script], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stderr == ""


def test_check_finds_nothing_in_the_shipped_rule_bases(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "check", *sorted(DIAGONAL.parent.glob("*.yaml"))) == (0, "", "")


def test_check_names_file_line_and_column(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    broken, doubtful = tmp_path / "broken.yaml", tmp_path / "doubtful.yaml"
    text = DIAGONAL.read_text(encoding="utf-8")
    line = next(number for number, content in enumerate(text.splitlines(), 1) if "range: [-1, 1]" in content)
    broken.write_text(text.replace("range: [-1, 1]", "range: [-1, one]", 1), encoding="utf-8")
    doubtful.write_text(text.replace("[LL, LL", "[~, LL", 1), encoding="utf-8")
    assert doubtful.read_text(encoding="utf-8") != text
    missing = tmp_path / "missing.yaml"
    code, out, err = run(capsys, "check", broken, DIAGONAL, doubtful, missing)
    assert (code, err) == (1, "")
    lines = out.splitlines()
    assert lines[0].startswith(f"{broken}:{line}:")
    assert "'one'" in lines[0]
    assert any(found.startswith(f"{doubtful}:") and ": warning: " in found for found in lines)
    assert lines[-1] == f"{missing}:0:0: error: the file cannot be read: No such file or directory"
    code, out, err = run(capsys, "check", broken, DIAGONAL, doubtful, missing, "--json")
    report = msgspec.json.decode(out)
    assert (code, err, report["files"], len(report["findings"])) == (1, "", 4, len(lines))
    assert report["findings"][0]["file"] == str(broken)
    assert report["findings"][0]["line"] == line


def test_check_without_a_file_is_wrong_use(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(capsys, "check") == (2, "", "fuzzy-workbench: error: check needs at least one FILE\n")


def test_simulate_prints_the_figures_of_merit(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = run(capsys, "simulate", DIAGONAL)
    assert (code, err) == (0, "")
    run_ = simulated("fuzzy_flc", Scenario.preset("step"))
    assert out.startswith("fuzzy_flc on the soft arm, step: 3 s simulated in ")
    (rise,) = [line.split() for line in out.splitlines() if line.startswith("rise_time")]
    assert rise[1:3] == ["s", f"{run_.metrics().rise_time['worst']:.4g}"]


def simulated(law: str, scenario: Scenario) -> Run:
    arm = Arm.preset("soft")
    return robot.simulation.simulate(
        arm, controllers.default(law, arm, scenario, compile_system(load(DIAGONAL))), scenario
    )


def test_simulate_reports_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--controller", "pid", "--mismatch", "stiffness=+30%", "--mismatch", "mass=-10%", "--json")
    code, out, err = run(capsys, "simulate", *words, "--disturbance", "force_noise", "--seed", "5")
    assert (code, err) == (0, "")
    report = msgspec.json.decode(out)
    assert (report["controller"], report["scenario"], report["horizon_s"]) == ("pid", "step", 3)
    assert report["wall_s"] > 0
    scenario = msgspec.structs.replace(
        Scenario.preset("step"),
        mismatch=Mismatch(stiffness=1.3, mass=0.9),
        disturbance=BandLimitedNoise(seed=5),
    )
    assert report["metrics"] == simulated("pid", scenario).metrics().to_dict()


def test_simulate_leaves_a_scenario_undisturbed_when_told(capsys: pytest.CaptureFixture[str]) -> None:
    figures = []
    for words in (["step_noise", "--disturbance", "none"], ["step"], ["step_noise"]):
        out = run(capsys, "simulate", "--controller", "pid", "--json", "--scenario", *words)[1]
        figures.append(msgspec.json.decode(out)["metrics"])
    assert figures[0] == figures[1] != figures[2]


def test_simulate_writes_the_whole_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for suffix in ("csv", "npz"):
        words = ("--controller", "pd_flc", "--output", tmp_path / f"run.{suffix}", "--plot", tmp_path / "run.png")
        assert run(capsys, "simulate", *words)[0] == 0
    found = simulated("pd_flc", Scenario.preset("step"))
    table = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(table["t"], found.t)
    np.testing.assert_array_equal(table["q_theta3"], found.q[:, 5])
    np.testing.assert_array_equal(table["F22"], found.forces[:, 3])
    with np.load(tmp_path / "run.npz") as arrays:
        np.testing.assert_array_equal(arrays["q"], found.q)
        assert arrays["actuators"].tolist() == list(found.arm.actuators)
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["run.csv", "run.npz", "run.png"]


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (["--controller", "pdi"], 1, "did you mean 'pid'? valid: pid, pd_flc, fuzzy_flc"),
        (["--scenario", "x"], 1, "valid: step, step_noise, sinus"),
        (["--arm", "sofd"], 1, "did you mean 'soft'? valid: soft, stiff"),
        (["--disturbance", "x"], 1, "valid: none, force_noise"),
        (["--mismatch", "stiffnes=+3%"], 2, "did you mean 'stiffness'? valid: mass, stiffness, damping"),
        (["--mismatch", "mass=1.3"], 2, "valid is a percentage such as mass=+30%"),
        (["--mismatch", "mass=nan%"], 2, "valid is a percentage such as mass=+30%"),
        (["--mismatch", "mass=3%", "--mismatch", "mass=3%"], 2, "--mismatch gives 'mass' twice"),
        (["--mismatch", "mass=-99%"], 1, "mismatch.mass: found 0.01; valid: 0.1 to 10"),
        (["--seed", "-1"], 2, "--seed -1; valid is a whole number, 0 or more"),
        (["--output", "run.txt"], 2, "valid are names that end in .csv or .npz"),
        (["none.yaml"], 1, "none.yaml:0:0: error: the file cannot be read: No such file or directory"),
        (["--controller", "pid", "--output", "/none/run.csv"], 1, "/none/run.csv:0:0: error: the file cannot be"),
        (["--controller", "pid", "--plot", "run.xyz"], 1, "run.xyz:0:0: error: the file cannot be written"),
    ],
)
def test_simulate_refuses_what_it_does_not_know(
    capsys: pytest.CaptureFixture[str], words: list[str], code: int, sentence: str
) -> None:
    found, _, err = run(capsys, "simulate", *words)
    assert found == code
    assert sentence in err
    assert err.count("\n") == 1


def test_a_run_that_runs_away_fails_after_its_figures(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    real = robot.simulation.simulate

    def run_away(*parts: Any) -> Run:
        return real(*parts)._replace(stopped=robot.simulation.Stop(0.5, "position", "theta2"))

    monkeypatch.setattr(robot.simulation, "simulate", run_away)
    code, out, err = run(capsys, "simulate", "--controller", "pid")
    assert code == 1
    assert "overshoot" in out
    assert err == f"fuzzy-workbench: error: {robot.simulation.Stop(0.5, 'position', 'theta2')}\n"


def test_every_law_and_every_scenario_can_be_simulated_and_is_named_in_the_help(
    capsys: pytest.CaptureFixture[str],
) -> None:
    from robot import scenario

    with pytest.raises(SystemExit):
        main(["simulate", "--help"])
    text = capsys.readouterr().out
    for name in (*controllers.NAMES, *scenario.names()):
        assert name in text
    for law in controllers.NAMES:
        assert main(["simulate", "--controller", law, "--json"]) == 0, law
        assert msgspec.json.decode(capsys.readouterr().out)["controller"] == law
    for name in scenario.names():
        assert main(["simulate", "--scenario", name]) == 0, name
