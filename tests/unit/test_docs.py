"""The manual is complete: every hook, verb, option, word, error and study option has its place; links arrive."""

from __future__ import annotations

import dataclasses
import inspect
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import typer.main

import truing
from truing import (
    Allocation,
    Emulated,
    Frequency,
    FrequencyAnswer,
    Kernel,
    Optimise,
    Record,
    Reliability,
    Sensitivity,
    Surrogate,
    Sweep,
    Table,
    Uncertainty,
    errors,
    hookspecs,
)
from truing.cli.app import app
from truing.declare.builtin import builtin_effects
from truing.declare.sources import HISTORIES, SINCE_START
from truing.declare.spreads import Target, off, read_spread
from truing.errors import TruingError, UnitError
from truing.evaluate import evaluate
from truing.kernel.loading import load_file
from truing.setup import SwitchedOn, default_setup
from truing.studies.allocation import Allotted
from truing.studies.checks import plain_checks
from truing.studies.optimise import Optimum
from truing.studies.reliability import Curve, Odds
from truing.studies.sensitivity import Sensitivities
from truing.studies.sweep import Swept
from truing.studies.uncertainty import Budgets
from truing.testing import CHECKS
from truing.units import read_quantity, same_dimension, to_si

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
REFERENCE = DOCS / "reference"
PAGES = sorted([*DOCS.rglob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"])
HOOKS = sorted(
    name for name, item in vars(hookspecs).items() if name.startswith("truing_") and inspect.isfunction(item)
)
STUDIES: dict[type[Any], type[Any]] = {
    Sweep: Swept, Sensitivity: Sensitivities, Reliability: Odds, Allocation: Allotted, Surrogate: Emulated,
    Optimise: Optimum, Frequency: FrequencyAnswer, Uncertainty: Budgets,
}  # fmt: skip


def page(*names: str) -> str:
    """The text of a page of the reference."""
    return REFERENCE.joinpath(*names).read_text(encoding="utf-8")


def verbs() -> dict[str, list[str]]:
    """Every verb of the command line with the names of its options and arguments, as typer declares them."""
    group: Any = typer.main.get_command(app)
    return {
        name: [spelling for parameter in command.params for spelling in spellings(parameter)]
        for name, command in group.commands.items()
    }


def spellings(parameter: Any) -> list[str]:
    """How an option is written; an argument by its name in capitals."""
    if parameter.param_type_name == "argument":
        return ["RUN" if parameter.name in {"first", "second"} else parameter.name.upper()]
    return [spelling for spelling in parameter.opts if spelling not in {"--help", "-h"}]


def test_every_hook_has_a_page_and_a_test() -> None:
    assert len(HOOKS) == 4
    assert {file.stem for file in (REFERENCE / "hooks").glob("*.md")} == set(HOOKS)
    written = "\n".join(file.read_text(encoding="utf-8") for file in (ROOT / "tests").rglob("test_*.py"))
    for hook in HOOKS:
        assert page("hooks", f"{hook}.md").startswith(f"## {hook}(")
        assert re.search(rf"def test_\w*{hook}", written), f"no test is named after {hook}"


@pytest.fixture
def spring() -> ModuleType:
    """The finished file of the tutorial."""
    return load_file(DOCS / "examples" / "coil_spring.py")


def guest(hook: str) -> ModuleType:
    """The example of a hook's page as a plugin."""
    (code,) = re.findall(r"```python\n(.*?)```", page("hooks", f"{hook}.md"), re.DOTALL)
    made = ModuleType(f"guest_of_{hook}")
    exec(compile(code, made.__name__, "exec"), made.__dict__)
    return made


def test_truing_models_offers_a_calculation(spring: ModuleType) -> None:
    assert Kernel([spring], strict=True).offer("coil_spring").model is spring.COIL_SPRING


def test_truing_error_sources_adds_what_its_page_shows(spring: ModuleType) -> None:
    offer = Kernel([spring, guest("truing_error_sources")], strict=True).offer("coil_spring")
    assert list(offer.model.effects) == ["softening", "sag"]
    assert [(added.what, added.plugin) for added in offer.added] == [("sag", "guest_of_truing_error_sources")]
    setup = default_setup(offer.model)
    effect = SwitchedOn(offer.model.effects["sag"], {"sag_of_coils": 0.2})
    base, sagged = evaluate(setup), evaluate(dataclasses.replace(setup, effects=(effect,)))
    assert sagged.rate == pytest.approx(base.rate / 0.8, rel=1e-12)


def test_truing_objectives_adds_what_its_page_shows(spring: ModuleType) -> None:
    offer = Kernel([spring, guest("truing_objectives")], strict=True).offer("coil_spring")
    checks = {check.name: check for check in plain_checks(default_setup(offer.model), {"rate": 4e3, "stress": 0.0})}
    assert checks["rate"].limit == 5
    assert checks["rate"].margin == pytest.approx(0.2)


def test_truing_reports_adds_what_its_page_shows(spring: ModuleType) -> None:
    offer = Kernel([spring, guest("truing_reports")], strict=True).offer("coil_spring")
    section = offer.model.sheet[-1]
    assert section.title == "Wire"
    assert section.blocks is not None
    setup = default_setup(offer.model)
    (wire,) = section.blocks(Record(setup.inputs, evaluate(setup), {}, {}, offer.model.function, setup.inputs))
    volume_mm3 = math.pi / 4 * 1.0**2 * math.pi * 8.0 * 8.0
    assert isinstance(wire, Table)
    assert wire.rows[0][1] == pytest.approx(volume_mm3 * 7.85e-3, rel=1e-3)


def test_every_verb_has_a_page_that_names_all_its_options() -> None:
    assert {file.stem for file in (REFERENCE / "verbs").glob("*.md")} == set(verbs())
    for verb, options in verbs().items():
        text = page("verbs", f"{verb}.md")
        assert text.startswith(f"# calc {verb}\n")
        assert "Exit codes:" in text
        missing = [option for option in options if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", text)]
        assert not missing, verb


def test_what_holds_for_every_verb_is_said_once() -> None:
    text = (DOCS / "index.md").read_text(encoding="utf-8")
    for option in ("--version", "-v", "-q", "--traceback", "--help"):
        assert f"`{option}`" in text or f"calc {option}" in text


def pages_of(name: str) -> str:
    """The pages that explain a word: those for who uses models, or those for who writes them."""
    is_for_users = getattr(truing, name).__module__.startswith("truing.api")
    return page("python.md") if is_for_users else page("declaring.md") + page("studies.md")


def test_every_public_word_is_explained_with_its_arguments() -> None:
    spoken = {"half": "plus_minus(", "chooser": "by_choice(", "low": "zone(", "high": "zone("}
    for name in truing.__all__:
        text, word = pages_of(name), getattr(truing, name)
        assert re.search(rf"(?<!\w){name}(?!\w)", text), name
        named = inspect.isfunction(word) and name not in {"inputs", "results", "states"}
        for argument in set(inspect.signature(word).parameters) - {"spreads", "of"} if named else ():
            said = {**spoken, "name": f"{name}("}.get(argument, "\0") in text
            assert said or re.search(rf"(?<!\w){argument}(?!\w)", text), f"{name}({argument})"


def test_every_error_stands_in_the_tree_with_its_exit_code() -> None:
    text = page("errors.md")
    classes = [name for name, item in vars(errors).items() if inspect.isclass(item) and issubclass(item, TruingError)]
    assert [name for name in [*classes, "Fault"] if not re.search(rf"(?<!\w){name}(?!\w)", text)] == []
    for name, code in re.findall(r"^[│├└─ ]*(\w+Error) +exit (\d)", text, re.MULTILINE):
        assert getattr(errors, name).exit_code == int(code)


def sections(text: str) -> dict[str, str]:
    """The chapters of a page by their titles."""
    parts = re.split(r"^## (.+)$", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.__name__)
def test_every_option_of_a_study_and_every_attribute_of_its_outcome_is_named(study: type[Any]) -> None:
    text = sections(page("studies.md"))[study.__name__]
    rows = dict(re.findall(r"^\| (`[^|]+`) \| ([^|]*) \|", text, re.MULTILINE))
    named = {name: default for names, default in rows.items() for name in re.findall(r"`(\w+)`", names)}
    fields = {item.name: item for item in dataclasses.fields(study)}
    assert set(named) == set(fields)
    for name, item in fields.items():
        if isinstance(item.default, int) and not isinstance(item.default, bool):
            assert named[name].replace(" ", "") == str(item.default)
    methods = {"as_json", "blocks", "checks", "warnings", "of"}
    for outcome in [STUDIES[study], *([Curve] if study is Reliability else [])]:
        names = {item.name for item in dataclasses.fields(outcome)}
        names |= {name for name, item in vars(outcome).items() if isinstance(item, property)}
        assert not [name for name in names - methods if f"`{name}" not in text]


def test_the_json_of_the_studies_is_json() -> None:
    shown = re.findall(r"```json\n(.*?)```", page("studies.md"), re.DOTALL)
    assert len(shown) == len(STUDIES)
    for text in shown:
        json.loads(text)


def shape(document: Any) -> Any:
    """A document without its numbers and texts: the keys of every level, a list by its first item."""
    if isinstance(document, dict):
        return {key: shape(item) for key, item in document.items()}
    return [shape(document[0])] if isinstance(document, list) and document else None


@pytest.mark.parametrize(
    ("title", "study"),
    [
        ("Sweep", Sweep(over="compression", at="0, 5, 10 mm", results="force")),
        ("Uncertainty", Uncertainty(of="force")),
    ],
)
def test_the_json_of_a_study_of_the_spring_is_as_shown(title: str, study: Any) -> None:
    (text,) = re.findall(r"```json\n(.*?)```", sections(page("studies.md"))[title], re.DOTALL)
    found = truing.load(DOCS / "examples" / "coil_spring.py").study(study, progress=False)
    assert shape(found.outcome.as_json()) == shape(json.loads(text))


def test_every_check_built_in_effect_condition_and_history_has_its_row() -> None:
    text = page("conformance.md")
    for check in CHECKS:
        row = f"| {check.name} | {check.promise} |"
        assert row in text, f"docs/reference/conformance.md needs the row {row}"
    text = page("builtin_effects.md")
    model = load_file(DOCS / "examples" / "coil_spring.py").COIL_SPRING
    assert re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE) == list(builtin_effects(model))
    for name in [*(set(model.known_conditions) - set(model.conditions)), "temperature"]:
        assert f"condition `{name}` [" in text or f"\n  condition `{name}` [" in text
    for word in [SINCE_START, *(f"{word} of X" for word in HISTORIES)]:
        assert f'\n| `"{word}"` |' in page("declaring.md")


def table(text: str, title: str) -> list[list[str]]:
    """The rows of the first table of a chapter, header left out."""
    rows = re.findall(r"^\|(.+)\|$", sections(text)[title], re.MULTILINE)
    return [[cell.strip() for cell in row.split("|")] for row in rows[2:]]


SPELLED_ALIKE = [
    [unit for unit in re.findall(r"`([^`]+)`", row[0]) if unit != "W/m·K"]
    for row in table(page("units.md"), "How a quantity is written")
    if "; " not in row[0]
]


def test_units_said_to_be_the_same_are_the_same() -> None:
    assert SPELLED_ALIKE
    for first, *others in SPELLED_ALIKE:
        for unit in others:
            assert same_dimension(unit, first)
            assert to_si(1.0, unit) == pytest.approx(to_si(1.0, first), rel=1e-14)


def test_what_the_page_of_units_refuses_is_refused() -> None:
    rows = table(page("units.md"), "What is refused")
    refused = [text for row in rows for text in re.findall(r'`"([^"]+)"`', row[0])]
    assert refused
    for text in refused:
        with pytest.raises(UnitError):
            read_quantity(text, "degC" if text == "5 C" else "m")
    (sentence,) = re.findall(r"```text\n(.*?)\n```", sections(page("units.md"))["Counts and angles"], re.DOTALL)
    with pytest.raises(UnitError, match=re.escape(sentence)):
        read_quantity("3000 rpm", "rad/s")


def test_levels_and_differences_are_written_as_the_page_says() -> None:
    rows = table(page("units.md"), "Temperatures: levels and differences")
    for unit in ("degC", "K"):
        (row,) = [row for row in rows if f"`{unit}`" in row[0]]
        for text in re.findall(r'`"([^"]+)"`', row[1]):
            read_quantity(text, unit)


SPREADS = [
    (python, file)
    for row in table(page("declaring.md"), "Tolerances")
    for python, file in [(row[0].strip("`"), row[1].strip("`"))]
    if file.startswith('"') and python != "word"
]


def test_a_spread_reads_the_same_in_python_and_in_a_file() -> None:
    assert SPREADS
    target = Target("length", 0.25, "m", lambda name: 0.25)
    for python, file in SPREADS:
        declared = eval(python, {name: getattr(truing, name) for name in truing.__all__})
        assert read_spread(file.strip('"'), off()).resolve(target) == declared.resolve(target)


def links(text: str) -> Iterator[str]:
    """The targets of the links and pictures of a page, code left out."""
    prose = re.sub(r"```.*?```|`[^`\n]*`", "", text, flags=re.DOTALL)
    yield from re.findall(r"\]\(([^)\s]+)\)", prose)


def anchors(text: str) -> set[str]:
    """The anchors that GitHub and mkdocs make of a page's headings."""
    prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    titles = re.findall(r"^#+ (.+)$", prose, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in titles}


@pytest.mark.parametrize("file", PAGES, ids=lambda file: str(file.relative_to(ROOT)))
def test_a_page_names_no_machine_fetches_no_picture_and_its_links_lead_somewhere(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert not re.findall(r"(?:/home/|/work/|/root/|/tmp/|/Users/|[A-Z]:\\\\)\S*", text)
    assert not re.findall(r"!\[[^\]]*\]\(https?:", text)
    assert "<img" not in text
    for link in links(text):
        if link.startswith(("https://", "http://")):
            continue
        target, _, anchor = link.partition("#")
        place = (file.parent / target).resolve() if target else file
        assert place.exists(), f"{link}: no such file"
        assert ROOT in place.parents, f"{link}: leads out of the project"
        if anchor:
            assert anchor in anchors(place.read_text(encoding="utf-8")), f"{link}: no such heading"
