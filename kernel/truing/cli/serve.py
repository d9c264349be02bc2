"""calc serve: the workbench on this machine."""

from __future__ import annotations

import webbrowser
from types import SimpleNamespace
from typing import Any

from truing.cli.console import Settings, out
from truing.errors import UsageError
from truing.heavy import Later

server: Any = Later("truing.workbench.server")
LOOPBACK = {"127.0.0.1", "localhost", "::1"}
NEEDED = "the workbench needs libraries that are not installed; install them with: pip install 'truing[web]'"


def serve(settings: Settings, asked: SimpleNamespace) -> int:
    """Serve a folder as a workbench, for a browser on this machine; Ctrl-C ends it."""
    folder = asked.folder
    if not folder.is_dir():
        raise UsageError(f"{folder} is no folder; name the one with your inputs files")
    if asked.host not in LOOPBACK:
        settings.say(f"warning: {asked.host} can be reached from other machines; whoever has the address can use it")

    def ready(address: str) -> None:
        out(f"workbench of {folder.resolve()}: {address}")
        settings.say("Ctrl-C ends it")
        if not asked.no_browser:
            webbrowser.open(address)

    try:
        run = server.serve
    except ImportError:
        raise UsageError(NEEDED) from None
    run(folder, host=asked.host, port=asked.port, memory=int(asked.memory * 2**30), ready=ready)
    return 0
