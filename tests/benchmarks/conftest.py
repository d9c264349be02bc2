"""Prints with every benchmark what it ran on: what a ratio is worth depends on it."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import numpy as np
import pytest


def processor() -> str:
    """Name the processor, as the system does."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown")


def vector_extensions() -> str:
    """Name the vector extensions that numpy uses here beyond those of its baseline."""
    simd = np.show_config(mode="dicts")["SIMD Extensions"]  # type: ignore[index,call-overload]
    return ", ".join(simd.get("found", ())) or "only the baseline"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say processor, cores, numpy and its vector extensions."""
    terminalreporter.write_line(
        f"\nmeasured on {processor()}, {os.cpu_count()} cores; numpy {np.__version__}, vector extensions: "
        f"{vector_extensions()}"
    )
