"""Every document that Truing writes is what its JSON Schema says, field by field, and its page shows the same."""

from __future__ import annotations

import json
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from shared import ROOT, TESTS, Calc

sys.path += [str(ROOT / "docs" / "site"), str(TESTS / "unit")]

import jsonschema
import typer.main
from diagnosis_samples import SAMPLES

from manual.formats import FORMATS, with_table
from truing.cli.app import app
from truing.describe import description
from truing.inputs_file import json_schema
from truing.kernel import Kernel
from truing.runs.diagnosis_document import diagnosis_document

NAMES = sorted(file.name.removesuffix(".schema.json") for file in FORMATS.glob("*.schema.json"))
SPRING = ROOT / "docs" / "examples" / "coil_spring.py"
PRINTED = {"run": "results", "diagnose": "diagnosis", "index": "listing", "explain": "", "sweep": "results"}
"""Verbs whose --json has another name than the verb, or a form for each kind of thing, which its own page shows."""


@cache
def schema_of(name: str) -> Any:
    schema = json.loads((FORMATS / f"{name}.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def demand(name: str, document: Any) -> None:
    """Fail, saying where, unless a document is described to its last field."""
    faults = list(schema_of(name).iter_errors(document))
    assert not faults, "\n".join(f"{'.'.join(map(str, one.absolute_path))}: {one.message}" for one in faults[:5])


@pytest.mark.parametrize("name", NAMES)
def test_the_page_shows_the_fields_of_the_schema(name: str) -> None:
    page = FORMATS / f"{name}.md"
    words = "docs/reference/files: run python docs/site/manual/formats.py"
    assert with_table(page) == page.read_text(encoding="utf-8"), words
    assert f"({name}.schema.json)" in page.read_text(encoding="utf-8")


def test_every_format_is_in_the_list_of_files() -> None:
    listed = (FORMATS / "README.md").read_text(encoding="utf-8")
    assert not [name for name in NAMES if f"({name}.md)" not in listed]
    assert {page.stem for page in FORMATS.glob("*.md")} == {*NAMES, "README"}


def test_every_section_of_an_inputs_file_is_explained() -> None:
    kernel = Kernel()
    kernel.add_file(SPRING)
    text = (FORMATS.parent / "inputs_file.md").read_text(encoding="utf-8")
    sections = json_schema(kernel.offer("coil_spring"))["properties"]
    assert set(re.findall(r"^## (\w+)$", text, re.MULTILINE)) == set(sections)


def objects(schema: Any) -> Any:
    """Every part of a schema that lists fields."""
    if isinstance(schema, dict):
        if "properties" in schema and isinstance(schema["properties"], dict):
            yield schema
        for part in schema.values():
            yield from objects(part)
    elif isinstance(schema, list):
        for part in schema:
            yield from objects(part)


OPEN = {"studies": "each study says its own", "objectives": "fields by kind"}


@pytest.mark.parametrize("name", NAMES)
def test_a_schema_lets_no_field_pass_that_it_does_not_name(name: str) -> None:
    loose = [list(part["properties"]) for part in objects(schema_of(name).schema) if "additionalProperties" not in part]
    assert not loose


def test_every_verb_that_prints_json_has_a_format() -> None:
    group: Any = typer.main.get_command(app)
    printing = {name for name, item in group.commands.items() if any("--json" in one.opts for one in item.params)}
    assert {PRINTED.get(name, name) for name in printing} - {""} | {"run"} == set(NAMES)


def test_a_run_writes_what_is_described(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("case,compression [mm]\nidle,5\nfull,10\n", encoding="utf-8")
    softer = ("--set", "effects.softening.loss=0.0005 1/K", "--set", "conditions.spring_temperature=80 degC")
    for place, more in {"plain": (), "soft": softer, "cases": ("--cases", "cases.csv")}.items():
        assert calc("run", SPRING, "-q", "--output", place, *more).code in (0, 1)
        for name in ("results", "run"):
            demand(name, json.loads((tmp_path / place / f"{name}.json").read_text(encoding="utf-8")))
    (tmp_path / "foreign").mkdir()
    demand("listing", json.loads(calc("index", ".", "--json").out))
    answer = calc("compare", "plain", "soft", "--json")
    assert answer.code == 1
    demand("compare", json.loads(answer.out))


def test_a_document_with_a_field_that_is_not_described_is_found() -> None:
    with pytest.raises(AssertionError, match="'novelty' was unexpected"):
        demand("compare", {"equal": True, "changes": [], "novelty": 1})
    with pytest.raises(AssertionError, match="'changes' is a required property"):
        demand("compare", {"equal": True})


@pytest.mark.parametrize("sample", SAMPLES)
def test_a_diagnosis_is_described(sample: str) -> None:
    demand("diagnosis", json.loads(json.dumps(diagnosis_document(SAMPLES[sample]()))))


def test_every_model_is_described_in_the_described_form() -> None:
    kernel = Kernel.installed()
    kernel.add_file(SPRING)
    for offer in kernel.offers.values():
        demand("describe", json.loads(json.dumps(description(offer))))


def test_what_is_installed_and_what_is_printed_are_described(calc: Calc) -> None:
    demand("plugins", json.loads(calc("plugins", "--json").out))
    demand("verify", json.loads(calc("verify", SPRING, "--json").out))
