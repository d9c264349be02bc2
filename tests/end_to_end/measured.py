"""Measured files as columns of text that tests change, and diagnoses through the command line."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Any

import truing
from hidden_effects.asking import write_case
from hidden_effects.making import Wish, make_case
from hidden_effects.press_machine import POSITION
from shared import Answer
from truing.cli import main

Columns = dict[str, list[str]]
Document = dict[str, Any]
ANGLE, FORCE, WARMTH, TIME = "crank_angle [deg]", "forming_force [kN]", "link_temperature [degC]", "time [h]"
STROKES, SPEED, HEIGHT = "strokes [1]", "speed [rpm]", "slider_position [mm]"
HEATED = Wish("single", "wide", "gaussian", (POSITION,), 90, ("link_heating",), 2.5)
HEATED_SEED = 4
CONTRACT = {"diagnosis.json", "run.json", "inputs.toml", "sheet.html", "sheet.md", "results.csv", "rows.csv"}
CONTRACT |= {"arrays.npz"}


@dataclass(frozen=True)
class Diagnosed:
    """A finished diagnosis: what was answered, diagnosis.json, and the folder."""

    answer: Answer
    document: Document
    folder: Path


def columns_of(text: str) -> Columns:
    """Take a file apart: cells by header, in order."""
    head, *rows = csv.reader(io.StringIO(text))
    return {name: [row[place] for row in rows] for place, name in enumerate(head)}


def text_of(columns: Mapping[str, Sequence[str]]) -> str:
    """Write columns as comma-separated text."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    return stream.getvalue()


def numbers(columns: Mapping[str, Iterable[float]]) -> Columns:
    """Write numbers as cells, every digit kept."""
    return {name: [repr(float(value)) for value in values] for name, values in columns.items()}


def renamed(columns: Columns, old: str, new: str) -> Columns:
    """Return the columns with another header over one of them."""
    return {new if name == old else name: cells for name, cells in columns.items()}


def taken(columns: Columns, rows: Sequence[int]) -> Columns:
    """Return some rows in this order."""
    return {name: [cells[row] for row in rows] for name, cells in columns.items()}


def with_cells(columns: Columns, name: str, cells: Mapping[int, str]) -> Columns:
    """Return the columns with some cells of one replaced; rows count from 0."""
    return {**columns, name: [cells.get(row, cell) for row, cell in enumerate(columns[name])]}


def diagnose_heated(folder: Path) -> None:
    """Diagnose a press of 90 rows whose links are hotter than the model knows; keep what was answered."""
    write_case(make_case(HEATED_SEED, HEATED), folder)
    answer = calc_here(folder, "diagnose", "press_linkage", "--inputs", "inputs.toml", "--data", "measured.csv")
    (folder / "answer.json").write_text(json.dumps(astuple(answer)), encoding="utf-8")


def calc_here(folder: Path, *arguments: str | Path) -> Answer:
    """Run ``calc`` in this process and in this folder, wherever a fixture lives long."""
    said, beside = io.StringIO(), io.StringIO()
    with chdir(folder), redirect_stdout(said), redirect_stderr(beside):
        code = main([str(argument) for argument in arguments])
    return Answer(code, said.getvalue(), beside.getvalue())


def read_document(folder: Path) -> Document:
    """Return diagnosis.json; a NaN in it is a fault."""
    text = (folder / "diagnosis.json").read_text(encoding="utf-8")
    document = json.loads(text, parse_constant=_refuse)
    assert isinstance(document, dict)
    return document


def documented(desk: Path, plugin: str, *data: str, inputs: str | Path = "inputs.toml", **options: Any) -> Document:
    """Diagnose measured files in a folder by a call, which draws no sheet; test_api.py compares it with the command."""
    with chdir(desk):
        model = truing.load(plugin)
        found = model.diagnose(truing.read(data, model), inputs, progress=False, **options)
    document: Document = json.loads(json.dumps(found.document, allow_nan=False))
    return document


def _refuse(word: str) -> float:
    raise AssertionError(f"{word} in diagnosis.json")


def diagnose_here(
    folder: Path, name: str, text: str | bytes, *more: str, plugin: str | Path = "press_linkage"
) -> Diagnosed:
    """Write one measured file, diagnose it with the inputs that lie beside it, and read what is left."""
    (folder / f"{name}.csv").write_bytes(text if isinstance(text, bytes) else text.encode())
    command = ["diagnose", plugin, "--inputs", "inputs.toml", "--data", f"{name}.csv", "-o", f"of {name}", *more]
    answer = calc_here(folder, *command)
    assert answer.code == 0, answer.err
    return Diagnosed(answer, read_document(folder / f"of {name}"), folder / f"of {name}")


def names(document: Document) -> list[str]:
    """Return the named causes."""
    return [cause["effect"] for cause in document["causes"]]
