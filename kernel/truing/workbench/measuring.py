"""Measured files: taken in, previewed, diagnosed; a cause accepted, an experiment planned.

Uploads are raw bodies, which stream to the folder ``data``; none is larger than a table may be, and none takes the
place of another one before the user has said so. What the columns are stands under [columns] of the inputs file.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.atomic import write_files
from truing.errors import OutputError, UsageError
from truing.workbench.bench import Bench, bench_of, body_of, digest_of, names, page, received, word
from truing.workbench.editing import about
from truing.workbench.folder import contents
from truing.workbench.picking import calculation_of
from truing.workbench.places import DATA, below

LONGEST_NAME = 120
PREVIEW_PATIENCE = 60.0
"""Seconds that the preview of files may take: a table of the largest size is read in it."""
TAKEN_IN = "data"
"""The folder to which measured files are uploaded."""


async def measure_page(request: Request) -> Response:
    """Show the measured files that are chosen, for an inputs file; without one the inputs files of the folder."""
    bench = bench_of(request)
    inputs, data = await anyio.to_thread.run_sync(_listed, bench.root)
    asked = request.query_params.get("file", "") or (inputs[0]["name"] if len(inputs) == 1 else "")
    if not asked:
        return page(request, "measure_choose.html.j2", title="Measure", inputs=inputs)
    path = bench.path(asked)
    if not path.is_file():
        raise UsageError(f"there is no file {asked[:80]}")
    content = await anyio.to_thread.run_sync(path.read_bytes)
    name, text = below(bench.root, path), content.decode("utf-8", "replace")
    chosen = [below(bench.root, bench.path(each)) for each in request.query_params.getlist("data")]
    plugin = request.query_params.get("plugin", "") or await anyio.to_thread.run_sync(calculation_of, bench, path)
    return page(
        request, "measure.html.j2", title="Measure", file=name, plugin=plugin, text=text, digest=digest_of(content),
        inputs=inputs, data=data, chosen=chosen,
    )  # fmt: skip


def _listed(root: Path) -> tuple[list[dict[str, str]], list[str]]:
    seen = contents(root)
    return [{"name": each.name, "plugin": each.plugin} for each in seen.inputs if each.plugin], list(seen.data)


# Taking files in


async def upload(request: Request) -> Response:
    """Take a file in. One of the same content is there already; one of another content only goes on request."""
    bench, replace = bench_of(request), request.query_params.get("replace") == "yes"
    name = harmless(request.query_params.get("name", ""))
    target = bench.path(f"{TAKEN_IN}/{name}")
    is_there = await received(request, target, replace=replace)
    shown = {"file": below(bench.root, target)}
    return JSONResponse(shown) if is_there else JSONResponse({**shown, "exists": name}, 409)


def harmless(name: str) -> str:
    """Return the name of a file without folders and without what a shell or a system takes for more than a letter.

    Raises UsageError for a file of no kind that is read.
    """
    last = unicodedata.normalize("NFC", re.split(r"[\\/]", name)[-1])
    plain = re.sub(r"[^\w.+() \-]", "_", last).strip(" .")
    stem, dot, ending = plain.rpartition(".")
    if not stem.strip(" .") or f".{ending.lower()}" not in DATA:
        raise UsageError(f"'{last[:80]}' is no measured file that is read; read are {', '.join(DATA)}")
    if re.fullmatch(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?", stem):
        stem = f"_{stem}"
    return f"{stem.strip(' .')[:LONGEST_NAME]}{dot}{ending.lower()}"


# Columns


async def columns(request: Request) -> Response:
    """Answer what files hold by a text of [columns], with changes of it where some are asked."""
    bench, document = bench_of(request), await body_of(request)
    answered = await bench.ask(
        "records.columns", patience=PREVIEW_PATIENCE, **about(bench, document), text=word(document, "text"),
        changes=list(_changes(document)), data=_data(bench, document), root=str(bench.root),
    )  # fmt: skip
    return JSONResponse(answered)


def _changes(document: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    """Give what columns are to be, each by what its file calls it; without a name its entry goes."""
    asked = document.get("changes") or []
    if not isinstance(asked, list) or not all(isinstance(change, dict) for change in asked):
        raise UsageError("a change of a column has the texts 'key', 'name' and 'unit'")
    for change in asked:
        name = "" if change.get("name") is None else word(change, "name")
        yield {"key": word(change, "key"), "name": name, "unit": word(change, "unit", "")}


def _data(bench: Bench, document: Any) -> list[str]:
    """Return the measured files that a request names, as seen from the folder that is served."""
    return [below(bench.root, bench.path(name)) for name in names(document, "data")]


async def figure(request: Request) -> Response:
    """Draw a column of a file over another one, or over its rows."""
    bench, document = bench_of(request), await body_of(request)
    shown, over = document.get("shown"), document.get("over")
    if not isinstance(shown, int) or not isinstance(over, int) or shown < 0:
        raise UsageError("the request needs the places of two columns")
    answered = await bench.ask(
        "records.figure", patience=PREVIEW_PATIENCE, **about(bench, document), text=word(document, "text"),
        root=str(bench.root), data=below(bench.root, bench.path(word(document, "of"))), shown=shown, over=over,
    )  # fmt: skip
    return JSONResponse(answered)


# Diagnoses


async def candidates(request: Request) -> Response:
    """Answer what may compete to explain a record."""
    bench, document = bench_of(request), await body_of(request)
    return JSONResponse(
        await bench.ask("diagnoses.candidates", **about(bench, document), text=word(document, "text"))
    )  # fmt: skip


async def diagnose(request: Request) -> Response:
    """Begin a diagnosis of measured files by a saved inputs file; ``causes`` names what competes where not all does."""
    bench, document = bench_of(request), await body_of(request)
    path, data = bench.path(word(document, "file")), _data(bench, document)
    causes = names(document, "causes") if document.get("causes") else []
    stem = Path(data[0]).stem
    only = "_only_" + re.sub(r"\W+", "_", causes[0]) if len(causes) == 1 else "_some_causes" if causes else ""
    job = bench.start(
        "diagnoses.diagnose", f"diagnosis of {', '.join(data)}", below(bench.root, path),
        plugin=bench.plugin(word(document, "plugin")), file=below(bench.root, path), root=str(bench.root), data=data,
        output=f"runs/{stem}{only}", causes=causes,
    )  # fmt: skip
    return JSONResponse(job.as_json())


async def diagnosis_page(request: Request) -> Response:
    """Show the diagnosis that a folder holds, beside that without restriction where it is one of some causes."""
    bench, asked = bench_of(request), request.query_params
    folder = below(bench.root, bench.path(asked.get("folder", "")))
    shown = await bench.ask("diagnoses.shown", root=str(bench.root), folder=folder)
    whole = re.sub(r"_only_.*|_some_causes", "", folder)
    beside = None
    if whole != folder and (bench.root / whole / "diagnosis.json").is_file():
        beside = {"folder": whole, **await bench.ask("diagnoses.shown", root=str(bench.root), folder=whole)}
    file = below(bench.root, bench.path(asked["file"])) if asked.get("file") else ""
    data = [below(bench.root, bench.path(each)) for each in asked.getlist("data")]
    plugin = asked.get("plugin", "") or shown["plugin"]
    return page(
        request, "measure_diagnosis.html.j2", title="Diagnosis", shown=shown, at=folder, beside=beside, file=file,
        plugin=plugin, data=data, target=_target(bench, file or f"{shown['plugin']}.toml", shown),
    )  # fmt: skip


def _target(bench: Bench, file: str, shown: Any) -> str:
    """Propose a name for the extended inputs file that is not taken."""
    stem = file.removesuffix(".toml")
    ending = "_and_".join(cause["name"].replace("input:", "") for cause in shown["causes"][:2]) or "as_measured"
    free = (f"{stem}_{ending}{count}.toml" for count in ("", *(f"_{number}" for number in range(2, 1000))))
    return next(name for name in free if not bench.path(name).exists())


async def accept(request: Request) -> Response:
    """Write the extended inputs file of a diagnosis under a name that the user has seen; never over another file."""
    bench, document = bench_of(request), await body_of(request)
    target = bench.path(word(document, "target"))
    if target.suffix != ".toml":
        raise UsageError(f"{target.name[:80]} is no name of an inputs file; let it end in .toml")
    if target.exists():
        raise OutputError(f"{below(bench.root, target)} is there already; choose another name")
    file = word(document, "file", "")
    text = await bench.ask(
        "diagnoses.accepted", plugin=bench.plugin(word(document, "plugin")), root=str(bench.root),
        folder=below(bench.root, bench.path(word(document, "folder"))), target=below(bench.root, target),
        file=below(bench.root, bench.path(file)) if file else "",
    )  # fmt: skip
    await anyio.to_thread.run_sync(write_files, {target: text})
    return JSONResponse({"file": below(bench.root, target)})


async def plan(request: Request) -> Response:
    """Begin to plan the experiment that tells causes apart."""
    bench, document = bench_of(request), await body_of(request)
    path, noise, budget = bench.path(word(document, "file")), document.get("noise") or {}, document.get("budget", 12)
    if not isinstance(noise, dict) or not all(isinstance(each, str) for each in noise.values()):
        raise UsageError("the request needs a text of noise for every result")
    if not isinstance(budget, int) or isinstance(budget, bool):
        raise UsageError("how many readings there may be is a whole number")
    job = bench.start(
        "diagnoses.plan", f"plan of an experiment, {below(bench.root, path)}", below(bench.root, path),
        plugin=bench.plugin(word(document, "plugin")), file=below(bench.root, path), root=str(bench.root),
        causes=names(document, "causes"), noise=noise, budget=budget,
    )  # fmt: skip
    return JSONResponse(job.as_json())


ROUTES = [
    Route("/measure", measure_page),
    Route("/measure/diagnosis", diagnosis_page),
    Route("/api/upload", upload, methods=["POST"]),
    Route("/api/columns", columns, methods=["POST"]),
    Route("/api/column-figure", figure, methods=["POST"]),
    Route("/api/candidates", candidates, methods=["POST"]),
    Route("/api/diagnose", diagnose, methods=["POST"]),
    Route("/api/accept", accept, methods=["POST"]),
    Route("/api/plan", plan, methods=["POST"]),
]
