"""The folder of rule bases: nothing outside is touched, nothing is lost, every refusal says why."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

import fuzzy.formats
from app.storage import ChangedOnDiskError, Storage, StorageError
from fuzzy.system import FuzzySystem

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "rulebases" / "diagonal.yaml"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    inside = tmp_path / "rulebases"
    inside.mkdir()
    shutil.copy(SHIPPED, inside / "a.yaml")
    shutil.copy(SHIPPED, tmp_path / "outside.yaml")
    return inside


def renamed(system: FuzzySystem, name: str) -> FuzzySystem:
    return msgspec.structs.replace(system, name=name)


def test_rule_bases_are_listed_and_nothing_else(folder: Path) -> None:
    for name in ("b.yml", "my rules.YAML", ".hidden.yaml", "notes.txt", "b.yaml.bak"):
        shutil.copy(SHIPPED, folder / name)
    (folder / "folder.yaml").mkdir()
    (folder / "out.yaml").symlink_to("../outside.yaml")
    (folder / "in.yaml").symlink_to("a.yaml")
    (folder / "dangling.yaml").symlink_to("nowhere.yaml")
    (folder / "loop.yaml").symlink_to("loop.yaml")
    assert Storage(folder).names() == ("a.yaml", "b.yml", "in.yaml", "my rules.YAML")


def test_what_was_saved_is_what_is_opened(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    assert opened.system == fuzzy.formats.load(SHIPPED)
    changed = renamed(opened.system, "changed")
    stamp = storage.save("a.yaml", changed, opened.stamp)
    assert storage.open("a.yaml") == ("a.yaml", changed, stamp)
    assert storage.changed("a.yaml", stamp) is None
    assert sorted(entry.name for entry in folder.iterdir()) == ["a.yaml", "a.yaml.bak"]
    assert (folder / "a.yaml.bak").read_bytes() == SHIPPED.read_bytes()


def test_a_file_that_changed_on_disk_is_not_overwritten(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    theirs = renamed(opened.system, "theirs")
    fuzzy.formats.save(theirs, folder / "a.yaml")
    assert storage.changed("a.yaml", opened.stamp) is not None
    with pytest.raises(ChangedOnDiskError, match=r"^a\.yaml was changed on disk since it was opened$"):
        storage.save("a.yaml", renamed(opened.system, "ours"), opened.stamp)
    assert fuzzy.formats.load(folder / "a.yaml") == theirs
    storage.save_as("a.yaml", renamed(opened.system, "ours"), overwrite=True)
    assert storage.open("a.yaml").system.name == "ours"


def test_a_change_of_the_same_size_is_noticed(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    content = (folder / "a.yaml").read_bytes()
    (folder / "a.yaml").write_bytes(content.replace(b"diagonal", b"diagonax", 1))
    os.utime(folder / "a.yaml", ns=(0, opened.stamp.modified_ns + 1))
    assert storage.changed("a.yaml", opened.stamp) is not None


def test_a_file_that_was_only_touched_is_not_changed(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    os.utime(folder / "a.yaml", ns=(1, 1))
    assert storage.changed("a.yaml", opened.stamp) is None
    storage.save("a.yaml", opened.system, opened.stamp)


def test_a_file_that_was_deleted_is_written_again(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    (folder / "a.yaml").unlink()
    assert storage.changed("a.yaml", opened.stamp) is None
    storage.save("a.yaml", opened.system, opened.stamp)
    assert storage.names() == ("a.yaml",)


def test_a_new_file_does_not_replace_another(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    storage.save_as("b.yaml", renamed(opened.system, "b"))
    assert storage.names() == ("a.yaml", "b.yaml")
    with pytest.raises(ChangedOnDiskError, match=r"there is a file b\.yaml already"):
        storage.save_as("b.yaml", opened.system)
    assert storage.open("b.yaml").system.name == "b"


@pytest.mark.parametrize(
    "name", ["../outside.yaml", "/etc/passwd", "..", "", ".a.yaml", "a.txt", "x/a.yaml", "b\n.yaml"]
)
def test_a_name_never_leads_out_of_the_folder(folder: Path, name: str) -> None:
    storage = Storage(folder)
    before = {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()}
    system = storage.open("a.yaml").system
    with pytest.raises(StorageError, match=r"(?s)^no rule base .*; (did you mean .*\? )?valid: a\.yaml$"):
        storage.open(name)
    for overwrite in (False, True):
        with pytest.raises(StorageError, match="the file name is"):
            storage.save_as(name, system, overwrite=overwrite)
    assert {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()} == before


def test_a_link_out_of_the_folder_is_not_followed(folder: Path) -> None:
    storage = Storage(folder)
    system = storage.open("a.yaml").system
    (folder / "out.yaml").symlink_to("../outside.yaml")
    (folder / "dangling.yaml").symlink_to("../new.yaml")
    before = (folder.parent / "outside.yaml").read_bytes()
    with pytest.raises(StorageError, match="no rule base"):
        storage.open("out.yaml")
    for name in ("out.yaml", "dangling.yaml"):
        with pytest.raises(StorageError, match=f"{name} is a link that leads out of the folder"):
            storage.save_as(name, renamed(system, "hostile"), overwrite=True)
    assert (folder.parent / "outside.yaml").read_bytes() == before
    assert not (folder.parent / "new.yaml").exists()


def test_a_broken_file_is_named_with_line_and_column(folder: Path) -> None:
    content = (folder / "a.yaml").read_text(encoding="utf-8")
    (folder / "broken.yaml").write_text(content.replace("range: [-1, 1]", "range: [-1, one]"), encoding="utf-8")
    with pytest.raises(StorageError, match=r"^broken\.yaml:\d+:\d+: .*one") as refused:
        Storage(folder).open("broken.yaml")
    assert str(folder) not in str(refused.value)


def test_an_invalid_system_leaves_the_file_as_it_was(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    invalid = msgspec.structs.replace(opened.system, inputs=())
    with pytest.raises(StorageError, match=r"a\.yaml is not saved, the rule base is not valid"):
        storage.save("a.yaml", invalid, opened.stamp)
    assert storage.open("a.yaml") == opened


def test_a_folder_that_is_gone_is_an_error_and_no_loss(folder: Path) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    shutil.rmtree(folder)
    with pytest.raises(StorageError, match="cannot be read: No such file or directory"):
        storage.names()
    with pytest.raises(StorageError, match=r"cannot be written: No such file or directory; the folder .* is gone$"):
        storage.save("a.yaml", opened.system, opened.stamp)
    assert storage.changed("a.yaml", opened.stamp) is None
    folder.mkdir()
    storage.save("a.yaml", opened.system, opened.stamp)
    assert storage.open("a.yaml").system == opened.system


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES, errno.EIO])
@pytest.mark.parametrize("call", ["fsync", "replace", "link"])
def test_whatever_fails_while_saving_leaves_the_file_as_it_was(
    folder: Path, monkeypatch: pytest.MonkeyPatch, call: str, number: int
) -> None:
    storage = Storage(folder)
    opened = storage.open("a.yaml")
    storage.save("a.yaml", opened.system, opened.stamp)
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    stamp = storage.open("a.yaml").stamp

    def fail(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, call, fail)
    if call == "link":  # a file system without links: the old file is copied
        storage.save("a.yaml", renamed(opened.system, "new"), stamp)
        assert (folder / "a.yaml.bak").read_bytes() == before["a.yaml"]
        assert storage.open("a.yaml").system.name == "new"
        return
    with pytest.raises(StorageError, match=f"^a.yaml: .*cannot be written: {os.strerror(number)}$"):
        storage.save("a.yaml", renamed(opened.system, "new"), stamp)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs POSIX")
def test_a_full_disk_leaves_the_file_as_it_was(folder: Path) -> None:
    """The kernel itself refuses to write more than 100 bytes to any file."""
    script = """
import resource, sys
from pathlib import Path
from app.storage import Storage, StorageError
storage = Storage(Path(sys.argv[1]))
opened = storage.open("a.yaml")
resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
try:
    storage.save("a.yaml", opened.system, opened.stamp)
except StorageError as error:
    print(error)
"""
    before = (folder / "a.yaml").read_bytes()
    done = subprocess.run([sys.executable, "-c", script, folder], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout == "a.yaml: the file cannot be written: File too large\n"
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == {"a.yaml": before}


def test_what_a_crash_left_unfinished_is_deleted_when_it_is_old(folder: Path) -> None:
    for name in (".0123456789abcdef.yaml", ".0123456789abcdef.part", ".0123456789abcdef", ".mine.yaml"):
        (folder / name).write_text("half")
        os.utime(folder / name, (1, 1))
    (folder / ".fedcba9876543210.yaml").write_text("being written by another workbench")
    Storage(folder)
    assert sorted(path.name for path in folder.iterdir()) == [".fedcba9876543210.yaml", ".mine.yaml", "a.yaml"]


def test_permissions_stay_and_a_link_inside_the_folder_stays_a_link(folder: Path) -> None:
    storage = Storage(folder)
    (folder / "in.yaml").symlink_to("a.yaml")
    (folder / "a.yaml").chmod(0o640)
    opened = storage.open("in.yaml")
    storage.save("in.yaml", renamed(opened.system, "new"), opened.stamp)
    assert (folder / "in.yaml").is_symlink()
    assert storage.open("a.yaml").system.name == "new"
    assert (folder / "a.yaml").stat().st_mode & 0o777 == 0o640
