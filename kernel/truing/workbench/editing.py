"""The page of an inputs file: a form beside the text, answers while typing, results, saving without loss.

The page holds the text that is being edited; a change is a pure function of it. Only saving touches the file, and only
where it is still as the page last saw it.
"""

from __future__ import annotations

from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.atomic import write_files
from truing.errors import UsageError
from truing.workbench.bench import Bench, bench_of, body_of, digest_of, names, page, word
from truing.workbench.picking import calculation_of
from truing.workbench.places import below
from truing.workbench.written import changed_text


async def edit_page(request: Request) -> Response:
    """Show the form of an inputs file, its text, and its results."""
    bench = bench_of(request)
    path = bench.path(request.query_params.get("file", ""))
    content = await anyio.to_thread.run_sync(path.read_bytes) if path.is_file() else None
    if content is None:
        raise UsageError(f"there is no file {request.query_params.get('file', '')[:80]}")
    plugin = request.query_params.get("plugin", "") or await anyio.to_thread.run_sync(calculation_of, bench, path)
    text = content.decode("utf-8", "replace")
    form = await bench.ask("form.described", plugin=bench.plugin(plugin))
    name = below(bench.root, path)
    return page(
        request, "edit.html.j2", title=name, file=name, plugin=plugin, text=text, digest=digest_of(content), form=form
    )


async def state(request: Request) -> Response:
    """Answer a text, and a change of it where one is asked: fields, faults, results."""
    bench, document = bench_of(request), await body_of(request)
    text = word(document, "text")
    change = document.get("change")
    if isinstance(change, dict):
        text = changed_text(text, names(change, "path"), change.get("value"))
    answered = await bench.ask("form.state", **about(bench, document), text=text)
    return JSONResponse({**answered, "text": text})


def about(bench: Bench, document: Any) -> dict[str, Any]:
    """Return what a task needs to read a text as the inputs file of a request."""
    path = bench.path(word(document, "file"))
    return {"plugin": bench.plugin(word(document, "plugin")), "file": path.name, "folder": str(path.parent)}


async def save(request: Request) -> Response:
    """Write the text, where the file is still as the page saw it; else give what is there now."""
    bench, document = bench_of(request), await body_of(request)
    path, text, base = bench.path(word(document, "file")), word(document, "text"), word(document, "base")

    def written() -> dict[str, Any]:
        there = path.read_bytes() if path.is_file() else b""
        if digest_of(there) != base:
            return {"conflict": there.decode("utf-8", "replace"), "digest": digest_of(there)}
        write_files({path: text})
        return {"digest": digest_of(text.encode())}

    answer = await anyio.to_thread.run_sync(written)
    return JSONResponse(answer, 409 if "conflict" in answer else 200)


ROUTES = [
    Route("/edit", edit_page),
    Route("/api/state", state, methods=["POST"]),
    Route("/api/save", save, methods=["POST"]),
]
