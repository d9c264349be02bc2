"""calc serve: the workbench on this machine."""

from __future__ import annotations

import os
import threading
import webbrowser
from types import SimpleNamespace
from typing import Any

from truing.cli.console import Settings, out
from truing.errors import UsageError
from truing.heavy import Later

listening: Any = Later("truing.workbench.listening")
LIBRARIES = {"starlette", "uvicorn", "tomlkit", "h11", "anyio"}
NEEDED = "the workbench needs {}, which is not installed; install it with: pip install 'truing[web]'"
REACHED = (
    "warning: {} can be reached from other machines, and nothing on the way is encrypted; whoever has the address can "
    "read and change the folder and run its calculations"
)


def serve(settings: Settings, asked: SimpleNamespace) -> int:
    """Serve a folder as a workbench, for a browser on this machine; Ctrl-C ends it."""
    folder = asked.folder
    if not folder.is_dir():
        raise UsageError(f"{folder} is no folder; name the one with your inputs files")
    if not os.access(folder, os.R_OK | os.X_OK):
        raise UsageError(f"{folder} cannot be read; ask its owner, or name another folder")

    def ready(address: str, own: str) -> None:
        if not listening.is_loopback(asked.host):
            settings.say(REACHED.format(asked.host))
        if not os.access(folder, os.W_OK):
            settings.say(f"warning: {folder} is read-only; nothing can be saved there")
        out(f"workbench of {folder.resolve()}: {address}")
        settings.say("Ctrl-C ends it")
        if not asked.no_browser:
            threading.Thread(target=webbrowser.open, args=(own,), daemon=True).start()

    _with_libraries()(folder, host=asked.host, port=asked.port, memory=int(asked.memory * 2**30), ready=ready)
    return 0


def _with_libraries() -> Any:
    """Return what serves. Raises UsageError where a library of the extra is missing."""
    try:
        Later("tomlkit").parse  # noqa: B018  # is needed with the first change, and must not be missed then
        return listening.serve
    except ImportError as error:
        missing = (error.name or "").partition(".")[0]
        if missing not in LIBRARIES:
            raise
        raise UsageError(NEEDED.format(missing)) from None
