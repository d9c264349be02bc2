"""Runs and diagnoses of the folder: the list, the page of one, its files to keep, two of them compared."""

from __future__ import annotations

import base64
import mimetypes
import re
import zipfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.util import find_spec
from io import BytesIO
from itertools import count
from pathlib import Path
from typing import Any
from urllib.parse import quote

import anyio
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from truing.atomic import place_folder
from truing.errors import OutputError, UsageError
from truing.report.pdf import find_browser, pdf_bytes
from truing.workbench.bench import Bench, bench_of, body_of, page, word
from truing.workbench.folder import DOCUMENTS, contents, place_of_run, program_of
from truing.workbench.guard import SHEET_POLICY
from truing.workbench.places import below

LARGEST_ZIP = 300_000_000
"""Bytes of a run folder that is packed; a larger one is copied, not downloaded."""
MOST_PAIRS = 2000
"""So many pairs of runs are compared for the list at the most."""
PRINTING = 60.0
"""Seconds that the page of two runs may take: their figures are large."""
FILES = {
    "sheet.html": "Sheet, HTML", "sheet.pdf": "Sheet, PDF", "sheet.docx": "Sheet, Word", "sheet.md": "Sheet, Markdown",
    "inputs.toml": "Inputs, complete, TOML", "extended.toml": "Extended inputs, TOML",
    "results.json": "Results, JSON", "diagnosis.json": "Diagnosis, JSON", "results.csv": "Results, CSV",
    "cases.csv": "Cases, CSV", "results.xlsx": "Results, workbook", "diagnosis.xlsx": "Diagnosis, workbook",
    "arrays.npz": "Arrays, NumPy", "run.json": "Date, versions, machine, JSON",
}  # fmt: skip
"""What the files of a run are called on its page, in this order; others follow by their names."""
HEAD = re.compile(r"\A\s*<!DOCTYPE html>\s*<html[^<>]*>\s*<head>", re.IGNORECASE)
STILL = (
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
    "img-src data:; font-src data:; base-uri 'none'; form-action 'none'\">"
)
"""A page that begins so loads nothing and runs nothing, whatever stands below."""


async def runs_page(request: Request) -> Response:
    """List the runs and diagnoses of the folder."""
    bench = bench_of(request)
    made = await listing(bench)
    return page(request, "runs.html.j2", title="Runs and diagnoses", **made, pairs=pairs_of(made["entries"]))


async def listing(bench: Bench) -> dict[str, Any]:
    """Return every run and diagnosis, the newest first, and the folders that cannot be read."""
    seen = await anyio.to_thread.run_sync(contents, bench.root)
    made: dict[str, Any] = await bench.ask("kept.listed", root=str(bench.root), folders=seen.runs)
    return made


def pairs_of(entries: Sequence[Mapping[str, Any]]) -> list[tuple[str, str]]:
    """Return each entry's name after that of the one before it: of the same file, kind and calculation.

    ``entries`` stand the newest first. Runs are of one file where their folders lie side by side and have one name,
    numbers aside.
    """
    newest: dict[tuple[str, ...], str] = {}
    pairs = []
    for entry in entries:
        key = (entry["kind"], entry["model"], *place_of_run(entry["name"]))
        if key in newest:
            pairs.append((entry["name"], newest[key]))
        newest[key] = entry["name"]
    return pairs[:MOST_PAIRS]


async def changed(request: Request) -> Response:
    """Say of every run what changed against the one before of the same file."""
    bench = bench_of(request)
    await body_of(request)
    pairs = pairs_of((await listing(bench))["entries"])
    said = await bench.ask("kept.changed", root=str(bench.root), pairs=pairs)
    return JSONResponse({"changed": said, "before": {after: before for before, after in pairs}})


async def run_page(request: Request) -> Response:
    """Show one run or diagnosis: its verdict, its sheet, its files."""
    bench = bench_of(request)
    path = run_folder(bench, request.query_params.get("folder", ""))
    name = below(bench.root, path)
    made = await listing(bench)
    entry = next((each for each in made["entries"] if each["name"] == name), None)
    if entry is None:
        fault = next((each["sentence"] for each in made["others"] if each["name"] == name), "cannot be read")
        raise UsageError(f"{name}: {fault}")
    pairs = {after: before for before, after in pairs_of(made["entries"])}
    others = [each for each in made["entries"] if each["kind"] == entry["kind"] and each["name"] != name]
    others.sort(key=lambda each: bool(each["model"] != entry["model"]))  # of the same calculation first, else by date
    return page(
        request, "run.html.j2", title=name, entry=entry, others=others, before=pairs.get(name, ""),
        files=await anyio.to_thread.run_sync(files_of, path), can=_can_make(path, entry),
    )  # fmt: skip


def run_folder(bench: Bench, name: str) -> Path:
    """Return the folder of a run or a diagnosis. Raises UsageError for any other."""
    path = bench.path(name)
    if path == bench.root or not any((path / document).is_file() for document in DOCUMENTS):
        raise UsageError(f"{name[:80]} is no run and no diagnosis of this folder")
    return path


def files_of(path: Path) -> list[dict[str, Any]]:
    """Return the files of a run that can be kept: name, what they are called, bytes. Links are left out."""
    order = {name: place for place, name in enumerate(FILES)}
    files = [each for each in path.iterdir() if each.is_file() and not each.is_symlink() and each.name[0] != "."]
    return [
        {"name": each.name, "title": FILES.get(each.name, each.name), "size": each.stat().st_size}
        for each in sorted(files, key=lambda each: (order.get(each.name, len(order)), each.name))
    ]


def _can_make(path: Path, entry: Mapping[str, Any]) -> dict[str, bool]:
    """Tell what can be made of a run on demand and is not there; a run with cases needs the file of these."""
    is_plain = entry["kind"] == "run" and not entry["cases"]
    return {
        "pdf": not (path / "sheet.pdf").is_file() and (path / "sheet.html").is_file() and find_browser() is not None,
        "word": is_plain and not (path / "sheet.docx").is_file() and find_spec("docx") is not None,
        "xlsx": entry["kind"] == "run" and not (path / "results.xlsx").is_file() and find_spec("openpyxl") is not None,
    }


async def made(request: Request) -> Response:
    """Give what is made of a run when it is asked for: its PDF, its workbook, the whole folder as one file."""
    bench, kind = bench_of(request), request.path_params["kind"]
    path = run_folder(bench, request.query_params.get("folder", ""))
    if kind == "pdf":
        sheet = bench.path(f"{below(bench.root, path)}/sheet.html")
        async with _printer(bench):
            content = await anyio.to_thread.run_sync(_printed, sheet)
        return _to_keep(content, f"{path.name}.pdf", "application/pdf")
    if kind == "xlsx":
        content = base64.b64decode(await bench.ask("kept.workbook", folder=str(path)))
        return _to_keep(content, f"{path.name}.xlsx", "application/octet-stream")
    if kind == "zip":
        return _to_keep(await anyio.to_thread.run_sync(_packed, path), f"{path.name}.zip", "application/zip")
    raise UsageError(f"nothing of the kind '{kind[:20]}' is made of a run; choose pdf, xlsx or zip")


def _printer(bench: Bench) -> anyio.CapacityLimiter:
    """One browser prints at a time."""
    limiter: anyio.CapacityLimiter = bench.kept.setdefault("printer", anyio.CapacityLimiter(1))
    return limiter


def _printed(sheet: Path) -> bytes:
    """Print a sheet, which may come from anywhere: the browser loads nothing that it names, and runs nothing."""
    try:
        text = sheet.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        raise UsageError("there is no sheet to print") from None
    if not HEAD.match(text):
        raise UsageError("the sheet does not begin as one of ours, so it is not printed")
    return pdf_bytes(HEAD.sub(lambda head: head[0] + STILL, text, count=1))


def _packed(path: Path) -> bytes:
    """Pack the folder of a run, its name in front. Raises OutputError where it is too large."""
    stream = BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, file in _files_below(path).items():
            archive.write(file, f"{path.name}/{name}")
    return stream.getvalue()


def _files_below(path: Path) -> dict[str, Path]:
    """Return the files of a run by their names in it, without links and hidden ones. Raises OutputError: too large."""
    files = {
        each.relative_to(path).as_posix(): each
        for each in sorted(path.rglob("*"))
        if each.is_file() and not each.is_symlink() and each.resolve().is_relative_to(path.resolve())
        and not any(part.startswith(".") for part in each.relative_to(path).parts)
    }  # fmt: skip
    if sum(each.stat().st_size for each in files.values()) > LARGEST_ZIP:
        raise OutputError(f"{path.name} is too large to be packed or copied here; copy the folder")
    return files


def _to_keep(content: bytes, name: str, kind: str) -> Response:
    headers = {"content-disposition": f"attachment; filename*=UTF-8''{quote(name, safe='')}"}
    return Response(content, media_type=kind, headers={**headers, "content-security-policy": SHEET_POLICY})


async def word_document(request: Request) -> Response:
    """Begin to make the Word document of a run, in the background: the run is calculated again."""
    bench, document = bench_of(request), await body_of(request)
    path = run_folder(bench, word(document, "folder"))
    name = below(bench.root, path)
    entry = next((each for each in (await listing(bench))["entries"] if each["name"] == name), None)
    if entry is None or entry["kind"] != "run":
        raise UsageError(f"{name} is no run that can be calculated again")
    seen = await anyio.to_thread.run_sync(contents, bench.root)
    plugin = bench.plugin(program_of(entry["model"], name, seen.programs) or entry["model"])
    job = bench.start("kept.word", f"Word document of {name}", name, folder=str(path), plugin=plugin)
    return JSONResponse(job.as_json())


async def keep(request: Request) -> Response:
    """Copy a run beside itself under the next number, so that the next run of its file does not replace it."""
    bench, document = bench_of(request), await body_of(request)
    path = run_folder(bench, word(document, "folder"))
    return JSONResponse({"folder": below(bench.root, await anyio.to_thread.run_sync(_copied, path))})


def _copied(path: Path) -> Path:
    """Copy a run, without links and hidden files, and return where the copy is: complete, or not there."""
    files = {name: each.read_bytes() for name, each in _files_below(path).items()}
    _, stem = place_of_run(path.as_posix())
    for number in count(1):
        target = path.with_name(f"{stem}-{number}")
        try:
            target.mkdir()
        except FileExistsError:
            continue
        except OSError as error:
            raise OutputError(f"{target.name} cannot be written: {error.strerror or error}") from None
        try:
            place_folder(target, files, "copy")
        except BaseException:
            with suppress(OSError):
                target.rmdir()
            raise
        return target
    raise AssertionError("numbers do not end")


async def compare_page(request: Request) -> Response:
    """Show two runs, or two diagnoses, side by side in the frame of the workbench."""
    bench = bench_of(request)
    before, after = (below(bench.root, path) for path in _two(bench, request))
    return page(request, "compare.html.j2", title=f"{before} and {after}", before=before, after=after)


async def compared(request: Request) -> Response:
    """Give the page of ``calc compare`` of two runs or diagnoses: it is shown and can do nothing."""
    bench = bench_of(request)
    before, after = _two(bench, request)
    text = await bench.ask("kept.compared_page", before=str(before), after=str(after), patience=PRINTING)
    headers = {"content-security-policy": SHEET_POLICY}
    if "download" in request.query_params:
        return _to_keep(text.encode(), f"{before.name}-{after.name}.html", "text/html")
    return HTMLResponse(text, headers=headers)


def _two(bench: Bench, request: Request) -> tuple[Path, Path]:
    before, after = (run_folder(bench, request.query_params.get(which, "")) for which in ("before", "after"))
    return before, after


async def file(request: Request) -> Response:
    """Give a file of the folder: a sheet as a page that can do nothing, anything else to keep."""
    path = bench_of(request).path(request.path_params["name"])
    if not path.is_file():
        raise UsageError(f"there is no file {request.path_params['name'][:80]}")
    kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    is_shown = path.suffix == ".html" and "download" not in request.query_params
    return FileResponse(
        path, media_type=kind, filename=None if is_shown else path.name,
        headers={"content-security-policy": SHEET_POLICY},
    )  # fmt: skip


ROUTES = [
    Route("/runs", runs_page),
    Route("/run", run_page),
    Route("/compare", compare_page),
    Route("/compared", compared),
    Route("/api/made/{kind}", made),
    Route("/api/changed", changed, methods=["POST"]),
    Route("/api/word", word_document, methods=["POST"]),
    Route("/api/keep", keep, methods=["POST"]),
    Route("/file/{name:path}", file),
]
