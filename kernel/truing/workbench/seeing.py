"""What the text that is being edited says of the machine: results, the sheet, figures; runs with studies behind it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.templating import template_folder
from truing.workbench.bench import Bench, bench_of, body_of, word
from truing.workbench.editing import about
from truing.workbench.places import below
from truing.workbench.workers import OvertakenError, TaskError

RUNS = "runs"
HOST = re.compile(r"^(\s*)(?::root|html|body)(?= \{)", re.MULTILINE)
"""What a style sheet says of the page, which in a shadow root is said of its host."""


async def numbers(request: Request) -> Response:
    """Give the live sheet of a text, beside a saved run where one is named."""
    bench, document = bench_of(request), await body_of(request)
    name = word(document, "run", "")
    run = str(bench.path(name)) if name else ""
    last = str(_folder(bench, bench.path(word(document, "file"))))
    return await _answer("results.numbers", bench, document, run=run, called=name, last=last)


async def whole(request: Request) -> Response:
    """Give the whole sheet of a text, as a page for a frame that can do nothing."""
    return await _asked("results.whole", request)


async def sliders(request: Request) -> Response:
    """Give the inputs of a text that can be dragged, and those that matter most."""
    bench, document = bench_of(request), await body_of(request)
    return await _answer("results.sliders", bench, document, ranked=document.get("ranked") is not False)


async def figure(request: Request) -> Response:
    """Draw the figure of page one for a text."""
    return await _asked("figures.first", request)


async def sweep(request: Request) -> Response:
    """Draw results along an input of a text."""
    return await _asked("figures.sweep", request, "over", "low", "high")


async def _asked(task: str, request: Request, *names: str) -> Response:
    """Do a task with the text of a request, and with further words of it."""
    document = await body_of(request)
    return await _answer(task, bench_of(request), document, **{name: word(document, name) for name in names})


async def _answer(task: str, bench: Bench, document: Mapping[str, Any], **more: Any) -> Response:
    """Do a task with the text of a request; what is wrong with a text that is being typed is an answer like any other.

    A page that names itself waits for its newest question of a kind only. Raises UsageError for what is wrong with the
    request itself, OvertakenError where the page has asked again.
    """
    text, asking = word(document, "text"), word(document, "page", "")
    group = f"{task} {asking}" if asking else ""
    try:
        return JSONResponse(await bench.ask(task, group=group, **about(bench, document), text=text, **more))
    except OvertakenError:
        raise
    except TaskError as error:
        return JSONResponse({"faults": error.faults})


async def run(request: Request) -> Response:
    """Run the calculation of a saved file with its studies, in the background."""
    bench, document = bench_of(request), await body_of(request)
    path = bench.path(word(document, "file"))
    name = below(bench.root, path)
    job = bench.start(
        "runs.run", f"run of {name}", name,
        plugin=bench.plugin(word(document, "plugin")), file=str(path), output=str(_folder(bench, path)),
        root=str(bench.root),
    )  # fmt: skip
    return JSONResponse(job.as_json())


def _folder(bench: Bench, path: Path) -> Path:
    """Return where the run of a file lies: below ``runs``, in the folders of the file, under its name."""
    return bench.root / RUNS / path.relative_to(bench.root).with_suffix("")


async def last(request: Request) -> Response:
    """Give the last run of a file beside its text, and all runs that it can be compared with."""
    bench, document = bench_of(request), await body_of(request)
    run = _folder(bench, bench.path(word(document, "file")))
    return await _answer("runs.last", bench, document, run=str(run), root=str(bench.root))


async def chapter(request: Request) -> Response:
    """Give one chapter of the sheet of a run, as a page for a frame that can do nothing."""
    bench, document = bench_of(request), await body_of(request)
    run = bench.path(word(document, "run"))
    return JSONResponse({"html": await bench.ask("runs.chapter", run=str(run), ident=word(document, "ident"))})


async def style(request: Request) -> Response:
    """Give the style of sheets for a part of a page, from which the rest of the page is kept apart."""
    return Response(_style(), media_type="text/css")


@lru_cache(maxsize=1)
def _style() -> str:
    return HOST.sub(r"\1:host", (template_folder() / "sheet.css").read_text(encoding="utf-8"))


ROUTES = [
    Route("/sheet.css", style),
    Route("/api/numbers", numbers, methods=["POST"]),
    Route("/api/whole", whole, methods=["POST"]),
    Route("/api/sliders", sliders, methods=["POST"]),
    Route("/api/figure", figure, methods=["POST"]),
    Route("/api/sweep", sweep, methods=["POST"]),
    Route("/api/run", run, methods=["POST"]),
    Route("/api/last", last, methods=["POST"]),
    Route("/api/chapter", chapter, methods=["POST"]),
]
