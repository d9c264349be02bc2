"""A change of an inputs file leaves every other byte; the form and what it says; saving loses nothing."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from truing.errors import InputError, UsageError
from truing.example_file import text_to_fill_in
from truing.inputs_file import setup_from_text
from truing.inputs_file.assemble import toml_value
from truing.kernel import offer_of
from truing.workbench.guard import Key
from truing.workbench.server import application
from truing.workbench.tasks import form, task
from truing.workbench.tasks.loaded import loaded
from truing.workbench.workers import TaskError, fault_of
from truing.workbench.written import changed_text, switched_text

MODELS = ("press_linkage", "rv_wear", "harmonic_fractal.vibration")


@lru_cache
def example(plugin: str) -> str:
    """The commented example of a calculation."""
    return text_to_fill_in(offer_of(plugin, lambda text: None))


def stated(text: str, path: tuple[str, ...]) -> Any:
    """What a text states at a path, by another reader of TOML."""
    table: Any = tomllib.loads(text)
    for name in path:
        table = table.get(name) if isinstance(table, dict) else None
    return table


@pytest.mark.parametrize("plugin", MODELS)
def test_a_change_and_its_way_back_give_the_same_bytes(plugin: str) -> None:
    text = example(plugin)
    paths = [
        field.path for field in form._fields(plugin).values() if field.path[0] != "effects" and len(field.path) == 2
    ]
    assert len(paths) > 50
    for path in paths:
        before = stated(text, path)
        changed = changed_text(text, path, '"77 furlong"', saved=text)
        assert stated(changed, path) == "77 furlong", path
        kept = [line for line in changed.split("\n") if "77 furlong" not in line]
        assert all(line in text or f"# {line}" in text or line == f"[{path[0]}]" for line in kept), path
        if before is None:
            assert changed_text(changed, path, None, saved=text) == text, path
        elif isinstance(before, str):
            assert changed_text(changed, path, toml_value(before), saved=text) == text, path
        without = changed_text(text, path, None, saved=text)
        assert stated(without, path) is None, path
        if before is not None:
            assert changed_text(without, path, toml_value(before), saved=text) == text, path


@pytest.mark.parametrize("plugin", MODELS)
def test_an_effect_of_the_example_goes_on_and_off_without_a_trace(plugin: str) -> None:
    text = example(plugin)
    for effect in loaded(plugin).model.effects.values():
        literals = {unknown.name: "0.5" for unknown in effect.unknowns}
        on = switched_text(text, ("effects", effect.name), literals, on=True, saved=text)
        assert set(stated(on, ("effects", effect.name))) == set(literals)
        assert switched_text(on, ("effects", effect.name), literals, on=False, saved=text) == text, effect.name
        saved = switched_text(on, ("effects", effect.name), literals, on=False, saved=on)
        assert stated(saved, ("effects", effect.name)) is None
        assert switched_text(saved, ("effects", effect.name), literals, on=True, saved=on) == on, effect.name


@pytest.mark.parametrize(
    ("text", "path", "literal", "expected"),
    [
        ("[inputs]\na = 'x'  # why\n", ("inputs", "a"), '"y"', "[inputs]\na = 'y'  # why\n"),
        ("[inputs]\n  a  =  1 # b\n", ("inputs", "a"), "2.50", "[inputs]\n  a  =  2.50 # b\n"),
        ("inputs.a = 1\n", ("inputs", "a"), "2", "inputs.a = 2\n"),
        ("inputs.a = 1\n", ("inputs", "b"), "2", "inputs.a = 1\ninputs.b = 2\n"),
        ("inputs = { a = 1 }\n", ("inputs", "b"), "2", "inputs = { a = 1, b = 2 }\n"),
        ('[inputs]\nf = "a.csv" # k\n', ("inputs", "f", "file"), '"b.csv"', '[inputs]\nf = "b.csv" # k\n'),
        ('[inputs]\nf = "a.csv"\n', ("inputs", "f", "step"), "2", '[inputs]\nf = { file = "a.csv", step = 2 }\n'),
        ("[inputs]\n# b = 3\n\n[studies]\n", ("inputs", "b"), "3", "[inputs]\nb = 3\n\n[studies]\n"),
        ("[inputs]\n# b = 3  # as\n#         # before\nc = 1", ("inputs", "b"), "4",
         "[inputs]\n# b = 3  # as\n#         # before\nb = 4\nc = 1"),
        ("[inputs]\na = 1\n# [tolerances]\n# a = 2\nb = 2\n", ("tolerances", "a"), "3",
         "[inputs]\na = 1\n# [tolerances]\n# a = 2\nb = 2\n\n[tolerances]\na = 3\n"),
        ("a = 36 mm # n\n", ("a",), '"1 m"', 'a = "1 m"  # n\n'),
        ("x = [\n[inputs]\na = 1\n", ("inputs", "a"), "2", "x = [\n[inputs]\na = 2\n"),
        ("", ("inputs", "a b"), "2", '\n[inputs]\n"a b" = 2\n'),
    ],
)  # fmt: skip
def test_a_value_is_stated_where_it_belongs(text: str, path: tuple[str, ...], literal: str, expected: str) -> None:
    assert changed_text(text, path, literal, order=["a", "b", "c"]) == expected


def test_a_line_inside_a_broken_table_is_left_alone() -> None:
    with pytest.raises(UsageError, match="line 2 is no TOML as it stands; mend it in the text first"):
        changed_text("[inputs]\nf = { file = \n", ("inputs", "f", "step"), "1")


def state(
    change: dict[str, Any] | None = None, text: str | None = None, plugin: str = "press_linkage"
) -> dict[str, Any]:
    """The answer to a change of the example."""
    before = example(plugin) if text is None else text
    return form.state(plugin, "press.toml", ".", before, saved=before, change=change)


def test_a_field_answers_with_the_sentence_of_the_command_line_or_with_its_value() -> None:
    path = ["inputs", "crank_radius"]
    good = state({"path": path, "value": "36 cm"})
    line = 1 + next(n for n, said in enumerate(good["text"].split("\n")) if said.startswith("crank_radius"))
    assert good["fields"]["inputs/crank_radius"] == {"value": "36 cm", "line": line, "answer": "= 0.36 m"}
    bad = state({"path": path, "value": '3"; [x]\n'})
    assert bad["fields"]["inputs/crank_radius"]["value"] == '3"; [x]\n'
    with pytest.raises(InputError) as caught:
        setup_from_text(bad["text"], loaded("press_linkage"), file="press.toml", folder=Path())
    assert [fault["message"] for fault in bad["faults"]] == [fault.message for fault in caught.value.faults]
    assert bad["faults"][0]["key"] == "inputs/crank_radius"
    assert (
        state({"path": path, "unit": "in"})["fields"]["inputs/crank_radius"]["value"] == "14.1732283465 in"
    )  # 360 / 25.4
    assert (
        state({"path": ["inputs", "position_goal"], "value": "0.90"})["fields"]["inputs/position_goal"]["value"]
        == "0.90"
    )
    assert "position_goal = 0.90 " in state({"path": ["inputs", "position_goal"], "value": "0.90"})["text"]
    with pytest.raises(UsageError, match="the form has no field"):
        state({"path": ["inputs", "nothing"], "value": "1"})


def test_a_text_that_is_no_toml_still_fills_the_form() -> None:
    answer = state(
        text='plugin = "press_linkage"\n[inputs]\nrod_length = "1.3 m"\ncrank_radius = 36 mm\n[units]\nx = 1\n'
    )
    assert answer["fields"]["inputs/rod_length"]["value"] == "1.3 m"
    assert answer["faults"][0]["key"] == "inputs/crank_radius"
    assert answer["faults"][0]["line"] == 4
    assert answer["others"] == [{"name": "units.x", "line": 6}]


def test_the_form_asks_for_all_that_the_model_declares() -> None:
    for plugin in MODELS:
        model, keys = loaded(plugin).model, set(form._fields(plugin))
        assert {f"inputs/{name}" for name in model.input_fields} <= keys
        assert {f"tolerances/{name}" for name in model.tolerances} <= keys
        assert {f"conditions/{name}" for name in model.conditions} <= keys
        assert {f"effects/{e.name}/{u.name}" for e in model.effects.values() for u in e.unknowns} <= keys
    assert form._fields("press_linkage")["inputs/crank_radius"].bounds == "> 0, < 30 m"
    assert task("form.described")("press_linkage")["groups"][1]["title"] == "The mechanism, one side"


def test_the_form_of_a_program_follows_its_file(tmp_path: Path) -> None:
    program = tmp_path / "pin_wear.py"
    text = (Path(__file__).parents[1] / "data" / "pin_wear.py").read_text(encoding="utf-8")
    for note in ("normal load on the pin", "weight on the pin, all of it"):
        program.write_text(text.replace("normal load on the pin", note), encoding="utf-8")
        assert note[1:] in json.dumps(task("form.described")(str(program)))


class Here:
    """Workers that do what is asked in this process."""

    def __init__(self) -> None:
        self.jobs: dict[str, Any] = {}
        self.closed = False

    def ask(self, name: str, *, patience: float = 0, **arguments: Any) -> Any:
        try:
            return task(name)(**arguments)
        except UsageError as error:
            raise TaskError([fault_of(str(getattr(error, "faults", [error])[0]))]) from None

    def close(self) -> None: ...


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    """A browser that may come in."""
    key = Key(1)
    app: Any = application(tmp_path, key, frozenset({"testserver"}), Here())  # type: ignore[arg-type]
    with TestClient(app, cookies={key.cookie: key.token}, headers={"origin": "http://testserver"}) as browser:
        yield browser


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def test_saving_keeps_line_ends_and_mark_and_writes_over_nobody(client: TestClient, tmp_path: Path) -> None:
    path, before = tmp_path / "a.toml", b'\xef\xbb\xbfplugin = "press_linkage"\r\n'
    path.write_bytes(before)
    assert "plugin = &#34;press_linkage&#34;\n" in client.get("/edit?file=a.toml").text

    def save(text: str, base: bytes) -> dict[str, Any]:
        answer: dict[str, Any] = client.post(
            "/api/save", json={"file": "a.toml", "text": text, "base": digest(base)}
        ).json()
        return answer

    assert "digest" in save('plugin = "x"\n', before)
    assert path.read_bytes() == b'\xef\xbb\xbfplugin = "x"\r\n'
    assert save("other\n", before)["conflict"]
    assert path.read_bytes() == b'\xef\xbb\xbfplugin = "x"\r\n'
    read = client.post("/api/read", json={"file": "a.toml", "text": "mine\n"}).json()
    assert read["differences"] == [{"mine": ["mine"], "mine_line": 1, "theirs": ['plugin = "x"'], "theirs_line": 1}]
    assert "larger than 2 MB" in save("#" * 2_000_001, path.read_bytes())["faults"][0]["message"]
    path.chmod(0o444)
    assert save("y\n", path.read_bytes())["faults"][0]["message"] == "a.toml is read-only; nothing was written"
    path.unlink()
    assert client.post("/api/read", json={"file": "a.toml", "text": ""}).json()["gone"]
    assert "digest" in save("y\n", b"")
    assert path.read_bytes() == b"y\n"


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"\xff\xfep\0", "a.toml: is text in UTF-16; save it as UTF-8"),
        (b'plugin = "\xe9"', "a.toml: is not UTF-8 text; save it as UTF-8"),
        (b"#" * 2_000_001, "a.toml: is too large: 2.0 MB, at most 2 MB are read"),
        (b"[inputs]\n", "a.toml names no calculation; write plugin = "),
        (None, "a.toml: no such file"),
    ],
)
def test_a_file_that_cannot_be_edited_gets_one_sentence(
    client: TestClient, tmp_path: Path, content: bytes | None, sentence: str
) -> None:
    if content is not None:
        (tmp_path / "a.toml").write_bytes(content)
    answer = client.get("/edit?file=a.toml")
    assert answer.status_code == 422
    assert sentence in answer.text
