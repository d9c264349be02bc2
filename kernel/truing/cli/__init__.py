"""The command ``calc``: one file per verb, nothing but arguments and printing."""

from __future__ import annotations

import sys
from collections.abc import Sequence

FLAGS = {"--traceback": "traceback", "-v": "verbose", "--verbose": "verbose", "-q": "quiet", "--quiet": "quiet"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``calc`` with these arguments (the command line's by default) and return the exit code.

    0 done; 1 done, but a check fails; 2 usage or input; 3 the plugin failed; 4 no convergence; 130 interrupted.
    """
    from truing.cli.app import app
    from truing.cli.console import Settings, utf8_streams

    utf8_streams()
    words = list(sys.argv[1:] if arguments is None else arguments)
    said = {FLAGS[word] for word in words if word in FLAGS}
    settings = Settings(**dict.fromkeys(said, True))
    try:
        app(args=[word for word in words if word not in FLAGS], prog_name="calc", obj=settings)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0 if end.code is None else 2
    return 0
