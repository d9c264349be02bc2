"""Libraries that take longer to import than most calculations take, each imported when it is first used.

A file that needs one imports its name from here at the top, like any other; the import itself waits.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Later:
    """A module by its name, imported when something of it is first asked for."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        """Return what the module calls so. Raises ImportError where it is not installed."""
        return getattr(import_module(self._name), name)


gaussian_process: Any = Later("sklearn.gaussian_process")
gaussian_kernels: Any = Later("sklearn.gaussian_process.kernels")
learning_exceptions: Any = Later("sklearn.exceptions")
stats: Any = Later("scipy.stats")
ipython_display: Any = Later("IPython.display")
pymoo_config: Any = Later("pymoo.config")
pymoo_evaluator: Any = Later("pymoo.core.evaluator")
pymoo_hypervolume: Any = Later("pymoo.indicators.hv")
pymoo_mutation: Any = Later("pymoo.operators.mutation.pm")
pymoo_nsga2: Any = Later("pymoo.algorithms.moo.nsga2")
pymoo_problem: Any = Later("pymoo.core.problem")
pymoo_repair: Any = Later("pymoo.core.repair")
pymoo_static: Any = Later("pymoo.problems.static")
