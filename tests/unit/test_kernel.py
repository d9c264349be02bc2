"""The kernel: who offers what, who adds what, and who is left out with name, version, file, line and reason."""

import json
import sys
import textwrap
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from types import ModuleType

import pytest

from shared import TESTS
from truing import Kernel
from truing.errors import PluginError, UnknownPluginError
from truing.kernel import Origin, entry_points, kernel_for

GOOD = """
from truing import Float, Model, Tolerance, found, given, hookimpl, inputs, off, results

@inputs
class Pin:
    load: Float = given(2.0, "N")
    area: Float = given(1.0, "m^2")

@results
class Wear:
    pressure: Float = found("Pa", formula="load / area")

def wear(pin: Pin) -> Wear:
    return Wear(pressure=pin.load / pin.area)

MODEL = Model(name="{name}", title="A pin", function=wear)

@hookimpl
def truing_models():
    return [MODEL]
"""

GUEST_HEAD = """
from dataclasses import replace
from truing import (Condition, Effect, Float, Maximise, Minimise, Require, Section, Tolerance, Unknown, hookimpl,
                    normal, off)
"""

Write = Callable[..., ModuleType]


def forget(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Take a module out of those imported, now, and at the end of the test again whatever was imported meanwhile."""
    monkeypatch.setitem(sys.modules, name, ModuleType(name))
    del sys.modules[name]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Write a module and import it."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def make(name: str, text: str) -> ModuleType:
        file = tmp_path / f"{name}.py"
        file.write_text(textwrap.dedent(text), encoding="utf-8")
        forget(monkeypatch, name)
        return __import__(name)

    return make


def guest(hook: str, answer: str, head: str = "") -> str:
    argument = "" if hook == "truing_models" else "model"
    return f"{GUEST_HEAD}{head}\n@hookimpl\ndef {hook}({argument}):\n    return {answer}\n"


def installed_from(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, **texts: str | None) -> list[metadata.EntryPoint]:
    """Put plugins on the path as installed distributions: module texts by name; None leaves the module out."""
    monkeypatch.syspath_prepend(str(tmp_path))
    for name, text in texts.items():
        forget(monkeypatch, name)
        folder = tmp_path / f"{name}-3.1.dist-info"
        folder.mkdir()
        (folder / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}-dist\nVersion: 3.1\n", encoding="utf-8")
        (folder / "entry_points.txt").write_text(f"[truing.plugins]\n{name} = {name}\n", encoding="utf-8")
        if text is not None:
            (tmp_path / f"{name}.py").write_text(textwrap.dedent(text), encoding="utf-8")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    return [entry for entry in entry_points() if entry.name in texts]


# What is offered, and by which names

PIN, SAME = GOOD.format(name="pin_one"), GOOD.format(name="pin_wear")
TWO = GOOD.replace("return [MODEL]", "return [MODEL, Model(name='{other}', title='', function=wear)]")
NAMES = [
    ({"pin_one": PIN}, {"pin_one": "pin_one", "pin_one.pin_one": "pin_one"}, {}),
    ({"pins": SAME}, dict.fromkeys(("pins.pin_wear", "pins", "pin_wear"), "pins.pin_wear"), {}),
    (
        {"pins": TWO.format(name="first", other="second")},
        {"first": "pins.first", "pins.second": "pins.second"},
        {"pins": r"offers pins\.first and pins\.second; write one of these"},
    ),
    (
        {"left": SAME, "right": SAME},
        {"left": "left.pin_wear", "right.pin_wear": "right.pin_wear"},
        {"pin_wear": r"'pin_wear' is used twice, by left\.pin_wear and right\.pin_wear"},
    ),
    (
        {"pin_wear": SAME, "other": SAME},
        {"other.pin_wear": "other.pin_wear", "pin_wear.pin_wear": "pin_wear.pin_wear"},
        {"pin_wear": "is used twice"},
    ),
    ({"pins": TWO.format(name="same", other="same")}, {"pins": "pins.same"}, {}),
    ({"pin_one": PIN}, {}, {"pin_on": r"no plugin offers 'pin_on'\. Did you mean 'pin_one'\? Installed: pin"}),
    ({}, {}, {"pin_one": "Installed: none"}),
]


@pytest.mark.parametrize(("texts", "names", "refused"), NAMES)
def test_a_model_is_found_by_its_names(
    write: Write, texts: dict[str, str], names: dict[str, str], refused: dict[str, str]
) -> None:
    kernel = Kernel([write(name, text) for name, text in texts.items()])
    for name, full in names.items():
        assert kernel.offer(name).name == full
        assert kernel.offer(name).origin.name == full.partition(".")[0]
    for name, sentence in refused.items():
        with pytest.raises(UnknownPluginError, match=sentence):
            kernel.offer(name)


def test_what_is_used_twice_is_said_of_both(write: Write) -> None:
    kernel = Kernel([write(name, SAME) for name in ("left", "right")])
    assert [broken.plugin for broken in kernel.broken] == ["left", "right"]
    assert all("left" in broken.reason and "right" in broken.reason for broken in kernel.broken)
    (twins,) = Kernel([write("pins", TWO.format(name="same", other="same"))]).broken
    assert "offers two models called 'same'" in twins.reason
    kernel = Kernel([write("pin_one", PIN)] * 2)
    assert list(kernel.offers) == ["pin_one"]
    assert "the plugin name 'pin_one' is taken by" in kernel.broken[0].reason


# Broken plugins: named with version, file, line and exception, while every other works


def hook_that(answers: str) -> str:
    """The good module, but for what its hook does."""
    return GOOD.format(name="guest_m").replace("return [MODEL]", answers)


BROKEN = {
    "import error": (
        "import math\nimport gone\n",
        2,
        "ModuleNotFoundError: No module named 'gone'",
    ),
    "syntax error": ("x = 1\n\ndef f(:\n    pass\n", 3, "SyntaxError: "),
    "raises": ("x = 1\nraise RuntimeError('no licence')\n", 2, "RuntimeError: no licence"),
    "leaves": ("import sys\n\n\nsys.exit(3)\n", 4, "SystemExit: 3"),
    "missing": (None, None, "ModuleNotFoundError: No module named 'guest_m'"),
    "bad declaration": (GOOD.format(name="my pin"), 16, "DeclarationError: model 'my pin': the name 'my pin' may hold"),
    "hook raises": (hook_that("return [MODEL][1]"), 20, "IndexError: list index out of range"),
    "hook returns nothing": (hook_that("pass"), 18, "DeclarationError: truing_models returned None; it returns a list"),
    "hook returns no model": (hook_that("return [Pin]"), 18, "which is no Model"),
    "wrong signature": (guest("truing_objectives", "[]").replace("(model)", "(model, file)"), 6, "asks for 'file'"),
    "misspelt hook": (guest("truing_models", "[]").replace("g_models", "g_model"), 6, "'truing_model' is no hook"),
    "unmarked hook": (GOOD.format(name="guest_m").replace("@hookimpl\n", ""), 18, "truing_models() is not marked"),
    "offers nothing": ("x = 1\n", None, "it offers nothing"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_plugin_is_named_and_disturbs_nobody(
    case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Importlib_metadata, once imported (dask needs it), loads entry points too; a line of it is nobody's fault."""
    pytest.importorskip("importlib_metadata")
    text, line, reason = BROKEN[case]
    installed_from(tmp_path, monkeypatch, guest_m=text, pin_one=PIN)
    kernel = Kernel.installed()
    assert kernel.offer("pin_one").model.title == "A pin"
    broken = next(item for item in kernel.broken if item.plugin == "guest_m")
    file = "guest_m" if text is None else str(tmp_path / "guest_m.py")
    assert (broken.version, broken.file, broken.line) == ("3.1", file, line)
    assert reason in broken.reason
    place = f"{broken.file}:{line}" if line else broken.file
    assert str(broken) == f"{place}: plugin 'guest_m' 3.1: {broken.reason}"
    with pytest.raises(PluginError, match=r"plugin 'guest_m' 3\.1: "):
        kernel.offer("guest_m")
    with pytest.raises(PluginError, match=r"plugin 'guest_m' 3\.1: ") as caught:
        Kernel.installed(strict=True).offers  # noqa: B018
    assert type(caught.value.__cause__).__name__ in broken.reason or not line


def test_a_fault_in_a_module_of_the_guest_is_named_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed_from(tmp_path, monkeypatch, guest_m=None)
    package = tmp_path / "guest_m"
    package.mkdir()
    (package / "__init__.py").write_text("from guest_m import physics\n", encoding="utf-8")
    (package / "physics.py").write_text("import numpy as np\n\nnp.zeros(-1)\n", encoding="utf-8")
    broken = next(item for item in Kernel.installed().broken if item.plugin == "guest_m")
    assert (broken.file, broken.line) == (str(package / "physics.py"), 3)
    assert "ValueError: negative dimensions" in broken.reason


def test_names_come_from_metadata_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = installed_from(tmp_path, monkeypatch, guest_m="raise RuntimeError", pin_one=PIN)
    assert [entry.name for entry in found] == ["guest_m", "pin_one"]
    assert "guest_m" not in sys.modules
    kernel = Kernel.installed()
    origin = kernel.offer("pin_one").origin
    assert (origin.version, origin.distribution, origin.ref) == ("3.1", "pin_one-dist", "entry:pin_one")


# Guests that add to somebody else's model

EFFECT = "[Effect('wider', on_inputs=wider, unknowns=[Unknown('extra', 0, 1, 'm^2')])]"
ADDITIONS: list[tuple[str, str, str]] = [
    ("truing_error_sources", "[Tolerance('load', normal(sd='3 %'))]", "load"),
    ("truing_error_sources", EFFECT, "wider"),
    ("truing_objectives", "[Minimise('pressure')]", "pressure"),
    ("truing_reports", "[Section('Pressure', 'pressure')]", "Pressure"),
]
WIDER = "\ndef wider(pin, *, extra):\n    return replace(pin, area=pin.area + extra)\n"


@pytest.mark.parametrize(("hook", "answer", "what"), ADDITIONS)
def test_a_guest_adds_to_somebody_elses_model(write: Write, hook: str, answer: str, what: str) -> None:
    kernel = Kernel([write("zebra", guest(hook, answer, WIDER)), write("pin_one", PIN)])
    offer = kernel.offer("pin_one")
    assert kernel.broken == []
    assert [(item.what, item.plugin) for item in offer.added] == [(what, "zebra")]
    assert len([*offer.model.errors, *offer.model.objectives, *offer.model.sheet]) == 1
    own = Kernel([write("pin_one", PIN + guest(hook, answer, WIDER))]).offer("pin_one")
    assert len([*own.model.errors, *own.model.objectives, *own.model.sheet]) == 1
    assert own.added == ()  # what a plugin adds to its own model is its own


BAD_ADDITIONS: list[tuple[str, str, str]] = [
    ("truing_error_sources", "[Tolerance('laod', off())]", "'laod', which is no input. Did you mean 'load'?"),
    ("truing_error_sources", "[Tolerance('area', off())]", "two error sources are called 'area'"),
    ("truing_error_sources", "[Tolerance('x', 'sd 3 %', on=['load'])]", "has the spread 'sd 3 %'"),
    ("truing_error_sources", "['load']", "is neither a Tolerance nor an Effect"),
    ("truing_error_sources", "[None]", "is neither a Tolerance nor an Effect"),
    (
        "truing_error_sources",
        "[Effect('e', on_inputs=lambda p, *, a, load: p, unknowns=[Unknown('a', 0, 1)], "
        "needs=[Condition('load', 'N')])]",
        "the condition 'load' has the name of an input",
    ),
    ("truing_objectives", "[Minimise('presure')]", "'presure', which is neither input nor result. Did you mean"),
    ("truing_objectives", "['pressure']", "is no objective"),
    ("truing_reports", "[Section('Wear', 'depth')]", "section 'Wear' names 'depth', which is no result"),
    ("truing_reports", "[3]", "3 is no Section"),
]


@pytest.mark.parametrize(("hook", "answer", "reason"), BAD_ADDITIONS)
def test_what_does_not_fit_is_left_out_by_name(write: Write, hook: str, answer: str, reason: str) -> None:
    first = guest("truing_error_sources", "[Tolerance('area', off())]")
    third = guest("truing_reports", "[Section('Pressure', 'pressure')]")
    modules = [write("a_guest", first), write("bad", guest(hook, answer)), write("c_guest", third)]
    kernel = Kernel([*modules, write("pin_one", PIN)])
    offer = kernel.offer("pin_one")
    assert [item.plugin for item in offer.added] == ["a_guest", "c_guest"]
    (broken,) = kernel.broken
    assert (broken.plugin, broken.line) == ("bad", 6)
    assert broken.file.endswith("bad.py")
    assert reason in broken.reason
    assert "is left out of 'pin_one'" in broken.reason


@pytest.mark.parametrize(
    ("answer", "reason"), [("[1 / 0]", "ZeroDivisionError: division by zero"), ("exit(7)", "SystemExit: 7")]
)
def test_a_guest_whose_hook_fails_is_left_out(write: Write, answer: str, reason: str) -> None:
    kernel = Kernel([write("pin_one", PIN), write("zebra", guest("truing_reports", answer))])
    assert kernel.offer("pin_one").added == ()
    assert [(item.plugin, item.line, item.reason) for item in kernel.broken] == [("zebra", 8, reason)]


def test_guests_come_in_the_order_of_their_names_and_hit_only_whom_they_fit(write: Write) -> None:
    names = ["delta", "alpha", "charlie", "bravo"]
    guests = [
        write(name, guest("truing_error_sources", f"[Tolerance('{name}', off(), on=['load'])]")) for name in names
    ]
    other = GOOD.format(name="pin_two").replace("load", "force")
    kernel = Kernel([*guests, write("pin_one", PIN), write("pin_two", other)])
    offer = kernel.offer("pin_one")
    assert list(offer.model.tolerances) == [item.plugin for item in offer.added] == sorted(names)
    assert list(kernel.offer("pin_two").model.tolerances) == []
    assert all("is left out of 'pin_two'" in broken.reason for broken in kernel.broken)
    again = kernel_for(offer.origin.ref)  # modules stand alone, as they were given
    assert set(again.offers) == {"pin_one", "pin_two"}
    assert again.offer("pin_one").added == offer.added


def test_asking_twice_changes_nothing(write: Write) -> None:
    kernel = Kernel([write("pin_one", PIN), write("zebra", guest("truing_reports", "[3]"))])
    assert (len(kernel.broken), len(kernel.broken)) == (1, 1)
    kernel.add(Origin("late", "1", "", "late.py", "module:late"), lambda: write("late", GOOD.format(name="late")))
    assert [item.plugin for item in kernel.broken] == ["zebra", "zebra"]  # once for each model
    assert kernel.offers is kernel.offers


# A single file


def test_a_single_file_is_a_plugin(tmp_path: Path) -> None:
    folder = tmp_path / "über uns, mit Leerzeichen"
    folder.mkdir()
    (folder / "helper_of_mine.py").write_text("AREA = 3.0\n", encoding="utf-8")
    file = folder / "my_calculation.py"
    text = "from helper_of_mine import AREA\n" + GOOD.format(name="pin").replace("1.0", "AREA")
    file.write_text(text, encoding="utf-8")
    kernel = Kernel()
    origin = kernel.add_file(file)
    offer = kernel.offer("my_calculation")
    assert (origin.name, offer.model.name, offer.model.inputs().area) == ("my_calculation", "pin", 3.0)
    assert kernel_for(origin.ref).offer("my_calculation").model.name == "pin"


@pytest.mark.parametrize("stem", ["my calc-2", "rev.3", "größe", "2fast", "json"])
def test_files_with_odd_names_hide_nobody(tmp_path: Path, stem: str) -> None:
    file = tmp_path / f"{stem}.py"
    file.write_text(GOOD.format(name="pin"), encoding="utf-8")
    kernel = Kernel()
    origin = kernel.add_file(file)
    assert kernel.offer(origin.name).model.name == "pin"
    assert kernel_for(origin.ref).offer(origin.name).model.name == "pin"
    assert sys.modules["json"] is json


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("absent.py", None, "no such file"),
        ("sheet.xlsx", b"PK\x03\x04", "not a Python file"),
        ("binary.py", b"\x00\x01\xff", "null bytes"),  # a SyntaxError from Python 3.11.4 on
        ("empty.py", b"", "it offers nothing"),
    ],
)
def test_files_that_are_no_plugin(tmp_path: Path, name: str, content: bytes | None, reason: str) -> None:
    file = tmp_path / name
    if content is not None:
        file.write_bytes(content)
    kernel = Kernel()
    kernel.add_file(file)
    assert reason in kernel.broken[0].reason
    assert file.stem not in sys.modules or content == b""
    with pytest.raises(PluginError, match=name):
        kernel.offer(file.stem)


DECLARED = (TESTS / "data" / "pin_wear.py").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        ('given(120.0, "N"', 'given(120.0, "W/m/k"', "'load' is declared in 'W/m/k': unknown unit 'k'; "),
        ('given(120.0, "N"', "given(120.0, 5", "'load' is declared in 5; a unit is a text such as 'mm'"),
        ("above=0", 'above="x"', "'load' has the bound above='x'; it is a number in its unit"),
        ('found("MPa"', 'found("Mlbf"', "'pressure' is declared in 'Mlbf': unknown unit 'Mlbf'; 'lbf' takes no "),
        ('"80 MPa"', '"80 mm"', "Require('pressure'): '80 mm' is a length (mm), expected a pressure or stress (MPa)"),
        ('"50 N"', '"50 Pa"', "Vary('load'): '50 Pa' is a pressure or stress (Pa), expected a force (N)"),
        ('"3 %"', '"3 mm"', "tolerance 'load': '3 mm' is a length (mm), expected a force (N)"),
        ('width="N"', 'width="mm"', "the width of tolerance 'load' is in 'mm', but 'load' is in 'N'"),
        ("given(120.0", 'given(float("inf")', "the default of 'load' is inf, which is no finite number"),
        ('of="depth"', 'of="detph"', "study 'sensitivity': pin_wear has no result 'detph'. Did you mean 'depth'?"),
        ("gives=chance", 'gives=chance, over="laod", at="1 N"', "study 'reliability': pin_wear has no input 'laod'."),
    ],
)
def test_a_quantity_that_is_declared_wrongly_is_told_with_its_line(
    tmp_path: Path, before: str, after: str, sentence: str
) -> None:
    file = tmp_path / "pin.py"
    file.write_text(DECLARED.replace(before, after, 1), encoding="utf-8")
    kernel = Kernel()
    kernel.add_file(file)
    with pytest.raises(PluginError) as caught:
        kernel.offer("pin")
    line = DECLARED.partition(before)[0].count("\n") + 1
    assert f"{file}:{line}: plugin 'pin': DeclarationError: {sentence}" in str(caught.value)
