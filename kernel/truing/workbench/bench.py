"""What every route needs: the folder, the workers, the plugins of files that the user has confirmed, the pages."""

from __future__ import annotations

import hashlib
import json
from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import anyio
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.requests import ClientDisconnect, Request
from starlette.responses import HTMLResponse, JSONResponse

from truing.atomic import file_appearing
from truing.errors import UsageError
from truing.templating import template_folder
from truing.workbench.places import inside
from truing.workbench.workers import PATIENCE, Job, OvertakenError, TaskError, Workers, fault_of

LARGEST_BODY = 4_000_000
"""Bytes of a request that is no upload of a measured file: as data of Python it takes up to thirty times as many."""
LARGEST_UPLOAD = 512_000_000
"""Bytes of an uploaded file: as many as are read of a table."""
MOST_ASKED = 30
"""Questions that may wait at the same time; each holds a thread, and files are read by others."""


@dataclass(frozen=True)
class Bench:
    """One workbench: the folder that is served, and who works for it."""

    root: Path
    workers: Workers
    confirmed: set[str] = field(default_factory=set)
    """The plugins in files that the user let run, by path, as long as the server lives."""
    kept: dict[Any, Any] = field(default_factory=dict)
    """Answers that stay true as long as the server lives, or as long as their key says: figures, names of programs."""
    asked: anyio.CapacityLimiter = field(default_factory=lambda: anyio.CapacityLimiter(MOST_ASKED))

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

    async def ask(self, name: str, /, *, patience: float = PATIENCE, group: str = "", **arguments: Any) -> Any:
        """Do a quick task in a worker; a newer question of the same ``group`` ends this one.

        Raises TaskError; OvertakenError where a newer one came.
        """
        if group:
            arguments["group"] = group
        question = partial(self.workers.ask, name, patience=patience, **arguments)
        return await anyio.to_thread.run_sync(question, limiter=self.asked)

    def start(self, name: str, title: str, about: str, /, **arguments: Any) -> Job:
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
    """Return the JSON of a request. Raises UsageError where it is none, says something twice, or is too much."""
    if request.headers.get("content-type", "").partition(";")[0].strip().lower() != "application/json":
        raise UsageError("the request holds no JSON")
    content = b"".join([part async for part in bounded(request, LARGEST_BODY)])
    try:
        document = await anyio.to_thread.run_sync(_json, content)
    except (ValueError, RecursionError):
        raise UsageError("the request holds no JSON") from None
    if not isinstance(document, dict):
        raise UsageError("the request holds no JSON object")
    return document


def _json(content: bytes) -> Any:
    """Read JSON as the standard has it: no name twice in an object, no NaN. Raises ValueError."""

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        document = dict(pairs)
        if len(document) != len(pairs):
            raise ValueError("a name stands twice in an object")
        return document

    def no_number(word: str) -> Any:
        raise ValueError(f"{word} is no number")

    return json.loads(content.decode("utf-8"), object_pairs_hook=once, parse_constant=no_number)


async def bounded(request: Request, most: int, what: str = "the request") -> AsyncIterator[bytes]:
    """Give the body of a request part by part. Raises TooLargeError as soon as it is known to be longer than most."""
    said = request.headers.get("content-length", "0")
    if not said.isascii() or not said.isdigit() or len(said) > 15 or int(said) > most:
        raise TooLargeError(most, what)
    size = 0
    async for part in request.stream():
        size += len(part)
        if size > most:
            raise TooLargeError(most, what)
        yield part


async def received(request: Request, path: Path, *, replace: bool = False) -> bool:
    """Write the body of a request to a file of the folder, which appears whole or not at all.

    ``path`` is one that ``Bench.path`` gave. Where a file is there that is not to be replaced, nothing is written:
    return whether the body says the same. Raises UsageError where the body is too large, empty or ends early,
    OutputError where the file cannot be written.
    """
    try:
        if not replace and path.is_file():
            return await _says_the_same(request, path)
        with file_appearing(path, replace=replace) as stream:
            async for part in _parts(request, path.name):
                await anyio.to_thread.run_sync(stream.write, part)
    except ClientDisconnect:
        raise UsageError(f"{path.name} did not arrive whole") from None
    return True


async def _parts(request: Request, name: str) -> AsyncIterator[bytes]:
    """Give an upload part by part. Raises UsageError where it is too large, or holds nothing."""
    is_empty = True
    async for part in bounded(request, LARGEST_UPLOAD, name):
        is_empty = is_empty and not part
        yield part
    if is_empty:
        raise UsageError(f"{name} is empty")


async def _says_the_same(request: Request, path: Path) -> bool:
    same = True
    with path.open("rb") as there:
        async for part in _parts(request, path.name):
            same = same and await anyio.to_thread.run_sync(there.read, len(part)) == part
        return same and not there.read(1)


class TooLargeError(UsageError):
    """A request that brings more than it may."""

    def __init__(self, most: int, what: str) -> None:
        super().__init__(f"{what} is larger than the {most / 1e6:g} MB that are taken")


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
    if isinstance(error, OvertakenError):
        return JSONResponse({"faults": error.faults, "overtaken": True}, 409)
    if isinstance(error, TooLargeError):
        status = 413
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
