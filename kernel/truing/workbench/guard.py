"""Who may ask the workbench: a browser on this machine that holds the key, from a page of the workbench itself.

The address that ``calc serve`` prints holds a token and stays good as long as the server lives: a second browser, a
closed tab and a link that a terminal has looked at beforehand would else lock its owner out. It becomes a cookie at
once, and leaves the address. The browser that ``calc serve`` opens itself gets a ticket instead that is good once:
other users of the machine see the words of its command.
"""

from __future__ import annotations

import hmac
import secrets
import socket
import time
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import anyio
from starlette.datastructures import MutableHeaders
from starlette.requests import Request
from starlette.responses import JSONResponse, PlainTextResponse, RedirectResponse, Response

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; font-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'self'"
)
"""Scripts come from files of ours alone. Styles may stand in a page, as our figures have theirs in their elements."""
SHEET_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; font-src data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'self'; sandbox allow-popups allow-popups-to-escape-sandbox"
)
"""Of pages that a run left in the folder: they are shown and can do nothing."""
FIXED = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "x-frame-options": "SAMEORIGIN",
    "permissions-policy": "camera=(), geolocation=(), microphone=()",
}
SAFE = {"GET", "HEAD"}
METHODS = SAFE | {"POST"}
LONGEST_SECRET = 200
"""Characters of a token that are looked at: ours have 43."""
MOST_WRONG = 10
"""Wrong keys in a second after which no token is looked at; browsers that are let in already do not notice."""
SLOWEST_PART = 20.0
"""Seconds in which the next part of a body must come."""
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")


def _secret() -> str:
    return secrets.token_urlsafe(32)


@dataclass
class Key:
    """What opens one server: the token of its address and cookie, and tickets that are good once."""

    port: int
    token: str = field(default_factory=_secret)
    tickets: set[str] = field(default_factory=set)
    wrong: deque[float] = field(default_factory=lambda: deque(maxlen=MOST_WRONG))
    """When the last wrong keys were tried."""

    @property
    def cookie(self) -> str:
        """Name of the cookie: two servers on one machine do not take each other's."""
        return f"truing_{self.port}"

    def ticket(self) -> str:
        """Return a token that is good once."""
        made = _secret()
        self.tickets.add(made)
        return made

    def lets_in(self, given: str) -> bool:
        """Tell whether a token opens, in the same time for every wrong one; a ticket is used up."""
        for ticket in tuple(self.tickets):
            if same(given, ticket):
                self.tickets.discard(ticket)
                return True
        return self._counted(same(given, self.token))

    def knows(self, given: str) -> bool:
        """Tell whether a cookie is that of this server. A missing one is no guess."""
        return bool(given) and self._counted(same(given, self.token))

    def _counted(self, is_right: bool) -> bool:
        if not is_right:
            self.wrong.append(time.monotonic())
        return is_right

    @property
    def is_besieged(self) -> bool:
        """Whether so many wrong keys were tried within a second that somebody guesses."""
        return len(self.wrong) == MOST_WRONG and time.monotonic() - self.wrong[0] < 1.0


def same(given: str, secret: str) -> bool:
    """Compare two secrets in a time that does not tell where they differ."""
    return hmac.compare_digest(given[:LONGEST_SECRET].encode("utf-8", "replace"), secret.encode())


def hosts_of(host: str, port: int) -> frozenset[str]:
    """Return the names by which a browser may call a server that listens to ``host``."""
    shown = f"[{host}]" if ":" in host else host
    names: Iterable[str] = {shown, *LOOPBACK}
    if shown not in LOOPBACK:
        names = {*names, socket.gethostname().lower(), socket.getfqdn().lower()}
    return frozenset({f"{name}:{port}" for name in names} | (set(names) if port == 80 else set()))


class Guard:
    """Refuse what does not come from a page of the workbench; add the headers that keep pages harmless."""

    def __init__(self, app: Any, key: Key, hosts: frozenset[str]) -> None:
        self.app, self.key, self.hosts = app, key, hosts

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Let a request through, or answer why not."""
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
            return
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def headed(message: Any) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("content-security-policy", POLICY)
                headers.setdefault("cache-control", "no-store")
                headers.update(FIXED)
            await send(message)

        request = Request(scope)
        answer = self._refusal(request)
        await (answer or self.app)(scope, _in_time(receive), headed)

    def _refusal(self, request: Request) -> Response | None:
        if not self._is_ours(request.headers.get("host", ""), request):
            return refused(request, "this address is not that of the workbench", 421)
        if request.method not in METHODS or "upgrade" in request.headers:
            return refused(request, "the workbench takes no such request", 405)
        if not self._is_from_us(request):
            return refused(request, "the request comes from another page", 403)
        return self._without_key(request)

    def _without_key(self, request: Request) -> Response | None:
        """Return the answer to whoever has no key, or brings it in the address; None for whoever has it."""
        given = request.query_params.get("token", "")
        if self.key.knows(request.cookies.get(self.key.cookie, "")):
            return _to_path(request) if given else None
        if self.key.is_besieged:
            return refused(request, "too many wrong keys; wait a second", 429)
        if given and request.method in SAFE and self.key.lets_in(given):
            answer = _to_path(request)
            answer.set_cookie(self.key.cookie, self.key.token, httponly=True, samesite="strict", path="/")
            return answer
        return refused(request, "open the workbench by the address that calc serve printed", 401)

    def _is_ours(self, name: str, request: Request) -> bool:
        """Tell whether a name with its port is this server's: one of its names, or the address that was connected to.

        A page elsewhere whose name was turned to this machine (DNS rebinding) calls it by that name.
        """
        address, port = request.scope.get("server") or ("", 0)
        plain = str(address).removeprefix("::ffff:")
        reached = f"[{plain}]:{port}" if ":" in plain else f"{plain}:{port}"
        return name.lower() in self.hosts or (bool(plain) and name.lower() == reached)

    def _is_from_us(self, request: Request) -> bool:
        """Tell whether a request comes from a page of ours, or was typed."""
        headers = request.headers
        origin, site = headers.get("origin"), headers.get("sec-fetch-site", "none")
        if origin is not None:
            return origin.startswith("http://") and self._is_ours(origin.removeprefix("http://"), request)
        if request.method not in SAFE:
            return site == "same-origin"
        is_opened = headers.get("sec-fetch-mode") == "navigate" and headers.get("sec-fetch-dest") == "document"
        return site in {"none", "same-origin"} or is_opened


def _to_path(request: Request) -> Response:
    """Send on to the same page without the token in the address."""
    return RedirectResponse("/" + request.url.path.lstrip("/\\"), 303)


def refused(request: Request, sentence: str, status: int) -> Response:
    """Say why a request is not answered."""
    if request.url.path.startswith("/api/"):
        return JSONResponse({"faults": [{"message": sentence, "file": "", "line": None, "cell": ""}]}, status)
    return PlainTextResponse(sentence, status)


def _in_time(receive: Any) -> Any:
    """Return what takes in a body, and gives up one that does not go on."""
    is_complete = False

    async def received() -> Any:
        nonlocal is_complete
        if is_complete:  # what comes now is the end of the connection
            return await receive()
        with anyio.move_on_after(SLOWEST_PART):
            message = await receive()
            is_complete = not message.get("more_body", False)
            return message
        return {"type": "http.disconnect"}

    return received
