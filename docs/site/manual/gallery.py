"""The gallery: every shipped example is calculated while the site is built, through the command line like any other."""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import tomllib
from collections.abc import Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from manual.models import environment, offers
from manual.places import DOCS, ROOT
from truing.cli import main
from truing.kernel.loading import code_hash

KEPT = ROOT / "build" / "gallery"
"""Where calculated sheets stay until the code, the templates or the example change; with TRUING_GALLERY=kept longer."""
MOST_KEPT = 3
"""So many older versions of a sheet stay beside it."""
SHOWN = ("sheet.html", "inputs.toml", "extended.toml", "results.json", "diagnosis.json")


@dataclass(frozen=True)
class Sheet:
    """One sheet of the gallery: what is calculated, with which budgets of a quick build."""

    name: str
    plugin: str
    inputs: Path
    data: tuple[Path, ...]
    quick: tuple[str, ...]

    @property
    def is_full(self) -> bool:
        """Whether it is calculated with the budgets of the example itself."""
        return not self.quick or os.environ.get("TRUING_GALLERY") == "full"

    def words(self) -> list[str]:
        """Return the command line, without the folder."""
        verb = ["diagnose" if self.data else "run", self.plugin, "--inputs", str(self.inputs)]
        verb += [word for file in self.data for word in ("--data", str(file))]
        return verb + [word for one in self._budgets() for word in ("--set", f"studies.{one}")]

    def key(self) -> str:
        """Return what changes when the sheet would: code, templates, example, data, budgets."""
        codes = [code_hash("truing"), *(code_hash(name) for name in (self.plugin, "gear_geometry"))]
        files = [*sorted((ROOT / "templates").rglob("*.*")), *sorted(self.inputs.parent.glob("*.*")), *self.data]
        digest = hashlib.sha256(" ".join([*codes, *self._budgets()]).encode())
        for file in files:
            digest.update(file.read_bytes() if file.is_file() else b"")
        return digest.hexdigest()[:16]

    def _budgets(self) -> tuple[str, ...]:
        return () if self.is_full else self.quick


def sheets() -> list[Sheet]:
    """Return the sheets of docs/gallery/sheets.toml."""
    listed = tomllib.loads((DOCS / "gallery" / "sheets.toml").read_text(encoding="utf-8"))
    return [_sheet(name, item) for name, item in listed.items()]


def _sheet(name: str, item: dict[str, Any]) -> Sheet:
    own = offers()[item["plugin"]].model.example
    inputs = ROOT / item["inputs"] if "inputs" in item else own
    if inputs is None:
        raise ValueError(f"docs/gallery/sheets.toml: {item['plugin']} has no example of its own; name its inputs")
    data = tuple(ROOT / file for file in item.get("data", ()))
    return Sheet(name, item["plugin"], inputs, data, tuple(item.get("quick", ())))


@lru_cache(maxsize=1)
def folders() -> dict[str, Path]:
    """Calculate what is not there yet and return the run folder of every sheet."""
    return {sheet.name: calculated(sheet) for sheet in sheets()}


def calculated(sheet: Sheet) -> Path:
    """Return the run folder of a sheet; raises RuntimeError with all that was said where it cannot be calculated."""
    target = KEPT / f"{sheet.name}-{sheet.key()}"
    if target.is_dir():
        return target
    older = sorted(KEPT.glob(f"{sheet.name}-*"), key=lambda folder: folder.stat().st_mtime)
    if older and os.environ.get("TRUING_GALLERY") == "kept":
        return older[-1]
    KEPT.mkdir(parents=True, exist_ok=True)
    said = io.StringIO()
    with chdir(KEPT), redirect_stdout(said), redirect_stderr(said):
        code = main([*sheet.words(), "--output", str(target), "-q"])
    for folder in older[:-MOST_KEPT]:
        shutil.rmtree(folder, ignore_errors=True)
    if code not in (0, 1):
        raise RuntimeError(f"the sheet '{sheet.name}' of the gallery ended with exit code {code}:\n{said.getvalue()}")
    return target


def files() -> Iterator[tuple[str, Path]]:
    """Give what a reader may open or take along, by its place in the site."""
    for name, folder in folders().items():
        for file in SHOWN:
            if (folder / file).is_file():
                yield f"gallery/{name}/{file}", folder / file


def cards() -> str:
    """Return the cards of the first page of the gallery."""
    shown = [_card(sheet, folders()[sheet.name]) for sheet in sheets()]
    return environment().get_template("gallery.md.j2").render(cards=shown)


def _card(sheet: Sheet, folder: Path) -> dict[str, Any]:
    took = json.loads((folder / "run.json").read_text(encoding="utf-8"))["duration_s"]
    model = offers()[sheet.plugin].model
    files = [name for name in SHOWN[1:] if (folder / name).is_file()]
    return {
        "name": sheet.name, "plugin": sheet.plugin, "title": model.title, "summary": model.summary, "took": took,
        "files": files, "budgets": [] if sheet.is_full else sheet.quick, "lines": _lines(folder),
        "is_diagnosis": bool(sheet.data),
    }  # fmt: skip


def _lines(folder: Path) -> list[str]:
    """Return what a sheet says in short: its checks, or its verdict."""
    if (folder / "diagnosis.json").is_file():
        found = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
        causes = ", ".join(cause["effect"] for cause in found["causes"])
        return [f"{found['rows']} measured rows", f"verdict: {found['verdict']}" + (f" ({causes})" if causes else "")]
    checks = json.loads((folder / "results.json").read_text(encoding="utf-8"))["checks"]
    failed = [check["name"] for check in checks if not check["passed"]]
    held = f"{len(checks) - len(failed)} of {len(checks)} checks hold as stated" if checks else "no limits are stated"
    return [held + (f"; not: {', '.join(failed)}" if failed else "")]
