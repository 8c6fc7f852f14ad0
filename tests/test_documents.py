"""What the documents show is true: examples run, links lead somewhere, named tests and modules exist."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, get_args

import pytest

import fuzzy
from app.__main__ import main
from fuzzy.system import Aggregation, Defuzzifier, Implication, SNorm, TNorm
from robot import controllers, scenario

ROOT = Path(__file__).parents[1]
DOCUMENTS = [
    *(ROOT / name for name in ("README.md", "CHANGELOG.md", "rulebases/README.md", "benchmarks/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
]


def blocks(document: str, language: str) -> list[str]:
    text = (ROOT / document).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def test_the_rule_base_of_the_readme_has_ten_lines_and_no_findings(tmp_path: Path) -> None:
    (text,) = blocks("README.md", "yaml")
    path = tmp_path / "readme.yaml"
    path.write_text(text, encoding="utf-8")
    assert len(text.splitlines()) == 10
    assert fuzzy.check(fuzzy.load(path)) == []


def test_the_python_of_the_readme_gives_the_numbers_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    (text,) = blocks("README.md", "python")
    names: dict[str, Any] = {}
    exec(text, names)
    shown = re.findall(r"^(\S.*?)\s+# (-?[\d.]+)(?: s)?$", text, re.MULTILINE)
    assert len(shown) == 4
    for expression, number in shown:
        assert eval(expression, names) == pytest.approx(float(number), rel=1e-3), expression


def test_the_explanation_in_the_readme_is_what_the_command_prints(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    (text,) = blocks("README.md", "console")
    shown = {
        command.strip(): output
        for command, _, output in (part.partition("\n") for part in re.split(r"^\$ ", text, flags=re.M))
    }
    command = next(command for command in shown if " explain " in command)
    assert main(command.split()[1:]) == 0
    assert capsys.readouterr().out.strip() == shown[command].strip()


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_between_documents_lead_somewhere(document: Path) -> None:
    for target in re.findall(r"\]\(([^)]+\.md)[^)]*\)", document.read_text(encoding="utf-8")):
        if "://" not in target:
            assert (document.parent / target).is_file(), target


def test_the_tests_that_prove_the_errata_exist() -> None:
    text = (ROOT / "docs" / "errata.md").read_text(encoding="utf-8")
    sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests" / "robot").glob("*.py"))
    named = re.findall(r"::(test_\w+)", text)
    assert named
    assert [name for name in named if f"def {name}(" not in sources] == []


@pytest.mark.parametrize("package", ["fuzzy", "robot", "app"])
def test_the_layout_names_the_modules_that_exist(package: str) -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    section = text.partition(f"### {package}/\n")[2].partition("\n##")[0]
    named = set(re.findall(r"`(\w+\.py)`", section))
    modules = {path.name for path in (ROOT / package).rglob("*.py")}
    assert named - modules == set()
    assert modules - named - {"__init__.py"} == set()


@pytest.mark.parametrize("document", ["docs/inference.md", "rulebases/README.md"])
def test_every_operator_is_described(document: str) -> None:
    text = (ROOT / document).read_text(encoding="utf-8")
    choices = {name for kind in (TNorm, SNorm, Implication, Aggregation, Defuzzifier) for name in get_args(kind)}
    assert [name for name in sorted(choices) if not re.search(rf"\b{name}\b", text)] == []


@pytest.mark.parametrize("document", ["README.md", "docs/errata.md"])
def test_every_control_law_is_described(document: str) -> None:
    text = (ROOT / document).read_text(encoding="utf-8")
    assert [name for name in controllers.NAMES if f"`{name}`" not in text] == []


def test_every_scenario_is_described() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [name for name in scenario.names() if f"`{name}`" not in text] == []


def test_the_figures_of_the_readme_are_what_the_simulation_prints(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    (text,) = blocks("README.md", "console")
    part = next(part for part in re.split(r"^\$ ", text, flags=re.M) if " simulate " in part)
    command, _, *shown = part.strip().splitlines()
    assert main(command.partition(" --output ")[0].split()[1:]) == 0
    printed = capsys.readouterr().out.splitlines()[1:]
    assert shown.pop() == "…"
    assert len(shown) == 4
    assert printed[: len(shown)] == shown
