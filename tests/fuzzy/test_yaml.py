"""Files: what is written is read again, and every mistake is one located error."""

import difflib
import math
import stat
from pathlib import Path

import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy.errors import FormatError, InvalidSystemError
from fuzzy.formats import MAX_BYTES, dumps, load, loads, positions, save
from fuzzy.formats.yaml_writer import number, scalar
from fuzzy.language import format_rule
from fuzzy.rules import all_rules
from fuzzy.shapes import Triangle
from fuzzy.system import And, FuzzySystem, Inference, Input, Is, Not, Output, Rule, RuleBase, RuleTable, Sampling, Term
from tests import plain, strategies

RULEBASES = Path(__file__).parents[2] / "rulebases"
SHIPPED = ("diagonal", "piltan")

SMALL = """\
schema: fuzzy-workbench/1
name: small
inputs:
  e:
    range: [-1, 1]
    terms:
      NO: {triangle: [-.inf, -1, 1]}
      y:  {triangle: [-1, 1, .inf]}
  de:
    range: [-6, 6]
    terms: {1e3: {gaussian: [0, 2]}}
outputs:
  T:
    range: [-85, 85]
    terms:
      LL: {triangle: [-100, -85, 0]}
      LR: {triangle: [0, 85, 100]}
rules:
  table:
    rows: e
    columns: de
    output: T
    cells:
      y:  [LR]
      NO: [~]
  list:
    - "if e is NO and de is not 1e3 then T is LL with 0.5"
inference: {and: product, resolution: {points: 101, rule: endpoints}}
"""


def _line(text: str) -> int:
    """The number of the only line of SMALL that holds ``text``."""
    (found,) = [number for number, line in enumerate(SMALL.splitlines(), 1) if text in line]
    return found


def test_reads_the_schema():
    system = loads(SMALL)
    assert [term.name for term in system.inputs[0].terms] == ["NO", "y"]
    assert system.inputs[0].terms[0].shape == Triangle(-math.inf, -1, 1)
    assert system.inputs[1].terms[0].name == "1e3"
    assert system.rules.table == RuleTable("e", "de", "T", ((None,), ("LR",)))
    assert system.rules.list[0].weight == 0.5
    assert system.inference == Inference(conjunction="product", resolution=Sampling(101, "endpoints"))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_files_are_written_as_they_stand(name):
    path = RULEBASES / f"{name}.yaml"
    assert dumps(load(path)) == path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_tables_hold_the_printed_rule_and_are_antisymmetric(name):
    system = load(RULEBASES / f"{name}.yaml")
    rules = [format_rule(rule) for rule in all_rules(system)]
    assert len(rules) == 49
    assert "if e is NB and de is ML then T is LL" in rules
    assert system.rules.table is not None
    terms = [term.name for term in system.outputs[0].terms]
    cells = [[terms.index(cell or "") - 3 for cell in row] for row in system.rules.table.cells]
    assert cells == [[-cell for cell in reversed(row)] for row in reversed(cells)]
    assert all(list(row) == sorted(row) for row in (*cells, *zip(*cells, strict=True)))


def test_diagonal_is_the_clipped_sum():
    table = load(RULEBASES / "diagonal.yaml").rules.table
    assert table is not None
    terms = ("LL", "ML", "SL", "Z", "SR", "MR", "LR")
    assert table.cells == tuple(tuple(terms[max(0, min(6, i + j - 3))] for j in range(7)) for i in range(7))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_sets_are_a_partition(name):
    system = load(RULEBASES / f"{name}.yaml")
    for variable in (*system.inputs, *system.outputs):
        x = [variable.low + (variable.high - variable.low) * step / 997 for step in range(998)]
        total = sum(plain.degrees(term.shape, x) for term in variable.terms)
        assert total == pytest.approx(1, abs=1e-14)


def test_the_reference_page_shows_a_valid_file():
    page = (RULEBASES / "README.md").read_text(encoding="utf-8")
    example = page.partition("```yaml\n")[2].partition("```")[0]
    system = loads(example)
    assert loads(dumps(system)) == system
    assert system.inference == Inference()


@given(strategies.systems(name=strategies.names, is_varied=True))
@settings(max_examples=60)
def test_reading_inverts_writing(system):
    text = dumps(system)
    assert loads(text) == system
    assert dumps(loads(text)) == text


@given(strategies.names)
def test_other_readers_of_yaml_take_names_for_texts(name):
    assert yaml.safe_load(f"{scalar(name)}: [{scalar(name)}]") == {name: [name]}


@given(st.floats(-1e12, 1e12))
def test_numbers_are_read_back_exactly_by_other_readers_too(value):
    written = number(value)
    assert yaml.safe_load(written) == value
    assert len(written) <= len(repr(value)) + 2


@given(st.data())
def test_a_difference_shows_the_edited_cell_alone(data):
    system = load(RULEBASES / "diagonal.yaml")
    table = system.rules.table
    assert table is not None
    row, column = data.draw(st.integers(0, 6)), data.draw(st.integers(0, 6))
    term = data.draw(st.sampled_from([None, "LL", "Z", "LR"]))
    assume(term != table.cells[row][column])
    cells = [list(cells) for cells in table.cells]
    cells[row][column] = term
    edited = replace(system, rules=RuleBase(replace(table, cells=tuple(map(tuple, cells)))))
    changes = list(difflib.unified_diff(dumps(system).splitlines(), dumps(edited).splitlines(), n=0, lineterm=""))[2:]
    assert len(changes) == 3


# What to replace, with what (¦ marks where the error is), and how the message begins.
MISTAKES = [
    (
        "schema: fuzzy-workbench/1",
        "schema: ¦fuzzy-workbench/2",
        "'fuzzy-workbench/2' is newer than this program",
    ),
    (
        "schema: fuzzy-workbench/1",
        "schema: ¦fuzzy-workbench/0",
        "unknown schema 'fuzzy-workbench/0'; valid",
    ),
    ("schema: fuzzy-workbench/1", "schema: ¦guzzy/1", "unknown schema 'guzzy/1'; valid: fuzzy-workbench/1"),
    ("schema: fuzzy-workbench/1", "¦scheme: fuzzy-workbench/1", "expected 'schema: fuzzy-workbench/1' first"),
    ("name: small", "name:¦", "expected a name, found nothing"),
    (
        "name: small",
        "¦nmae: small",
        "unknown key 'nmae'; did you mean 'name'? valid: schema, name, inputs",
    ),
    ("name: small\n", "", "the key 'name' is missing"),
    ("name: small", "name: ¦[small]", "expected a name, found a list"),
    ("name: small", "name: small\n¦name: big", "the key 'name' stands twice, first in line 2"),
    ("name: small", "name: ¦*small", "aliases (*name) are not used"),
    ("name: small", "name: ¦&a small", "anchors (&name) are not used"),
    ("name: small", "name: ¦!!str small", "tags are not used"),
    (
        "  e:\n    range",
        "¦\te:\n    range",
        "this is not YAML: while scanning for the next token",
    ),
    ("range: [-1, 1]", "range: ¦[-1, 1, 2]", "expected a range of two numbers such as [-1, 1], found 3"),
    ("range: [-1, 1]", "¦range: [1, -1]", "[1, -1]: valid is low < high"),
    ("range: [-1, 1]", "range: [-1, ¦.inf]", "expected a finite number, found .inf"),
    ("range: [-1, 1]", "range: [-1, ¦.nan]", "expected a number, found .nan"),
    ("range: [-1, 1]", "range: [-1, ¦1e999]", "the number 1e999 is too large"),
    ("range: [-1, 1]", "range: [-1, ¦1_0]", "expected a number such as 0.5, 1e3 or -.inf, found '1_0'"),
    ("range: [-1, 1]", "range: [-1, ¦1:30]", "expected a number such as 0.5, 1e3 or -.inf, found '1:30'"),
    ("range: [-1, 1]", "range: [-1, ¦٣]", "expected a number such as 0.5, 1e3 or -.inf, found '٣'"),
    ("range: [-1, 1]", "range: [-1, ¦'1']", "expected a number such as 0.5, 1e3 or -.inf, found the text '1'"),
    ("range: [-1, 1]", "range: [-1, ¦{}]", "expected a number such as 0.5, 1e3 or -.inf, found a mapping"),
    ("range: [-1, 1]", "range: ¦-1", "expected a range such as [-1, 1], found '-1'"),
    (
        "{triangle: [-1, 1, .inf]}",
        "{¦triangel: [-1, 1, .inf]}",
        "unknown shape 'triangel'; did you mean 'triangle'?",
    ),
    ("{triangle: [-1, 1, .inf]}", "{triangle: ¦[-1, 1]}", "a triangle has 3 parameters (a, b, c), found 2"),
    ("y:  {triangle: [-1, 1, .inf]}", "¦y:  {triangle: [1, -1, .inf]}", "triangle [1, -1, inf] is not in order"),
    ("{triangle: [-1, 1, .inf]}", "¦{}", "expected one shape such as {triangle: [-1, 0, 1]}, found 0"),
    ("{triangle: [-1, 1, .inf]}", "¦big", "expected a shape such as {triangle: [-1, 0, 1]}, found 'big'"),
    ("LL: {triangle: [-100, -85, 0]}", "¦LL: {triangle: [90, 95, 99]}", "the set has no area in [-85, 85]"),
    ("[-85, 85]", "[-85, 85]\n    ¦no_fire: {default: 1.0e+13}", "default 1e+13: valid is a finite number"),
    ("[-85, 85]", "[-85, 85]\n    no_fire: ¦default", "expected {default: VALUE} or one of hold, midpoint, nan, found"),
    ("[-85, 85]", "[-85, 85]\n    no_fire: {¦hold: 1}", "unknown key 'hold'; valid: default"),
    ("  T:\n", "  ¦e:\n", "the name 'e' is used twice"),
    ("rows: e", "rows: ¦f", "unknown variable 'f'; valid: e, de"),
    ("columns: de", "columns: ¦e", "rows and columns are the same input 'e'"),
    ("output: T", "output: ¦e", "unknown variable 'e'; valid: T"),
    ("cells:\n      y:  [LR]\n", "¦cells:\n", "the row of the term 'y' of 'e' is missing"),
    ("y:  [LR]", "¦yy: [LR]", "unknown term of 'e': 'yy'; did you mean 'y'? valid: NO, y"),
    ("[LR]", "[¦LX]", "unknown term of 'T': 'LX'; valid: LL, LR; ~ is no rule"),
    ("[LR]", "¦[LR, LL]", "2 cells for the 1 terms of 'de': 1e3"),
    ("[LR]", "¦LR", "expected a list of 1 terms of 'T', found 'LR'"),
    ("is not 1e3", "is ¦nit 1e3", "unknown term of 'de': 'nit'; valid: 1e3"),
    ("with 0.5", "with ¦2", "expected a weight from 0 to 1, found '2'"),
    ('"if e is NO and', '"if \\"e\\" is NO ¦amd', "expected 'then', 'and' or 'or', found 'amd'"),
    ('"if e is NO and', '"\\x69f e \\u0069s NO ¦amd', "expected 'then', 'and' or 'or', found 'amd'"),
    ('- "if', '- ¦if e is NO\n      adn e is y\n    - "if', "expected 'then', 'and' or 'or', found 'adn'"),
    (
        '- "if e is NO and de is not 1e3 then T is LL with 0.5"',
        "- 'if \"e\" is ¦''NO'''",
        "unknown term of 'e'",
    ),
    ("and: product", "and: ¦prodct", "unknown word 'prodct'; did you mean 'product'? valid: min, product"),
    ("points: 101", "points: ¦1.5", "expected a whole number, found 1.5"),
    ("points: 101", "¦points: 1", "1 points: valid are 2 to 100000"),
    ("{points: 101, rule: endpoints}", "¦exakt", "expected exact or {points: 101, rule: endpoints}, found 'exakt'"),
    ("name: small", "name: sm¦\x00all", "the character '\\x00' is not allowed in text"),
    ("name: small", "? ¦[a]\n: b", "a key is a text, found a list"),
    ("name: small", f"name: {'[' * 11}¦{'[' * 40}", "nested more than 12 deep"),
]


@pytest.mark.parametrize(("old", "new", "message"), MISTAKES)
def test_a_mistake_is_located_and_says_what_is_valid(old, new, message):
    assert SMALL.count(old) == 1
    marked = SMALL.replace(old, new)
    before = marked.partition("¦")[0] if "¦" in marked else ""
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    with pytest.raises(FormatError) as caught:
        loads(marked.replace("¦", ""), "small.yaml")
    assert str(caught.value).startswith(f"small.yaml:{line}:{column}: error: ")
    assert caught.value.message.startswith(message)


def test_the_path_stands_in_the_message():
    with pytest.raises(FormatError) as caught:
        loads(SMALL.replace("[-100, -85, 0]", "[-100, x, 0]"), "small.yaml")
    message = "outputs.T.terms.LL.triangle[1]: expected a number such as 0.5, 1e3 or -.inf, found 'x'"
    assert str(caught.value) == f"small.yaml:16:29: error: {message}"


def _laughs() -> str:
    rows = "\n".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 30))
    return f"schema: fuzzy-workbench/1\na0: &a0 [lol]\n{rows}\n"


HOSTILE = {
    "empty": ("", "the file is empty"),
    "only a comment": ("# nothing\n", "the file is empty"),
    "null": ("~", "the file is empty"),
    "text": ("hello", "expected a mapping that begins with 'schema: fuzzy-workbench/1', found 'hello'"),
    "list": ("- a", "expected a mapping that begins with"),
    "alias bomb": (_laughs(), "anchors (&name) are not used"),
    "open brackets": ("schema: " + "[" * 500_000, "nested more than"),
    "open braces": ("{a: " * 200_000, "nested more than"),
    "block nesting": ("".join(" " * i + "a:\n" for i in range(1000)), "nested more than"),
    "list nesting": ("- " * 200_000, "nested more than"),
    "many items": ("[" + "a," * 500_000 + "]", "more than 50000 values"),
    "many keys": ("".join(f"k{i}: 1\n" for i in range(20_000)), "expected 'schema: fuzzy-workbench/1' first"),
    "long text": ("schema: " + "x" * 1_000_000, "unknown schema"),
    "long key": (f'? "{"k" * 900_000}"\n: 1', "a key of 900000 characters: at most 200"),
    "long number": (SMALL.replace("[-1, 1]", f"[-1, {'9' * 900_000}]"), "expected a number"),
    "two documents": (SMALL + "---\n" + SMALL, "a second document begins here"),
    "merge key": (SMALL + "<<: {name: x}\n", "unknown key '<<'"),
    "too long": ("#" * (MAX_BYTES + 1), "the file is larger than 1048576 bytes"),
    "surrogate": ("schema: \ud800", "the character '\\ud800' is not allowed"),
    "unknown directive": ("%YAML 3.0\n---\na: b", "this is not YAML"),
}


@pytest.mark.parametrize(("text", "message"), HOSTILE.values(), ids=HOSTILE)
def test_hostile_texts_are_refused(text, message):
    with pytest.raises(FormatError) as caught:
        loads(text, "hostile.yaml")
    assert caught.value.message.startswith(message)
    assert len(str(caught.value)) < 500
    assert caught.value.line >= 1 or "larger" in message


@pytest.mark.parametrize(
    ("content", "line", "column", "message"),
    [
        (b"schema: a\nname: \xff\xfe\n", 2, 7, "byte 0xff is not UTF-8 text"),
        (SMALL.encode("utf-16"), 1, 1, "byte 0xff is not UTF-8 text"),
        (bytes(range(256)) * 64, 2, 118, "byte 0x80 is not UTF-8 text"),
        (b"a: \x00", 1, 4, "the character '\\x00' is not allowed in text"),
        (b" " * (MAX_BYTES + 1), 0, 0, "the file is larger than 1048576 bytes"),
    ],
)
def test_hostile_bytes_are_refused(tmp_path, content, line, column, message):
    path = tmp_path / "hostile.yaml"
    path.write_bytes(content)
    with pytest.raises(FormatError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}:{line}:{column}: error: {message}")


def test_a_byte_order_mark_and_foreign_line_ends_are_read(tmp_path):
    path = tmp_path / "small.yml"
    path.write_bytes(b"\xef\xbb\xbf" + SMALL.replace("\n", "\r\n").encode())
    assert load(path) == loads(SMALL)


def test_what_is_no_file_is_refused(tmp_path):
    folder = tmp_path / "folder.yaml"
    folder.mkdir()
    with pytest.raises(FormatError, match="folder, not a file"):
        load(folder)
    with pytest.raises(FormatError, match="cannot be read: No such file"):
        load(tmp_path / "missing.yaml")
    with pytest.raises(FormatError, match="cannot be read"):
        load("nul\0.yaml")
    for path in ("system", "system.yaml.txt"):
        (tmp_path / path).write_text("no rule base", encoding="utf-8")
        with pytest.raises(FormatError, match=r"the content is none of"):
            load(tmp_path / path)
        with pytest.raises(FormatError, match=r"unknown suffix .*valid: \.yaml, \.yml"):
            save(loads(SMALL), tmp_path / path)


SHIPPED_TEXT = (RULEBASES / "diagonal.yaml").read_text(encoding="utf-8")
_junk = st.one_of(
    st.sampled_from(["[", "{", "}", ": ", "- ", "\n", "'", '"', "&a", "*a", "~", "\t", "!", "1e3", "#"]),
    st.text(max_size=5),
)


@given(st.sampled_from((SHIPPED_TEXT, SMALL)), st.data())
@settings(max_examples=300)
def test_a_damaged_file_is_read_or_refused_whole(text, data):
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.integers(0, 12)))
        text = text[:start] + data.draw(_junk) + text[end:]
    error = None
    try:
        system = loads(text)
        assert loads(dumps(system)) == system
    except FormatError as caught:
        error = caught
    assert error is None or (1 <= error.line <= text.count("\n") + 2 and error.column >= 1 and error.message)


@given(st.binary(max_size=200))
def test_binary_noise_is_refused(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "noise.yaml"
    path.write_bytes(content)
    with pytest.raises(FormatError):
        load(path)


def test_a_failed_save_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "system.yaml"
    system = loads(SMALL)
    save(system, path)
    with pytest.raises(InvalidSystemError):
        save(replace(system, name=""), path)
    with pytest.raises(FormatError, match="cannot be written"):
        save(system, tmp_path / "missing" / "system.yaml")

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(FormatError, match="No space left on device"):
        save(replace(system, name="other"), path)
    assert load(path) == system
    assert list(tmp_path.iterdir()) == [path]


def test_saving_keeps_permissions_and_follows_links(tmp_path):
    path, link = tmp_path / "system.yaml", tmp_path / "link.yaml"
    save(loads(SMALL), path)
    path.chmod(0o640)
    link.symlink_to(path)
    save(replace(loads(SMALL), name="other"), link)
    assert link.is_symlink()
    assert load(path).name == "other"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_system_too_large_to_be_read_again_is_not_written():
    terms = tuple(Term("x" * 60 + str(i), Triangle(0, 1, 2)) for i in range(4))
    antecedent = Not(Is("e" * 64, terms[0].name))
    rule = Rule(And((antecedent,) * 60), (Is("u", "L"),))
    inputs = (Input("e" * 64, 0, 1, terms),)
    outputs = (Output("u", 0, 1, (Term("L", Triangle(0, 1, 2)),)),)
    with pytest.raises(InvalidSystemError, match="bytes as a file: at most"):
        dumps(FuzzySystem("large", inputs, outputs, RuleBase(None, (rule,) * 200)))


def test_positions_point_at_keys_and_items(tmp_path):
    path = tmp_path / "small.yaml"
    path.write_text(SMALL)
    places = positions(path)
    assert places["inputs.e.terms.NO"] == (_line("NO: {"), 7)
    assert places["rules.table.cells.y[0]"] == (_line("[LR]"), 12)
    assert places["rules.list[0]"] == (_line('- "if'), 7)
