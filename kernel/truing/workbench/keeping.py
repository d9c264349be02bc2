"""Runs and diagnoses of the folder: the list, their sheets and files, two of them compared."""

from __future__ import annotations

import mimetypes

from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from truing.errors import UsageError
from truing.workbench.bench import bench_of, page
from truing.workbench.guard import SHEET_POLICY


async def runs_page(request: Request) -> Response:
    """List the runs and diagnoses of the folder."""
    bench = bench_of(request)
    entries = await bench.ask("runs.listed", root=str(bench.root))
    return page(request, "runs.html.j2", title="Runs", entries=entries)


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


ROUTES = [Route("/runs", runs_page), Route("/file/{name:path}", file)]
