"""The wheel, in an empty environment, outside the checkout; what it needs is borrowed from this environment."""

from __future__ import annotations

import zipfile
from email.parser import Parser
from pathlib import Path

import pytest

from tests import package

BOUNDS = ("<", "~=", "==")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return package.build(tmp_path_factory.mktemp("wheel"), is_isolated=False)


def test_the_wheel_works_outside_the_checkout(wheel: Path, tmp_path: Path) -> None:
    programs = package.install(wheel, tmp_path / "environment", has_dependencies=False)
    package.try_out(programs, tmp_path / "elsewhere", has_kernels=False)


def test_the_wheel_holds_every_file_that_is_no_code_too(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        held = set(archive.namelist())
    wanted = {
        str(path.relative_to(package.ROOT))
        for folder in ("app", "fuzzy", "robot", "rulebases")
        for path in (package.ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and not path.name.endswith((".bak", ".pyc"))
    }
    assert wanted - held == set()


def test_only_viser_has_an_upper_bound(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        metadata = Parser().parsestr(archive.read(name).decode())
    assert metadata["Requires-Python"] == ">=3.11"
    needed = [line for line in metadata.get_all("Requires-Dist") or [] if "extra" not in line]
    assert [line for line in needed if any(bound in line for bound in BOUNDS)] == ["viser<1.2,>=1.1.1"]
