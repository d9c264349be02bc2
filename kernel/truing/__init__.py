"""Engineering calculations as plugins: what a plugin author needs, and nothing else."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from truing.api.differences import Differences
    from truing.api.model import Diagnosis, LoadedModel, compare, load
    from truing.api.plan import Plan
    from truing.api.records import read, record
    from truing.api.run import Run
    from truing.api.study import StudyResult
    from truing.declare.batch import column, either, feasible
    from truing.declare.blocks import Block, Drawing, Table, Words
    from truing.declare.correlations import correlated
    from truing.declare.dynamics import Dynamics, Event, Motion, state, states
    from truing.declare.fields import Array, Float, axis, found, given, inputs, loaded, part, results, rows
    from truing.declare.goals import Maximise, Minimise, Objective, Price, Require, Vary
    from truing.declare.model import Model, Record, Section, Study
    from truing.declare.published import Finding, Published
    from truing.declare.sources import Condition, Effect, ErrorSource, Tolerance, Unknown
    from truing.declare.spreads import by_choice, drawn, grade, lognormal, normal, off, plus_minus, uniform, zone
    from truing.declare.taken import from_model
    from truing.errors import TruingError
    from truing.hookspecs import hookimpl, hookspec
    from truing.kernel import Kernel
    from truing.studies.allocation import Allocation, Allotted
    from truing.studies.bench import Bench, Outcome
    from truing.studies.checks import Check, Proposal
    from truing.studies.frequency import Frequency, FrequencyAnswer
    from truing.studies.optimise import Optimise, Optimum
    from truing.studies.reliability import Odds, Reliability
    from truing.studies.sensitivity import Sensitivities, Sensitivity
    from truing.studies.surrogate import Emulated, Surrogate
    from truing.studies.sweep import Sweep, Swept
    from truing.studies.uncertainty import Budgets, Uncertainty
    from truing.units import quantity

_HOMES = {
    "truing.api.differences": ("Differences",),
    "truing.api.model": ("Diagnosis", "LoadedModel", "compare", "load"),
    "truing.api.plan": ("Plan",),
    "truing.api.records": ("read", "record"),
    "truing.api.run": ("Run",),
    "truing.api.study": ("StudyResult",),
    "truing.declare.batch": ("column", "either", "feasible"),
    "truing.declare.blocks": ("Block", "Drawing", "Table", "Words"),
    "truing.declare.correlations": ("correlated",),
    "truing.declare.dynamics": ("Dynamics", "Event", "Motion", "state", "states"),
    "truing.declare.fields": ("Array", "Float", "axis", "found", "given", "inputs", "loaded", "part", "results",
                              "rows"),
    "truing.declare.goals": ("Maximise", "Minimise", "Objective", "Price", "Require", "Vary"),
    "truing.declare.model": ("Model", "Record", "Section", "Study"),
    "truing.declare.published": ("Finding", "Published"),
    "truing.declare.sources": ("Condition", "Effect", "ErrorSource", "Tolerance", "Unknown"),
    "truing.declare.spreads": (
        "by_choice", "drawn", "grade", "lognormal", "normal", "off", "plus_minus", "uniform", "zone",
    ),
    "truing.declare.taken": ("from_model",),
    "truing.errors": ("TruingError",),
    "truing.kernel": ("Kernel",),
    "truing.hookspecs": ("hookimpl", "hookspec"),
    "truing.studies.allocation": ("Allocation", "Allotted"),
    "truing.studies.bench": ("Bench", "Outcome"),
    "truing.studies.checks": ("Check", "Proposal"),
    "truing.studies.frequency": ("Frequency", "FrequencyAnswer"),
    "truing.studies.optimise": ("Optimise", "Optimum"),
    "truing.studies.reliability": ("Odds", "Reliability"),
    "truing.studies.sensitivity": ("Sensitivities", "Sensitivity"),
    "truing.studies.surrogate": ("Emulated", "Surrogate"),
    "truing.studies.sweep": ("Sweep", "Swept"),
    "truing.studies.uncertainty": ("Budgets", "Uncertainty"),
    "truing.units": ("quantity",),
}  # fmt: skip
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [  # noqa: RUF022  # what a user calls; then what a plugin needs, in the order of its story
    "load", "LoadedModel", "Run", "StudyResult", "read", "record", "Diagnosis", "Plan",
    "compare", "Differences",
    "inputs", "results", "given", "found", "axis", "rows", "part", "loaded", "from_model", "quantity", "Float",
    "Array",
    "feasible", "either", "column",
    "states", "state", "Dynamics", "Motion", "Event",
    "Tolerance", "Effect", "Unknown", "Condition", "ErrorSource",
    "normal", "plus_minus", "uniform", "lognormal", "grade", "zone", "drawn", "by_choice", "off",
    "correlated",
    "Vary", "Minimise", "Maximise", "Require", "Price", "Objective",
    "Model", "Section", "Record", "Study", "Published", "Finding",
    "Words", "Table", "Drawing", "Block",
    "Sweep", "Swept", "Sensitivity", "Sensitivities", "Reliability", "Odds", "Allocation", "Allotted",
    "Optimise", "Optimum",
    "Surrogate", "Emulated",
    "Frequency", "FrequencyAnswer",
    "Uncertainty", "Budgets",
    "Bench", "Outcome", "Check", "Proposal",
    "hookimpl", "hookspec", "Kernel", "TruingError",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a name when it is first used, so that ``import truing`` costs nothing."""
    if name not in _HOME:
        raise AttributeError(f"module 'truing' has no attribute '{name}'")

    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
