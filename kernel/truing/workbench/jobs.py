"""Work in the background: what runs, cancel, and what became of it; and the stream by which pages hear of changes."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from typing import Any

import anyio
from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from truing.errors import UsageError
from truing.workbench.bench import Bench, bench_of, body_of, digest_of, word

EVERY = 0.25
"""Seconds between two looks at jobs and at the file."""


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

    async def stream() -> AsyncIterator[str]:
        last: dict[str, Any] = {}
        while not await request.is_disconnected() and not bench.workers.closed:
            now = _seen(bench, path)
            if now != last:
                yield f"data: {json.dumps(now)}\n\n"
                last = now
            await anyio.sleep(EVERY)

    return StreamingResponse(stream(), media_type="text/event-stream")


def _seen(bench: Bench, path: Any) -> dict[str, Any]:
    jobs = [job.as_json() for job in bench.workers.jobs.values()]
    try:
        digest = digest_of(path.read_bytes()) if path is not None else ""
    except OSError:
        digest = ""
    return {"jobs": jobs, "digest": digest}


ROUTES = [
    Route("/api/jobs", listed),
    Route("/api/cancel", cancel, methods=["POST"]),
    Route("/events", events),
]
