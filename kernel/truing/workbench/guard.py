"""Who may ask the workbench: a browser on this machine that holds the token, from a page of the workbench itself."""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass, field
from typing import Any

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import PlainTextResponse, RedirectResponse

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self'; frame-src 'self'; font-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'self'"
)
SHEET_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; font-src data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'self'; sandbox allow-popups allow-popups-to-escape-sandbox"
)
"""Of pages that a run left in the folder: they are shown and can do nothing."""
SAFE = {"GET", "HEAD"}


@dataclass(frozen=True)
class Key:
    """The token of one server, which a browser keeps as a cookie."""

    port: int
    token: str = field(default_factory=lambda: secrets.token_urlsafe(32))

    @property
    def cookie(self) -> str:
        """Name of the cookie: two servers on one machine do not take each other's."""
        return f"truing_{self.port}"

    def opens(self, given: str) -> bool:
        """Tell whether a token is this one, in the same time for every wrong one."""
        return hmac.compare_digest(given.encode(), self.token.encode())


class Guard:
    """Refuse what does not come from a page of the workbench; add the headers that keep pages harmless."""

    def __init__(self, app: Any, key: Key, hosts: frozenset[str]) -> None:
        self.app, self.key, self.hosts = app, key, hosts

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Let a request through, or answer why not."""
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

        answer = self._refusal(Request(scope))
        await (answer or self.app)(scope, receive, headed)

    def _refusal(self, request: Request) -> Any:
        headers = request.headers
        if headers.get("host", "") not in self.hosts:
            return PlainTextResponse("this address is not that of the workbench", 421)
        if not self._own(headers, request.method):
            return PlainTextResponse("the request comes from another page", 403)
        given = request.query_params.get("token", "")
        if given and request.method in SAFE and self.key.opens(given):
            answer = RedirectResponse(request.url.path, 303)
            answer.set_cookie(self.key.cookie, self.key.token, httponly=True, samesite="strict", path="/")
            return answer
        if not self.key.opens(request.cookies.get(self.key.cookie, "")):
            return PlainTextResponse("open the workbench by the address that calc serve printed", 401)
        return None

    def _own(self, headers: Headers, method: str) -> bool:
        """Tell whether a request comes from a page of ours, or was typed."""
        origin, site = headers.get("origin"), headers.get("sec-fetch-site", "none")
        if origin is not None:
            return origin.removeprefix("http://") in self.hosts and origin.startswith("http://")
        if method not in SAFE:
            return site == "same-origin"
        return site in {"none", "same-origin"} or headers.get("sec-fetch-mode") == "navigate"


FIXED = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "x-frame-options": "SAMEORIGIN",
}
