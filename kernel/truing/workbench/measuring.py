"""Measured files: taken in, previewed, diagnosed; a cause accepted, an experiment planned."""

from __future__ import annotations

from starlette.routing import Route

ROUTES: list[Route] = []
