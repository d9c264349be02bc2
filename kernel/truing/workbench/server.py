"""The workbench as a web application, and the server that runs it until Ctrl-C."""

from __future__ import annotations

import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles

from truing.errors import OutputError, TruingError
from truing.heavy import Later
from truing.templating import template_folder
from truing.workbench import editing, jobs, keeping, making, measuring, picking, seeing
from truing.workbench.bench import Bench, faulty, page
from truing.workbench.guard import Guard, Key
from truing.workbench.workers import TaskError, Workers, fault_of

uvicorn: Any = Later("uvicorn")


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
        exception_handlers={TruingError: _said, TaskError: _said, HTTPException: _missing},
        lifespan=_lifespan,
    )
    app.state.bench = Bench(root.resolve(), workers)
    return Guard(app, key, hosts)


@asynccontextmanager
async def _lifespan(app: Starlette) -> AsyncIterator[None]:
    yield
    app.state.bench.workers.close()


def _wants_json(request: Request) -> bool:
    return request.url.path.startswith("/api/")


async def _said(request: Request, error: Exception) -> Response:
    if _wants_json(request):
        return faulty(error)
    faults = error.faults if isinstance(error, TaskError) else [fault_of(str(error))]
    return page(request, "fault.html.j2", 422, title="This cannot be shown", faults=faults)


async def _missing(request: Request, error: Exception) -> Response:
    status = getattr(error, "status_code", 404)
    if _wants_json(request):
        return faulty(error, status)
    fault = fault_of(str(getattr(error, "detail", "there is no such page")))
    return page(request, "fault.html.j2", status, title="Not found", faults=[fault])


def serve(root: Path, *, host: str, port: int, memory: int, ready: Callable[[str], None]) -> None:
    """Serve a folder until it is interrupted; ``ready`` gets the address once pages can be opened.

    Raises OutputError where the port is taken.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)  # named, or answers wait 40 ms for an ACK
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((host, port))
    except OSError as error:
        listening.close()
        raise OutputError(f"{host}:{port} cannot be opened: {error.strerror or error}; name another --port") from None
    port = listening.getsockname()[1]
    key, shown = Key(port), f"[{host}]" if ":" in host else host
    hosts = frozenset(f"{name}:{port}" for name in {shown, "localhost", "127.0.0.1"})
    workers = Workers(memory)
    app = application(root, key, hosts, workers)
    config = uvicorn.Config(
        app, log_level="error", timeout_graceful_shutdown=1, server_header=False, date_header=False, lifespan="on",
        h11_max_incomplete_event_size=64_000,
    )  # fmt: skip
    server = uvicorn.Server(config)
    listening.listen(128)
    ready(f"http://{shown}:{port}/?token={key.token}")
    try:
        server.run(sockets=[listening])
    finally:
        workers.close()
        listening.close()
