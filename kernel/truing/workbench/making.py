"""A calculation of one's own, made on a page: what ``calc new`` writes."""

from __future__ import annotations

from starlette.routing import Route

ROUTES: list[Route] = []
