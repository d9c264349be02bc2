"""What the text that is being edited says of the machine: results, the sheet, figures; runs with studies behind it."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from truing.workbench.bench import bench_of, body_of, word
from truing.workbench.editing import about
from truing.workbench.places import below


async def figure(request: Request) -> Response:
    """Draw the figure of page one for a text."""
    bench, document = bench_of(request), await body_of(request)
    return JSONResponse(
        {"svg": await bench.ask("figures.first", **about(bench, document), text=word(document, "text"))}
    )


async def run(request: Request) -> Response:
    """Run the calculation of a saved file with its studies, in the background."""
    bench, document = bench_of(request), await body_of(request)
    path = bench.path(word(document, "file"))
    name, output = below(bench.root, path), bench.root / "runs" / path.stem
    job = bench.start(
        "runs.run", f"run of {name}", name,
        plugin=bench.plugin(word(document, "plugin")), file=str(path), output=str(output), root=str(bench.root),
    )  # fmt: skip
    return JSONResponse(job.as_json())


ROUTES = [
    Route("/api/figure", figure, methods=["POST"]),
    Route("/api/run", run, methods=["POST"]),
]
