"""What the documents show is true: examples run, links lead somewhere, named tests and modules exist."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import fuzzy
from app.__main__ import main

ROOT = Path(__file__).parents[1]
DOCUMENTS = [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "rulebases" / "README.md", *(ROOT / "docs").glob("*.md")]


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
    assert len(shown) == 3
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
def test_the_modules_of_the_layout_exist(package: str) -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    section = text.partition(f"### {package}/\n")[2].partition("\n##")[0]
    named = set(re.findall(r"`(\w+\.py)`", section))
    assert named
    assert named - {path.name for path in (ROOT / package).rglob("*.py")} == set()
