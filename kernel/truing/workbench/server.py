"""The workbench as a web application: every page and call, and what is said where one fails."""

from __future__ import annotations

from pathlib import Path

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles

from truing.errors import TruingError, UsageError
from truing.templating import template_folder
from truing.texts import one_line
from truing.workbench import editing, jobs, keeping, making, measuring, picking, seeing
from truing.workbench.bench import Bench, UnconfirmedError, faulty, page
from truing.workbench.guard import Guard, Key
from truing.workbench.workers import TaskError, Workers, fault_of


def application(root: Path, key: Key, hosts: frozenset[str], workers: Workers) -> Guard:
    """Make the application: every page and call behind the guard."""
    routes = [
        *picking.ROUTES,
        *editing.ROUTES,
        *seeing.ROUTES,
        *measuring.ROUTES,
        *keeping.ROUTES,
        *making.ROUTES,
        *jobs.ROUTES,
    ]
    app = Starlette(
        routes=[*routes, Mount("/static", StaticFiles(directory=template_folder() / "workbench" / "static"))],
        exception_handlers={
            TruingError: _said,
            TaskError: _said,
            HTTPException: _missing,
            ClientDisconnect: _too_slow,
            Exception: _broken,
        },
    )
    app.state.bench = Bench(root.resolve(), workers)
    return Guard(app, key, hosts)


def _wants_json(request: Request) -> bool:
    return request.url.path.startswith("/api/")


async def _said(request: Request, error: Exception) -> Response:
    if _wants_json(request):
        return faulty(error)
    if isinstance(error, UnconfirmedError):
        return page(request, "confirm.html.j2", 409, title=f"Run {error.file}?", file=error.file)
    faults = error.faults if isinstance(error, TaskError) else [fault_of(str(error))]
    return page(request, "fault.html.j2", 422, title="This cannot be shown", faults=faults)


async def _missing(request: Request, error: Exception) -> Response:
    status = getattr(error, "status_code", 404)
    if _wants_json(request):
        return faulty(error, status)
    fault = fault_of(str(getattr(error, "detail", "there is no such page")))
    return page(request, "fault.html.j2", status, title="Not found", faults=[fault])


async def _too_slow(request: Request, error: Exception) -> Response:
    return faulty(UsageError("the request did not come in time, or not whole"), 408)


async def _broken(request: Request, error: Exception) -> Response:
    words = one_line(f"{type(error).__name__}: {error}")
    fault = UsageError(f"{words} (this is a fault of the workbench; please report it)")
    if _wants_json(request):
        return faulty(fault, 500)
    return page(request, "fault.html.j2", 500, title="This page failed", faults=[fault_of(str(fault))])
