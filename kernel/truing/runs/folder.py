"""Run folders: everything a run leaves behind, complete or absent, never half-written."""

from __future__ import annotations

import json
import os
import re
import zipfile
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, Literal

import numpy as np

from truing.atomic import place_folder, recover
from truing.calculation import Calculation
from truing.errors import OutputError, PluginError, UnknownPluginError
from truing.measurements import EXCEL, INERT
from truing.runs.documents import SCHEMA, large_arrays
from truing.runs.inputs_written import complete_inputs
from truing.runs.provenance import Provenance
from truing.runs.spreadsheet import cases_parquet, run_tables, run_workbook
from truing.setup import Setup
from truing.studies.bench import Outcome, files_of

RUN_SCHEMA = "truing.run/1"
FolderKind = Literal["run", "diagnosis"]
DOCUMENTS: dict[FolderKind, tuple[str, str]] = {
    "run": ("results.json", SCHEMA),
    "diagnosis": ("diagnosis.json", "truing.diagnosis/1"),
}
"""The document that makes a folder one of ours, and its schema."""


def json_text(document: Any) -> str:
    """Write a document as JSON: one space of indentation, no NaN, a newline at the end."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write_outcome(
    folder: Path,
    kind: FolderKind,
    setup: Setup,
    document: Mapping[str, Any],
    *,
    provenance: Provenance,
    run_info: Mapping[str, Any],
    files: Mapping[str, str | bytes],
) -> None:
    """Write the folder of a run or a diagnosis: its document, inputs.toml, run.json and further files, all or nothing.

    ``run_info`` holds what run.json says of this one run: date, duration, machine, workers. A folder that is there
    already is replaced whole if it is one of ours of this kind. Raises OutputError where it is not, or where nothing
    can be written.
    """
    origin = setup.origin
    run = {
        "schema": RUN_SCHEMA,
        **run_info,
        "plugin": {"name": origin.name, "version": origin.version, "distribution": origin.distribution},
        "versions": {"truing": provenance.kernel, "python": provenance.python, **provenance.packages},
    }
    own = {
        "inputs.toml": complete_inputs(setup, folder),
        DOCUMENTS[kind][0]: json_text(document),
        "run.json": json_text(run),
    }
    write_folder(folder, {**own, **files}, kind)


def npz_bytes(arrays: Mapping[str, Any]) -> bytes:
    """Pack arrays as numpy's .npz, the same bytes whenever and wherever it is done."""
    stream = BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(arrays):
            content = BytesIO()
            np.lib.format.write_array(content, np.ascontiguousarray(arrays[name]), version=(1, 0), allow_pickle=False)
            entry = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content.getvalue())
    return stream.getvalue()


def is_ours(folder: Path, kind: FolderKind) -> bool:
    """Tell whether a folder is a run, or a diagnosis, of ours: its document of our schema, and run.json."""
    try:
        _loaded(folder, kind)
    except UnknownPluginError:
        return False
    return (folder / "run.json").is_file()


def demand_place(folder: Path, kind: FolderKind = "run") -> None:
    """Raise OutputError, with one sentence, unless a run (a diagnosis) can be put at ``folder``; nothing is written.

    To be asked before a long calculation begins. What a death has left beside the folder is cleared up.
    """
    try:
        recover(folder)
        _demand_place(folder, kind)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be used for the {kind}: {error.strerror or error}") from None


def _demand_place(folder: Path, kind: FolderKind) -> None:
    if folder.is_dir():
        if not is_ours(folder, kind):
            other: FolderKind = "diagnosis" if kind == "run" else "run"
            what = f"an existing folder but no {kind} of ours" if any(folder.iterdir()) else "an existing empty folder"
            what = f"an existing {other} of ours but no {kind}" if is_ours(folder, other) else what
            raise OutputError(f"{folder}: is {what}, so it is left alone; name another folder or remove this one")
    elif folder.is_symlink() and not folder.exists():
        raise OutputError(f"{folder}: is a link that leads nowhere; name another place or remove this one")
    elif folder.exists():
        raise OutputError(f"{folder}: is a file; a {kind} is a folder, name another place")
    for parent in folder.absolute().parents:
        if parent.is_dir():
            if not os.access(parent, os.W_OK):
                raise OutputError(f"{folder}: the folder {parent} may not be written to; name another place")
            return
        if parent.exists():
            raise OutputError(f"{folder}: {parent} is a file, so there can be no folder below it; name another place")


def write_folder(folder: Path, files: Mapping[str, str | bytes], kind: FolderKind = "run") -> None:
    """Write files into a folder that appears complete or not at all; an earlier one of its kind is replaced whole."""
    demand_place(folder, kind)
    place_folder(folder, files, kind)


def load_either(folder: Path) -> dict[str, Any]:
    """Return results.json of a run folder or diagnosis.json of a diagnosis; raises UnknownPluginError for others."""
    name = DOCUMENTS["diagnosis"][0]
    return _loaded(folder, "diagnosis" if folder.name == name or (folder / name).is_file() else "run")


def _loaded(folder: Path, kind: FolderKind) -> dict[str, Any]:
    name, schema = DOCUMENTS[kind]
    path = folder if folder.name == name else folder / name
    if not path.is_file():
        raise UnknownPluginError(f"{folder}: no {kind} folder, it holds no {name}")
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UnknownPluginError(f"{path}: cannot be read: {error}") from None
    if not isinstance(document, dict) or document.get("schema") != schema:
        verb = "run" if kind == "run" else "diagnose"
        raise UnknownPluginError(f"{path}: is no {schema} document; name a folder that calc {verb} has written")
    return document


# What stands beside the document of a run: arrays, tables for a spreadsheet, files that studies leave


def run_files(
    calculation: Calculation,
    document: Mapping[str, Any],
    sheets: Mapping[str, str | bytes],
    *,
    excel: bool = False,
    xlsx: bool = False,
) -> dict[str, str | bytes]:
    """Return the files of a run by name: sheets, tables, large arrays, those of its studies.

    Tables are CSV, with ``excel`` for a spreadsheet with a decimal comma; ``xlsx`` adds them as a workbook.
    """
    model = calculation.setup.model
    files = {**sheets, **run_tables(document, model, EXCEL if excel else INERT)}
    if xlsx:
        files["results.xlsx"] = run_workbook(document, model)
    if str(document.get("rows", {}).get("file", "")).lower().endswith(".parquet"):
        files["cases.parquet"] = cases_parquet(document)
    if large := large_arrays(calculation):
        files["arrays.npz"] = npz_bytes(large)
    return files | study_files(calculation.outcomes, files)


NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}", re.ASCII)


def study_files(outcomes: Mapping[str, Outcome], taken: Mapping[str, str | bytes]) -> dict[str, str | bytes]:
    """Return what the outcomes' ``files`` hold, by file name; an outcome without any leaves none.

    Raises PluginError for a name that is no plain file name, that a run folder or another study uses, and for content
    that is neither text nor bytes.
    """
    files: dict[str, str | bytes] = {}
    for study, outcome in outcomes.items():
        for name, content in files_of(outcome).items():
            if not NAME.fullmatch(name) or name.endswith("."):
                raise PluginError(f"study '{study}' names its file {name!r}; a plain file name is wanted")
            if name.casefold() in {other.casefold() for other in (*taken, *KEPT, *files)}:
                raise PluginError(f"study '{study}' names its file '{name}', which the run folder has already")
            if not isinstance(content, (str, bytes)):
                raise PluginError(
                    f"study '{study}' gives '{name}' as {type(content).__name__}; text or bytes is wanted"
                )
            files[name] = content
    return files


KEPT = (
    "inputs.toml", "results.json", "run.json", "sheet.html", "sheet.md", "sheet.pdf", "sheet.docx", "arrays.npz",
    "results.csv", "cases.csv", "cases.parquet", "results.xlsx",
)  # fmt: skip
"""Names that a run folder uses itself, or may use."""
