"""The server process from its socket to the last signal: it listens, gives up what is too slow, and ends clean."""

from __future__ import annotations

import errno
import os
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from ipaddress import ip_address
from pathlib import Path
from types import FrameType
from typing import Any

import h11
import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from truing.errors import OutputError
from truing.workbench.guard import Key, hosts_of
from truing.workbench.places import tidy
from truing.workbench.server import application
from truing.workbench.workers import Workers

LARGEST_HEAD = 64_000
"""Bytes of all headers of a request."""
SLOWEST_HEAD = 15.0
"""Seconds in which the headers of a request must have come; a connection on which nothing is asked ends, too."""
MOST_CONNECTIONS = 250
"""A browser opens six."""
LAST_MOMENT = 1
"""Seconds that answers may still take after Ctrl-C."""


class Connection(H11Protocol):
    """One connection of a browser, given up where it keeps the server waiting."""

    def connection_made(self, transport: Any) -> None:
        """Begin to wait for a request, unless there are too many connections."""
        super().connection_made(transport)
        if len(self.connections) > MOST_CONNECTIONS:
            transport.abort()
            return
        self.loop.call_later(SLOWEST_HEAD, self._look, b"")

    def _look(self, before: bytes) -> None:
        """End the connection where a request has been coming since the last look, or none has ever come."""
        if self.transport is None or self.transport.is_closing():
            return
        is_waiting = self.conn.their_state is h11.IDLE
        coming = self.conn.trailing_data[0] if is_waiting else b""
        if is_waiting and (self.cycle is None or (before and coming.startswith(before))):
            self.transport.abort()
            return
        self.loop.call_later(SLOWEST_HEAD, self._look, coming)


class Server(uvicorn.Server):
    """A server whose workers end as soon as it is asked to end, so that no answer keeps it."""

    def __init__(self, config: uvicorn.Config, workers: Workers) -> None:
        super().__init__(config)
        self._workers = workers

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Hear Ctrl-C, or the system; in a thread, since the signal may have come within a lock."""
        self._workers.closed = True
        threading.Thread(target=self._workers.close).start()
        super().handle_exit(sig, frame)


def is_loopback(host: str) -> bool:
    """Whether an address can be reached from this machine alone."""
    with suppress(ValueError):
        return ip_address(host).is_loopback
    return host == "localhost"


def serve(root: Path, *, host: str, port: int, memory: int, ready: Callable[[str, str], None]) -> None:
    """Serve a folder until it is interrupted: Ctrl-C returns, the system's request to end (SIGTERM) raises its own.

    ``ready`` gets two addresses once pages can be opened: one to be printed, and one that is good once.
    Raises OutputError where the port is taken.
    """
    with _listening(host, port) as listening:
        port = listening.getsockname()[1]
        key, root = Key(port), root.resolve()
        workers = Workers(memory, root)
        try:
            server = Server(configured(application(root, key, hosts_of(host, port), workers)), workers)
            listening.listen(128)
            address = f"http://{_shown(host)}:{port}/?token="
            ready(address + key.token, address + key.ticket())
            threading.Thread(target=tidy, args=(root,), daemon=True).start()
            server.run(sockets=[listening])
        except KeyboardInterrupt as end:
            if type(end) is not KeyboardInterrupt:
                raise
        finally:
            workers.close()


def configured(app: Any) -> uvicorn.Config:
    """Return how the application is served: plain HTTP that does not wait for long, and nothing written to a log."""
    return uvicorn.Config(
        app, http=Connection, ws="none", lifespan="off", log_level="critical", access_log=False, server_header=False,
        date_header=False, proxy_headers=False, timeout_graceful_shutdown=LAST_MOMENT,
        h11_max_incomplete_event_size=LARGEST_HEAD,
    )  # fmt: skip


def _listening(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)  # named, or answers wait 40 ms for an ACK
    try:
        if os.name == "posix":  # elsewhere two servers would share a port
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((host, port))
    except OSError as error:
        listening.close()
        is_taken = error.errno == errno.EADDRINUSE
        why = "another program listens there" if is_taken else (error.strerror or str(error))
        now = "name another --port, or none for any that is free" if is_taken else "name another --host or --port"
        raise OutputError(f"{_shown(host)}:{port} cannot be opened: {why}; {now}") from None
    return listening


def _shown(host: str) -> str:
    """Return a name for an address by which it can be called."""
    name = socket.gethostname() if host in {"0.0.0.0", "::"} else host
    return f"[{name}]" if ":" in name else name
