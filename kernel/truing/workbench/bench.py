"""What every route needs: the folder, the workers, the plugins of files that the user has confirmed, the pages."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import anyio
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse

from truing.errors import UsageError
from truing.templating import template_folder
from truing.workbench.places import inside
from truing.workbench.workers import PATIENCE, Job, TaskError, Workers, fault_of

LARGEST_BODY = 20_000_000
"""Bytes of a request that is no upload of a measured file."""


@dataclass(frozen=True)
class Bench:
    """One workbench: the folder that is served, and who works for it."""

    root: Path
    workers: Workers
    confirmed: set[str] = field(default_factory=set)
    """The plugins in files that the user let run, by path, as long as the server lives."""
    kept: dict[Any, Any] = field(default_factory=dict)
    """Answers that stay true as long as the server lives, or as long as their key says: figures, names of programs."""

    def path(self, name: str) -> Path:
        """Return a file of the folder. Raises UsageError for one outside."""
        return inside(self.root, name)

    def plugin(self, name: str) -> str:
        """Return what a worker loads: the name of an installed plugin, or a confirmed file. Raises UsageError."""
        if not name.endswith(".py"):
            return name
        path = str(self.path(name))
        if path not in self.confirmed:
            raise UnconfirmedError(name)
        return path

    async def ask(self, name: str, *, patience: float = PATIENCE, **arguments: Any) -> Any:
        """Do a quick task in a worker. Raises TaskError."""
        return await anyio.to_thread.run_sync(partial(self.workers.ask, name, patience=patience, **arguments))

    def start(self, name: str, title: str, about: str, **arguments: Any) -> Job:
        """Begin a job."""
        return self.workers.start(name, title, about, **arguments)


class UnconfirmedError(UsageError):
    """A calculation in a Python file of the folder, which nobody has let run yet."""

    def __init__(self, file: str) -> None:
        self.file = file
        super().__init__(f"{file} is a program; confirm it before it runs")


def bench_of(request: Request) -> Bench:
    """Return the workbench of a request."""
    bench: Bench = request.app.state.bench
    return bench


def page(request: Request, template: str, status: int = 200, **words: Any) -> HTMLResponse:
    """Fill in a page of the workbench."""
    bench = bench_of(request)
    text = _environment().get_template(template).render(folder=bench.root.name, path=request.url.path, **words)
    return HTMLResponse(text, status)


async def body_of(request: Request) -> Mapping[str, Any]:
    """Return the JSON of a request. Raises UsageError where it is none, or too much."""
    if request.headers.get("content-type", "").partition(";")[0] != "application/json":
        raise UsageError("the request holds no JSON")
    size = 0
    parts: list[bytes] = []
    async for part in request.stream():
        size += len(part)
        if size > LARGEST_BODY:
            raise UsageError("the request is too large")
        parts.append(part)
    try:
        document = await anyio.to_thread.run_sync(json.loads, b"".join(parts))
    except (ValueError, RecursionError):
        raise UsageError("the request holds no JSON") from None
    if not isinstance(document, dict):
        raise UsageError("the request holds no JSON object")
    return document


def word(document: Mapping[str, Any], name: str, default: str | None = None) -> str:
    """Return a text of a request. Raises UsageError where it is missing or no text."""
    value = document.get(name, default)
    if not isinstance(value, str):
        raise UsageError(f"the request needs the text '{name}'")
    return value


def names(document: Mapping[str, Any], name: str) -> list[str]:
    """Return a list of names of a request. Raises UsageError where it is none."""
    value = document.get(name)
    if not isinstance(value, list) or not value or not all(isinstance(each, str) for each in value):
        raise UsageError(f"the request needs the names '{name}'")
    return value


def faulty(error: Exception, status: int = 422) -> JSONResponse:
    """Answer with what is wrong, fault by fault."""
    if isinstance(error, UnconfirmedError):
        return JSONResponse({"faults": [fault_of(str(error))], "confirm": error.file}, 409)
    faults = error.faults if isinstance(error, TaskError) else [fault_of(str(error))]
    return JSONResponse({"faults": faults}, status)


def digest_of(content: bytes) -> str:
    """Return the fingerprint by which two states of a file are told apart."""
    return hashlib.sha256(content).hexdigest()


@lru_cache(maxsize=1)
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(template_folder() / "workbench"), undefined=StrictUndefined, trim_blocks=True,
        autoescape=True,
    )  # fmt: skip
