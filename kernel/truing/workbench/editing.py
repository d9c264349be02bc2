"""The page of an inputs file: a form beside the text, answers while typing, saving without loss.

The page holds the text that is being edited; a change is a pure function of it. Only saving touches the file, and only
where it is still as the page last saw it.
"""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.atomic import alone, write_files
from truing.errors import OutputError, UsageError
from truing.workbench.bench import Bench, bench_of, body_of, digest_of, page, word
from truing.workbench.picking import calculation_of
from truing.workbench.places import DATA, below, files_below

LARGEST_TEXT = 2_000_000
"""Bytes of an inputs file, as much as is read of one."""
MOST_DATA_FILES = 500
"""So many data files of the folder are offered."""
BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_SAVING = threading.Lock()


async def edit_page(request: Request) -> Response:
    """Show the form of an inputs file, its text, and what it says of the machine."""
    bench = bench_of(request)
    path = bench.path(request.query_params.get("file", ""))
    name = below(bench.root, path)
    opened = await bench.ask("form.opened", path=str(path), called=name)
    plugin = request.query_params.get("plugin", "") or await anyio.to_thread.run_sync(calculation_of, bench, path)
    if not plugin:
        raise UsageError(f'{name} names no calculation; write plugin = "NAME" in its first line')
    form = await bench.ask("form.described", plugin=bench.plugin(plugin))
    data = await anyio.to_thread.run_sync(_data_files, path.parent)
    words = {"file": name, "plugin": plugin, "text": opened["text"], "digest": opened["digest"], "data": data}
    return page(request, "edit.html.j2", title=name, form=form, **words)


def _data_files(folder: Path) -> list[str]:
    """Return the data files at and below the folder of an inputs file, as it names them."""
    names = [below(folder, path) for _, path in zip(range(MOST_DATA_FILES), files_below(folder, DATA), strict=False)]
    return [name for name in names if not name.startswith("runs/")]


async def state(request: Request) -> Response:
    """Answer a text, and a change of it where one is asked: what it states, field by field, and what is wrong."""
    bench, document = bench_of(request), await body_of(request)
    asked: dict[str, Any] = {"text": word(document, "text"), "saved": word(document, "saved", word(document, "text"))}
    change = document.get("change")
    if change is not None and not isinstance(change, dict):
        raise UsageError("the change is no table")
    return JSONResponse(await bench.ask("form.state", **about(bench, document), **asked, change=change))


def about(bench: Bench, document: Any) -> dict[str, Any]:
    """Return what a task needs to read a text as the inputs file of a request."""
    path = bench.path(word(document, "file"))
    return {"plugin": bench.plugin(word(document, "plugin")), "file": path.name, "folder": str(path.parent)}


async def read(request: Request) -> Response:
    """Give the text of a file as it is now, and where it differs from the one that is being edited."""
    bench, document = bench_of(request), await body_of(request)
    path = bench.path(word(document, "file"))
    if not path.exists():
        return JSONResponse({"gone": True, "digest": digest_of(b"")})
    opened = await bench.ask("form.opened", path=str(path), called=below(bench.root, path))
    differences = await bench.ask("form.differences", mine=word(document, "text"), theirs=opened["text"])
    return JSONResponse({**opened, "differences": differences})


async def save(request: Request) -> Response:
    """Write the text, where the file is still as the page saw it; else say that it is another now."""
    bench, document = bench_of(request), await body_of(request)
    path, text, base = bench.path(word(document, "file")), word(document, "text"), word(document, "base")
    name = below(bench.root, path)
    return JSONResponse(await anyio.to_thread.run_sync(_saved, path, name, text, base))


def _saved(path: Path, name: str, text: str, base: str) -> dict[str, Any]:
    """Compare and write while no other server of the workbench writes to the folder."""
    try:
        with _SAVING, alone(path.parent):
            there = path.read_bytes() if path.exists() else b""
            content = _as_there(text, there)
            if len(content) > LARGEST_TEXT:
                raise OutputError(f"{name} would be larger than {LARGEST_TEXT / 1e6:g} MB; nothing was written")
            if digest_of(there) not in {base, digest_of(content)}:
                return {"conflict": True, "digest": digest_of(there)}
            if path.exists() and not path.stat().st_mode & 0o222:
                raise OutputError(f"{name} is read-only; nothing was written")
            if content != there:
                write_files({path: content})
    except UnicodeEncodeError:
        raise OutputError("the text holds half a character, which no file can; nothing was written") from None
    except OSError as error:
        raise OutputError(f"{name} cannot be written: {error.strerror or error}; nothing was written") from None
    return {"digest": digest_of(content)}


def _as_there(text: str, there: bytes) -> bytes:
    """Return the text as bytes, with the line ends and the byte order mark that the file has."""
    content = text.encode()
    if b"\r\n" in there and there.count(b"\r\n") == there.count(b"\n"):
        content = content.replace(b"\n", b"\r\n")
    return BYTE_ORDER_MARK + content if there.startswith(BYTE_ORDER_MARK) else content


ROUTES = [
    Route("/edit", edit_page),
    Route("/api/state", state, methods=["POST"]),
    Route("/api/read", read, methods=["POST"]),
    Route("/api/save", save, methods=["POST"]),
]
