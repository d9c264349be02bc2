"""Work in the background: what runs, cancel, and what became of it; and the stream by which pages hear of changes."""

from __future__ import annotations

import json
import time
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from truing.errors import UsageError
from truing.workbench.bench import Bench, bench_of, body_of, digest_of, word

EVERY = 0.25
"""Seconds between two looks at jobs and at the file."""
STILL_HERE = 15.0
"""Seconds after which a stream says a word, so that a page that is gone is noticed."""
LARGEST_SHOWN = 50_000_000
"""Bytes of a file that a page shows."""


async def listed(request: Request) -> Response:
    """Give every job that is remembered, the newest first."""
    known = bench_of(request).workers.jobs.values()
    return JSONResponse({"jobs": [job.as_json() for job in sorted(known, key=lambda job: -job.started)]})


async def cancel(request: Request) -> Response:
    """End a job."""
    document = await body_of(request)
    if not bench_of(request).workers.cancel(word(document, "job")):
        raise UsageError("this job has ended already")
    return JSONResponse({})


async def events(request: Request) -> Response:
    """Stream what changes: jobs, and the file that a page shows (server-sent events)."""
    bench, name = bench_of(request), request.query_params.get("file", "")
    path = bench.path(name) if name else None
    return StreamingResponse(_told(request, bench, path), media_type="text/event-stream")


async def _told(request: Request, bench: Bench, path: Path | None) -> AsyncIterator[str]:
    """Give a message at the beginning and whenever something has changed, until the page or the server is gone."""
    seen: tuple[int, Any] | None = None
    digest, said = "", time.monotonic()
    while not bench.workers.closed and not await request.is_disconnected():
        now = bench.workers.changes, _state(path)
        if now != seen:
            if path is not None and (seen is None or now[1] != seen[1]):
                digest = await anyio.to_thread.run_sync(_digest, path)
            seen, said = now, time.monotonic()
            jobs = [job.as_json() for job in tuple(bench.workers.jobs.values())]
            yield f"data: {json.dumps({'jobs': jobs, 'digest': digest})}\n\n"
        elif time.monotonic() - said > STILL_HERE:
            said = time.monotonic()
            yield ": still here\n\n"
        await anyio.sleep(EVERY)


def _state(path: Path | None) -> tuple[int, int, int] | None:
    """Return what changes whenever a file is written."""
    try:
        status = path.stat() if path is not None else None
    except OSError:
        return None
    return (status.st_mtime_ns, status.st_size, status.st_ino) if status is not None else None


def _digest(path: Path) -> str:
    """Return the fingerprint of a file, or nothing where there is none, or one that no page shows."""
    try:
        return digest_of(path.read_bytes()) if path.is_file() and path.stat().st_size <= LARGEST_SHOWN else ""
    except OSError:
        return ""


ROUTES = [
    Route("/api/jobs", listed),
    Route("/api/cancel", cancel, methods=["POST"]),
    Route("/events", events),
]
