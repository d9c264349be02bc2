"""How a command is ended from outside: by Ctrl-C and by the system, and by neither in vain."""

from __future__ import annotations

import _thread
import signal
import sys
import threading

AFTER_FINALIZER = 0.05
"""So many seconds after a finalizer that an interrupt was dropped in it is raised again."""


class Terminated(KeyboardInterrupt):  # as the interrupt it is
    """The system has asked this process to end (SIGTERM): what Ctrl-C does, with another exit code."""


def hear_endings() -> None:
    """End as after an interrupt when the system asks for it, so that nothing is left behind.

    Python drops an exception in a finalizer. An interrupt that comes just then is raised once more, after it.
    """

    def terminate(number: int, frame: object) -> None:
        raise Terminated

    def raise_again(dropped: sys.UnraisableHookArgs) -> None:
        if not isinstance(dropped.exc_value, KeyboardInterrupt):
            sys.__unraisablehook__(dropped)
            return
        number = signal.SIGTERM if isinstance(dropped.exc_value, Terminated) else signal.SIGINT
        later = threading.Timer(AFTER_FINALIZER, _signal_main, [number])
        later.daemon = True
        later.start()

    signal.signal(signal.SIGTERM, terminate)
    sys.unraisablehook = raise_again


def _signal_main(number: signal.Signals) -> None:
    """Send a signal to the main thread, wherever it waits."""
    main = threading.main_thread().ident
    if sys.platform == "win32" or main is None:
        _thread.interrupt_main(number)
    else:
        signal.pthread_kill(main, number)
