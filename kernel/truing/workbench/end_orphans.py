"""A process that waits for the end of the server, however it comes, and then ends the groups of its workers.

A worker whose model loops in C cannot notice by itself that the server was killed. Lines on the input say which groups
there are: "+ 123" begun, "- 123" ended.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress


def main() -> None:
    """Read until the server is gone; end what is left of it."""
    groups: set[int] = set()
    for line in sys.stdin:
        kind, _, number = line.partition(" ")
        (groups.add if kind == "+" else groups.discard)(int(number))
    for group in groups:
        with suppress(OSError):
            os.killpg(group, signal.SIGKILL)


if __name__ == "__main__":
    main()
