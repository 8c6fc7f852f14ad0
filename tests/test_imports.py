"""The layers: app may import robot and fuzzy, robot may import fuzzy in two places, fuzzy imports neither."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LAYERS = ("fuzzy", "robot", "app")
"""From the lowest to the highest."""

FUZZY_INSIDE_ROBOT = ROOT / "robot" / "controllers" / "fuzzy.py"
"""The one robot module that knows fuzzy controllers; all others know of fuzzy only how kernels are compiled."""

MODULES = sorted(path for layer in LAYERS for path in (ROOT / layer).rglob("*.py"))


def imported(path: Path) -> set[str]:
    """Return the full names of everything that a module imports, inside functions too."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        match node:
            case ast.Import(names=aliases):
                names |= {alias.name for alias in aliases}
            case ast.ImportFrom(module=module, names=aliases, level=level):
                package = path.relative_to(ROOT).parts[:-level] if level else ()
                start = ".".join([*package, *([module] if module else [])])
                names |= {f"{start}.{alias.name}" for alias in aliases}
    return names


def allowed(path: Path, name: str) -> bool:
    layer, top = path.relative_to(ROOT).parts[0], name.partition(".")[0]
    if top not in LAYERS or top == layer:
        return True
    if (layer, top) == ("robot", "fuzzy"):
        return path == FUZZY_INSIDE_ROBOT or name.startswith("fuzzy.kernels.jit.")
    return LAYERS.index(top) < LAYERS.index(layer)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_point_down(path: Path) -> None:
    assert [name for name in sorted(imported(path)) if not allowed(path, name)] == []


@pytest.mark.parametrize(
    ("source", "name", "expected"),
    [
        ("app/x.py", "robot.arm.Arm", True),
        ("robot/x.py", "app.guard", False),
        ("robot/x.py", "fuzzy.load", False),
        ("robot/x.py", "fuzzy.kernels.jit.kernel", True),
        ("robot/controllers/fuzzy.py", "fuzzy.compile_system", True),
        ("fuzzy/x.py", "robot.Arm", False),
        ("fuzzy/x.py", "numpy", True),
    ],
)
def test_the_rule_itself(source: str, name: str, expected: bool) -> None:
    assert allowed(ROOT / source, name) is expected


def test_imports_inside_functions_and_relative_ones_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    module = ROOT / "robot" / "kernels" / "x.py"
    source = "def f():\n    from app import guard\nfrom ..controllers import fuzzy\nimport fuzzy.system as s\n"
    monkeypatch.setattr(Path, "read_text", lambda self, **_: source)
    assert imported(module) == {"app.guard", "robot.controllers.fuzzy", "fuzzy.system"}
