"""The first page: calculations, installed or of the folder, inputs files, records; a file begun from an example."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.atomic import write_files
from truing.errors import OutputError
from truing.workbench.bench import bench_of, body_of, page, word
from truing.workbench.places import DATA, INPUTS, below, files_below


async def first_page(request: Request) -> Response:
    """Show what can be opened."""
    bench = bench_of(request)
    models = await bench.ask("models.installed")
    files = await anyio.to_thread.run_sync(_files, bench.root)
    return page(request, "folder.html.j2", title=bench.root.name, models=models, **files)


def _files(root: Path) -> dict[str, Any]:
    """Return the inputs files with the calculation they name, Python files that may be plugins, and data files."""
    inputs = [{"name": below(root, path), "plugin": plugin_of(path)} for path in files_below(root, INPUTS)]
    programs = [below(root, path) for path in files_below(root, (".py",)) if b"truing" in path.read_bytes()[:20_000]]
    data = [below(root, path) for path in files_below(root, DATA) if "runs" not in path.relative_to(root).parts]
    return {"inputs": [each for each in inputs if each["plugin"]], "programs": programs, "data": data}


def plugin_of(path: Path) -> str:
    """Return the calculation that an inputs file names, or nothing."""
    try:
        named = tomllib.loads(path.read_text(encoding="utf-8")).get("plugin", "")
    except (OSError, ValueError, RecursionError):
        return ""
    return named if isinstance(named, str) else ""


async def begin(request: Request) -> Response:
    """Write a new inputs file from the example of a calculation."""
    bench, document = bench_of(request), await body_of(request)
    plugin, name = word(document, "plugin"), word(document, "file")
    path = bench.path(name if name.endswith(".toml") else f"{name}.toml")
    if path.exists():
        raise OutputError(f"{below(bench.root, path)} is there already; choose another name")
    text = await bench.ask("models.example", plugin=bench.plugin(plugin))
    await anyio.to_thread.run_sync(write_files, {path: text})
    return JSONResponse({"file": below(bench.root, path)})


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
    Route("/api/begin", begin, methods=["POST"]),
    Route("/api/confirm", confirm, methods=["POST"]),
]
