"""The two decorators of pluggy, bound to this project's name."""

from __future__ import annotations

import pluggy

hookspec = pluggy.HookspecMarker("truing")
hookimpl = pluggy.HookimplMarker("truing")
