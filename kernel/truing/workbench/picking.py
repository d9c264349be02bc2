"""The first page: inputs files, calculations, installed or of the folder, data; a file begun from an example.

The page itself says what metadata and names of files say, so that it is there at once; titles, figures and faults
follow by further questions, which workers answer.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.atomic import file_appearing
from truing.entry_points import plugin_names
from truing.errors import OutputError, UsageError
from truing.workbench.bench import Bench, bench_of, body_of, page, word
from truing.workbench.folder import Contents, contents, named_in, place_of_run, program_of
from truing.workbench.keeping import listing
from truing.workbench.places import below

MOST_LOOKED_THROUGH = 200
"""So many inputs files are read for faults at the most."""

LONGEST_HEAD = 64_000
"""Bytes of an inputs file in which the line is looked for that names its calculation."""


async def first_page(request: Request) -> Response:
    """Show what can be opened."""
    bench = bench_of(request)
    seen = await anyio.to_thread.run_sync(contents, bench.root)
    inputs = [
        {"name": each.name, "plugin": each.plugin, "fault": each.fault,
         "program": program_of(each.plugin, each.name, seen.programs) if each.plugin else ""}
        for each in seen.inputs
    ]  # fmt: skip
    return page(
        request, "folder.html.j2", title=bench.root.name, inputs=inputs, programs=seen.programs, data=seen.data,
        plugins=plugin_names(), confirmed={name for name in seen.programs if _is_confirmed(bench, name)},
    )  # fmt: skip


def _is_confirmed(bench: Bench, name: str) -> bool:
    return str(bench.path(name)) in bench.confirmed


def calculation_of(bench: Bench, path: Path) -> str:
    """Return what an inputs file is calculated by: an installed plugin, or a Python file of the folder."""
    try:
        with path.open("rb") as file:
            named = named_in(file.read(LONGEST_HEAD).decode("utf-8-sig", "replace"))
    except OSError:
        return ""
    if not named or named.partition(".")[0] in plugin_names():
        return named
    return program_of(named, below(bench.root, path), contents(bench.root).programs) or named


async def models(request: Request) -> Response:
    """Say what every installed calculation is for, and which plugins are broken."""
    bench = bench_of(request)
    await body_of(request)
    key = ("installed", *plugin_names())
    if key not in bench.kept:
        bench.kept[key] = await bench.ask("models.installed")
    return JSONResponse(bench.kept[key])


async def program(request: Request) -> Response:
    """Say what the calculation of a Python file is for, once the user has confirmed the file."""
    bench, document = bench_of(request), await body_of(request)
    name = word(document, "file")
    return JSONResponse(await bench.ask("models.one", plugin=bench.plugin(name)))


async def picture(request: Request) -> Response:
    """Give the first figure of a calculation at its example; drawn once as long as the server lives."""
    bench, document = bench_of(request), await body_of(request)
    plugin = bench.plugin(word(document, "plugin"))
    stamp = _changed_at(plugin)
    known, drawn = bench.kept.get(("picture", plugin), (None, None))
    if known != stamp:
        drawn = await bench.ask("models.picture", plugin=plugin)
        bench.kept["picture", plugin] = stamp, drawn
    return JSONResponse(drawn)


def _changed_at(plugin: str) -> int:
    """Return when the file of a plugin was changed, in nanoseconds; 0 for one that is installed."""
    return Path(plugin).stat().st_mtime_ns if plugin.endswith(".py") else 0


async def example(request: Request) -> Response:
    """Give the inputs file that ``calc init`` writes."""
    bench, document = bench_of(request), await body_of(request)
    return JSONResponse({"text": await bench.ask("models.example", plugin=bench.plugin(word(document, "plugin")))})


async def faults(request: Request) -> Response:
    """Say of every inputs file what is wrong with it, as far as its calculation may run."""
    bench = bench_of(request)
    await body_of(request)
    seen = await anyio.to_thread.run_sync(contents, bench.root)
    files = [{"name": each.name, "plugin": calculated} for each, calculated in _calculated(bench, seen)]
    said = await bench.ask("models.looked_through", root=str(bench.root), files=files[:MOST_LOOKED_THROUGH])
    return JSONResponse({"faults": said})


async def newest(request: Request) -> Response:
    """Say of every inputs file how its last run ended."""
    bench = bench_of(request)
    await body_of(request)
    seen = await anyio.to_thread.run_sync(contents, bench.root)
    return JSONResponse({"last": _last_runs(seen, (await listing(bench))["entries"])})


def _calculated(bench: Bench, seen: Contents) -> list[tuple[Any, str]]:
    """Return the inputs files that can be read now, each with what a worker loads for it."""
    pairs = []
    for each in seen.inputs:
        program = program_of(each.plugin, each.name, seen.programs)
        if each.fault:
            continue
        if each.plugin and not program and not each.plugin.endswith(".py"):
            pairs.append((each, each.plugin))
        elif program and _is_confirmed(bench, program):
            pairs.append((each, str(bench.path(program))))
    return pairs


def _last_runs(seen: Contents, entries: list[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """Return the newest run of every inputs file that has one; ``entries`` stand the newest first.

    A run is of a file where it is called like it, numbers aside: below ``runs`` as the file is below the folder, else
    anywhere.
    """
    newest: dict[tuple[str, str], Mapping[str, Any]] = {}
    for entry in entries:
        if entry["kind"] == "run":
            parent, stem = place_of_run(entry["name"])
            newest.setdefault((parent, stem), entry)
            newest.setdefault(("", stem), entry)
    ends: dict[str, Mapping[str, Any]] = {}
    for each in seen.inputs:
        path = Path("runs", each.name).with_suffix("")
        last = newest.get((path.parent.as_posix(), path.name)) or newest.get(("", path.name))
        if last is not None:
            ends[each.name] = {name: last[name] for name in ("name", "date", "verdict", "state")}
    return ends


async def begin(request: Request) -> Response:
    """Write a new inputs file from the example of a calculation; a file that is there is never replaced."""
    bench, document = bench_of(request), await body_of(request)
    plugin, name = word(document, "plugin"), word(document, "file").strip()
    if not name:
        raise UsageError("name the new file, such as press.toml")
    path = bench.path(name if name.endswith(".toml") else f"{name}.toml")
    if path.exists():
        raise OutputError(f"{below(bench.root, path)} is there already; choose another name")
    text = await bench.ask("models.example", plugin=bench.plugin(plugin))
    await anyio.to_thread.run_sync(_write_new, path, text)
    return JSONResponse({"file": below(bench.root, path), "plugin": plugin})


def _write_new(path: Path, text: str) -> None:
    with file_appearing(path) as stream:
        stream.write(text.encode())


async def confirm(request: Request) -> Response:
    """Let the program of a file run, as long as this server lives."""
    bench, document = bench_of(request), await body_of(request)
    path = bench.path(word(document, "file"))
    if path.suffix != ".py" or not path.is_file():
        raise OutputError(f"{path.name} is no Python file of the folder")
    bench.confirmed.add(str(path))
    return JSONResponse({"file": below(bench.root, path)})


ROUTES = [
    Route("/", first_page),
    Route("/api/models", models, methods=["POST"]),
    Route("/api/program", program, methods=["POST"]),
    Route("/api/picture", picture, methods=["POST"]),
    Route("/api/example", example, methods=["POST"]),
    Route("/api/faults", faults, methods=["POST"]),
    Route("/api/newest", newest, methods=["POST"]),
    Route("/api/begin", begin, methods=["POST"]),
    Route("/api/confirm", confirm, methods=["POST"]),
]
