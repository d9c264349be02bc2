"""A calculation of one's own, made on a page: what ``calc new`` writes, from formulas, a workbook, or to be filled in.

What is typed goes to a worker as text and is never run there: formulas are read by the grammar of formulas. A file that
was made here is confirmed, since the user made it.
"""

from __future__ import annotations

import re
from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.errors import UsageError
from truing.workbench.bench import Bench, bench_of, body_of, page, word
from truing.workbench.folder import contents
from truing.workbench.places import below

PLACE = re.compile(r"[^/\\#\x00-\x1f]{1,200}")
"""A sheet, a range, or both, as behind the # of ``calc new --from``."""
PATIENCE = 60.0
"""Seconds that writing and the first calculation may take."""


async def new_page(request: Request) -> Response:
    """Show the form of a new calculation."""
    bench = bench_of(request)
    seen = await anyio.to_thread.run_sync(contents, bench.root)
    books = [name for name in seen.data if name.lower().endswith((".xlsx", ".xlsm"))]
    return page(request, "new.html.j2", title="New calculation", books=books)


def _form(document: Any) -> dict[str, Any]:
    form = document.get("form")
    if not isinstance(form, dict):
        raise UsageError("the request needs the object 'form'")
    return form


async def check(request: Request) -> Response:
    """Say what is wrong with a form, by field, and what its results are at the defaults."""
    bench, form = bench_of(request), _form(await body_of(request))
    return JSONResponse(await bench.ask("drafts.checked", form=form, root=str(bench.root)))


async def make(request: Request) -> Response:
    """Write the calculation of a form, of a workbook, or the one to be filled in."""
    bench, document = bench_of(request), await body_of(request)
    about: dict[str, Any] = {"form": _form(document), "root": str(bench.root), "patience": PATIENCE}
    kind = word(document, "kind")
    if kind == "formulas":
        answer = await bench.ask("drafts.made", **about)
    elif kind in {"single", "project"}:
        answer = await bench.ask("drafts.placeholder", **about, kind=kind)
    elif kind == "workbook":
        answer = await bench.ask("drafts.from_workbook", **about, book=_book(bench, document), write=True)
    else:
        raise UsageError(f"'{kind[:20]}' is no way to make a calculation")
    if "file" in answer:
        bench.confirmed.add(str(bench.path(answer["file"])))
    return JSONResponse(answer)


async def draft(request: Request) -> Response:
    """Say what becomes of the cells of a workbook; nothing is written."""
    bench, document = bench_of(request), await body_of(request)
    about: dict[str, Any] = {"form": _form(document), "root": str(bench.root)}
    return JSONResponse(await bench.ask("drafts.from_workbook", **about, book=_book(bench, document), write=False))


def _book(bench: Bench, document: Any) -> str:
    """Return a workbook of the folder with the place in it. Raises UsageError for another file, or no place."""
    path, place = bench.path(word(document, "book")), word(document, "place", "").strip()
    if path.suffix.lower() not in {".xlsx", ".xlsm"} or not path.is_file():
        raise UsageError(f"{path.name} is no workbook of this folder")
    if place and not PLACE.fullmatch(place):
        raise UsageError(f"'{place[:40]}' is no sheet and no range; write Sheet1!A4:E20")
    return below(bench.root, path) + (f"#{place}" if place else "")


ROUTES = [
    Route("/new", new_page),
    Route("/api/new/check", check, methods=["POST"]),
    Route("/api/new/make", make, methods=["POST"]),
    Route("/api/new/draft", draft, methods=["POST"]),
]
