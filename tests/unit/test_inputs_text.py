"""The text of an inputs file: what is no TOML, what is no file for us, and anything at all."""

from __future__ import annotations

import json
import time
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given as drawn
from hypothesis import settings as drawing
from hypothesis import strategies as st
from sample_models import PIN_OFFER, faults, pin

from truing.errors import InputError
from truing.inputs_file import read_setup, setup_from_settings


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[inputs\n", ["1: '[inputs' is no heading of a section; write it like [inputs]"]),
        ("[inputs]\nrate = 0,5 # half\n", ["2: rate = 0,5 has a decimal comma; write rate = 0.5"]),
        ("[inputs]\nload = 0,36 kN\n", ['2: load = 0,36 kN has a decimal comma; write load = "0.36 kN"']),
        ('[sheet]\nlogo = "C:\\images\\logo.png"\n', ["2: a backslash stands alone in a text; put the text in "]),
        ("[inputs]\nload\n", ["2: 'load' is no line of TOML; write name = \"value\""]),
        ("[inputs]\nload: 3 N\n", ["2: 'load: 3 N' is no line of TOML; write name = \"value\""]),
        ("[inputs]\nload =\n", ['2: load has no value; write load = "value"']),
        ('[inputs]\nload = "3 N\n', ['2: the closing quotation mark is missing; write load = "3 N"']),
        (
            '[inputs]\nload = "3 N"\nload = "4 N"\n',
            ["3: 'load' is given twice (first in line 2); write it once"],
        ),
        ("[inputs]\n[units]\n[inputs]\n", ["3: the section [inputs] occurs twice (first in line 1); write it once"]),
        (
            '[inputs]\nload = 10 N # heavy\nspeed = 5 mms\nrate = "x"\n',
            [
                '2: load = 10 N needs quotation marks; write load = "10 N"',
                '3: speed = 5 mms needs quotation marks; write speed = "5 mms"',
                "3: speed: unknown unit 'mms'; did you mean 'mm'?",
                "4: rate: 'x' does not begin with a number; write it like '5 mm'",
            ],
        ),
        ("[inputs]\nrate = [1,\nload = \"1 m\"\n", [
            "2: this is no TOML: ", "3: load: '1 m' is a length (m), expected a force (N)",
        ]),
        ("a = " + "[" * 3000 + "\n", ["1: is nested too deeply"]),
        (".".join("a" * 60) + " = 1\n", ["1: holds a name with more than 40 dots"]),
        ("\x00", ["1: "]),
    ],
)  # fmt: skip
def test_a_text_that_is_no_toml(text: str, expected: list[str]) -> None:
    found = faults(text)
    assert len(found) == len(expected)
    for sentence, beginning in zip(found, expected, strict=True):
        assert sentence.startswith(f"wear.toml:{beginning}")


def test_lines_are_right_behind_long_texts_and_lists() -> None:
    text = (
        '[sheet]\nproject = """\na = 1\n[inputs]\n"""\n[studies]\nrun = [\n  "census", # one\n]\n[inputs]\nlaod = 1\n'
    )
    assert faults(text)[0].startswith("wear.toml:11: pin_wear has no input 'laod'")


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("empty.toml", b"", "is empty; `calc init pin_wear` writes an example"),
        ("blank.toml", b"\n \n", "is empty; `calc init pin_wear` writes an example"),
        ("binary.toml", b"\x7fELF\x00\x01", "is a binary file; inputs are a TOML text in UTF-8"),
        ("book.toml", b"PK\x03\x04...", "is a spreadsheet; save it as .xlsx, or write inputs as TOML text"),
        ("old.xls", b"\xd0\xcf\x11\xe0", "is a spreadsheet; save it as .xlsx, or write inputs as TOML text"),
        ("wide.toml", "[inputs]".encode("utf-16"), "is text in UTF-16; save it as UTF-8"),
        ("large.toml", b"#" * 2_000_001, "is too large: 2.0 MB, at most 2 MB are read"),
    ],
)
def test_a_file_that_is_no_inputs_file(tmp_path: Path, name: str, content: bytes, sentence: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_setup(path, PIN_OFFER)
    assert str(caught.value) == f"{path}:1: {sentence}"


def test_what_cannot_be_opened_or_decoded_is_told_with_its_name(tmp_path: Path) -> None:
    (tmp_path / "latin.toml").write_bytes("[sheet]\nproject = 'Prüfstand'\n".encode("latin-1"))
    (tmp_path / "loop.toml").symlink_to("loop.toml")
    (tmp_path / "gone.toml").symlink_to("was_here.toml")
    for name, sentence in {
        "latin.toml": ":2: is not UTF-8 text; save it as UTF-8",
        "loop.toml": ": is a symbolic link that leads back to itself; name the file",
        "gone.toml": ": is a symbolic link to 'was_here.toml', which is not there",
        ".": ": is a folder; name a file",
        "latn.toml": ": no such file. Did you mean 'latin.toml'?",
    }.items():
        with pytest.raises(InputError) as caught:
            read_setup(tmp_path / name, PIN_OFFER)
        assert str(caught.value) == f"{tmp_path / name}{sentence}"


LONG, CONTROL = "q" * 20_000, "a\x1b[31mb\u202ec"


@pytest.mark.parametrize("word", [LONG, CONTROL], ids=["long", "control characters"])
def test_what_a_user_wrote_is_quoted_short_and_in_one_line(word: str) -> None:
    key = json.dumps(word)
    texts = [
        f'[tolerances]\n{key} = "±1 N"', f"[tolerances]\nload = {key}", f"[tolerances]\nload = {{ {key} = 1 }}",
        f"[inputs]\n{key} = 1", f"[inputs]\nload = {key}", f"[inputs.load]\n{key} = 1", f"[{key}]\nx = 1", f"[{key}",
        f"plugin = {key}", f"[studies]\nrun = [{key}]", f"[studies.{key}]\nx = 1", f"[studies.census]\nmethod = {key}",
        f"[units]\ndepth = {key}", f'[conditions]\n{key} = "1 K"', f"[effects.warm_probe]\nslope = {key}",
        f"[inputs]\n{key} = 1\n{key} = 2", f"[inputs]\nload = {{ file = {key} }}", f"[inputs]\n{word} = 5 mm", word,
        f"[inputs]\nload = {word}", f'[inputs]\nload = "{word}', f"[{key}]\n[{key}]",
    ]  # fmt: skip
    for text in texts:
        assert all(len(sentence) < 500 and sentence.isprintable() for sentence in faults(text)), text[:60]


HOSTILE: dict[str, Callable[[int], str]] = {
    "escaped quotes without an end": lambda n: 'a = "' + '\\"' * (n // 2),
    "escaped quotes in a list": lambda n: 'a = ["' + '\\"' * (n // 2),
    "escaped quotes as a key": lambda n: 'a."' + '\\"' * (n // 2),
    "quotes": lambda n: "[inputs]\n" + '"' * n,
    "backslashes": lambda n: 'a = "' + "\\" * n,
    "long texts without an end": lambda n: "a = '''" * (n // 7),
    "long texts with backslashes": lambda n: 'a = """\\' * (n // 8),
    "long text of quotes": lambda n: 'a = """' + '""\\' * (n // 3) + '"""',
    "blanks in a heading": lambda n: "[a]" + " " * n + "x",
    "blanks behind a key": lambda n: "a" + " " * n + "x",
    "open lists": lambda n: "a = [\n" * (n // 6),
    "open list of lines": lambda n: "a = [\n" + '"x",\n' * (n // 5),
    "inline tables": lambda n: "a = {b = " * (n // 9),
    "foreign letters": lambda n: "[inputs]\n" + "é" * (n // 2) + " = 3",
    "dots": lambda n: "a." * (n // 2) + "b = 1",
    "dots in a table": lambda n: "a = {c = '''it's''', " + "b." * (n // 2) + "c = 1}",
    "a unit": lambda n: '[inputs]\nload = "1 ' + "m*" * (n // 2) + 'N"',
    "same name": lambda n: "x = 1\n" * (n // 6),
    "unknown names": lambda n: "[inputs]\n" + "".join(f"load{i} = 1\n" for i in range(n // 14)),
    "values without quotes": lambda n: "[inputs]\n" + "".join(f"load{i} = 1 N\n" for i in range(n // 14)),
    "unknown sections": lambda n: "".join(f"[inputs.load{i}]\n" for i in range(n // 16)),
}
SIZE = 6_000
NAMES = "[inputs]\n" + "".join(f"load{i} = 1\n" for i in range(120_000))


def processor_time(text: str) -> float:
    """Return the processor seconds that the answer takes; what is said stays short."""
    begin = time.process_time()
    found = faults(text)
    taken = time.process_time() - begin
    assert len(found) <= 201
    assert all(len(sentence) < 500 for sentence in found)
    return taken


@pytest.mark.parametrize("kind", HOSTILE)
def test_reading_time_grows_with_the_size_of_a_file(kind: str) -> None:
    """Four times the text takes about four times as long; a scan that goes back takes sixteen times."""
    small = min(processor_time(HOSTILE[kind](SIZE)) for _ in range(3))
    large = min(processor_time(HOSTILE[kind](4 * SIZE)) for _ in range(3))
    assert large < 9 * max(small, 0.004)


@pytest.fixture(scope="module")
def seconds_of_tomllib() -> float:
    """What Python's own reader takes for 120,000 names, about half a second on a machine of its own."""
    begin = time.process_time()
    tomllib.loads(NAMES)
    return time.process_time() - begin


@pytest.mark.parametrize(
    "text",
    [NAMES, "[" * 1_900_000, '[inputs]\nload = "' + "9" * 1_900_000 + ' N"'],
    ids=["120000 names", "brackets", "digits"],
)
def test_a_large_file_that_is_no_inputs_file_is_answered_at_once(text: str, seconds_of_tomllib: float) -> None:
    assert processor_time(text) < 5 * seconds_of_tomllib


LINES = st.one_of(
    st.text(max_size=40),
    st.sampled_from(["[inputs]", "[tolerances]", "[effects.warm_probe]", "[studies]", "[studies.census]", "[units]"]),
    st.builds(
        "{} = {}".format,
        st.sampled_from(["load", "rate", "slope", "run", "seed", "draws", "depth", "plugin", "probe_temperature"]),
        st.one_of(
            st.text(max_size=20),
            st.builds('"{}"'.format, st.text(max_size=20)),
            st.sampled_from(
                ['"3 N"', '"±1 N"', "[1]", "{a = 1}", "true", "1e999", "nan", "2001-01-01", '"IT7"', "'x'"]
            ),
        ),
    ),
)


def said(read: Callable[[], object]) -> list[str]:
    """Return what is wrong, a line each; nothing where all is right. Anything but an InputError fails the test."""
    try:
        read()
    except InputError as error:
        return [str(fault) for fault in error.faults] or ["an InputError without faults"]
    return []


@drawing(max_examples=200, deadline=2000)
@drawn(st.one_of(st.text(), st.lists(LINES, max_size=12).map("\n".join)))
def test_any_text_is_a_setup_or_an_input_error(text: str) -> None:
    assert all(sentence.startswith("wear.toml:") and "\n" not in sentence for sentence in said(lambda: pin(text)))


@drawing(max_examples=100, deadline=2000)
@drawn(st.binary(max_size=200))
def test_any_bytes_are_a_setup_or_an_input_error(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_bytes(content)
    assert all(sentence.startswith(f"{path}:") for sentence in said(lambda: read_setup(path, PIN_OFFER)))


@drawing(max_examples=200, deadline=2000)
@drawn(st.text(max_size=30))
def test_any_override_is_a_setup_or_an_input_error(text: str) -> None:
    names = ("load", text, "studies.census.draws", "tolerances.load", "effects.warm_probe.slope", "effects")
    for name in names:
        found = said(lambda name=name: setup_from_settings(PIN_OFFER, {name: text}))
        assert all(sentence.startswith("settings") for sentence in found)
