"""results.json: what a run found, as data. It names no date and no machine, so that equal runs are equal files."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Any

import numpy as np

from truing.calculation import Calculation
from truing.cases import CasesTable
from truing.declare.chain import chain_of, link_of, prefix_of
from truing.declare.fields import InputField
from truing.evaluate import taken_values
from truing.numbers import STATED_DIGITS
from truing.runs.provenance import Provenance
from truing.setup import Setup, SwitchedOn
from truing.studies.checks import Check, Proposal
from truing.studies.sampling import scatter_of
from truing.studies.verdicts import Decided
from truing.units import difference_unit, from_si, unit_factor, unit_text
from truing.units.names import PURE

SCHEMA = "truing.results/1"
LARGE = 1000
"""Results with more numbers than this stand in arrays.npz instead of results.json."""


def results_document(
    calculation: Calculation, provenance: Provenance, *, cases: CasesTable | None = None
) -> dict[str, Any]:
    """Return results.json as data: the same inputs, seed and versions give the same document, byte by byte.

    Numbers are in the unit each is printed in; one that is not finite is null. Large results name their array in
    arrays.npz instead. With ``cases`` the document is that of the governing one and lists them all.
    """
    setup = calculation.setup
    model = setup.model
    return {
        "schema": SCHEMA,
        "plugin": {"name": provenance.plugin, "version": provenance.plugin_version, "model": model.name},
        "kernel": provenance.kernel,
        "input_hash": provenance.input_hash,
        "seed": provenance.seed,
        "inputs": _inputs(setup),
        "tolerances": _tolerances(setup),
        "correlations": _correlations(setup),
        "conditions": {
            name: {**said, **_as_stated(setup, name, setup.conditions[name])}
            for name, said in _values(setup, setup.conditions).items()
        },
        "effects": {active.effect.name: _effect_values(active) for active in setup.effects},
        "results": {name: _result(calculation, name) for name in model.result_fields if name in calculation.answers},
        "verdict": calculation.verdict if cases is None else cases.verdict,
        "proposal": _proposal(calculation.decided.proposal),
        "checks": [_check(check) for check in calculation.checks],
        "studies": {name: clean(outcome.as_json()) for name, outcome in calculation.outcomes.items()},
        "failed": [{"row": int(row), "reason": reason} for row, reason in calculation.failed],
        "added": [{"what": what, "plugin": plugin, "version": version} for what, plugin, version in provenance.added],
        "warnings": list(calculation.warnings),
        **({} if cases is None else _cases(setup, cases)),
        **_chain(setup),
    }


def _inputs(setup: Setup) -> dict[str, Any]:
    fields, values = setup.model.input_fields, setup.model.read_inputs(setup.inputs)
    return {
        name: {**_input_value(setup, fields[name], value), **_as_stated(setup, name, value), **_from(setup, name)}
        for name, value in {**values, **taken_values(setup)}.items()
    }


def _from(setup: Setup, name: str) -> dict[str, Any]:
    """Say of which calculation an input is a result, where it is taken from one and not stated."""
    link = link_of(setup.model, name)
    if link is None or not np.isnan(setup.nominal(name)):
        return {}
    return {"from": {"calculation": link.source, "result": link.result}}


def _chain(setup: Setup) -> dict[str, Any]:
    """Return the calculations of a chain, in the order of calculation, and what each takes; nothing of one alone."""
    chain = chain_of(setup.model)
    if chain is None:
        return {}
    links = [
        {"input": name, "calculation": link.source, "result": prefix_of(link.source) + link.result}
        for name, link in chain.taken.items()
    ]
    names = [*chain.sources, ""]
    calculations = [
        {
            "name": name or chain.last.name,
            "model": chain.model_of(name).name,
            "title": chain.model_of(name).title,
            "prefix": prefix_of(name),
        }
        for name in names
    ]
    return {"chain": {"calculations": calculations, "links": links}}


def _check(check: Check) -> dict[str, Any]:
    numbers = {name: clean(getattr(check, name)) for name in ("name", "value", "limit", "unit", "margin")}
    return {
        **numbers,
        "compared": check.compared or check.name,
        "relation": check.relation,
        "state": check.state,
        "passed": bool(check.passed),
        "undecided": check.undecided,
        "proposed": None if check.proposed is None else clean(check.proposed.value),
    }


def _proposal(proposal: Proposal | None) -> dict[str, Any] | None:
    """Return the design that a study proposes: its changes to the one that is stated."""
    if proposal is None:
        return None
    changes = [{"name": name, "from": stated, "to": proposed} for name, stated, proposed in proposal.changes]
    return {"study": proposal.study, "what": proposal.what, "changes": changes}


def decided_by(document: Mapping[str, Any], checks: Sequence[Check]) -> Decided:
    """Return checks with the states that results.json of a run gives to those that are undecided, and its proposal."""
    there = {check["name"]: check for check in document.get("checks") or [] if not check["undecided"]}
    said = document.get("proposal")
    proposal = said and Proposal(
        said["study"], said["what"], tuple((each["name"], each["from"], each["to"]) for each in said["changes"]), ()
    )
    known = [_read_check(check, there[check.name]) if check.undecided and check.name in there else check
             for check in checks]  # fmt: skip
    return Decided(tuple(known), proposal)


def _read_check(check: Check, said: Mapping[str, Any]) -> Check:
    """Return a check with value, margin and state as they stand in results.json, in its units."""
    value, limit, margin = (math.nan if said[name] is None else said[name] for name in ("value", "limit", "margin"))
    stated = replace(
        check, value=value, limit=limit, margin=margin, unit=said["unit"], compared=said["compared"],
        passed=said["passed"], undecided="",
    )  # fmt: skip
    if said["proposed"] is None:
        return stated
    return replace(stated, proposed=replace(stated, value=said["proposed"], passed=said["state"] == "proposed"))


def _cases(setup: Setup, cases: CasesTable) -> dict[str, Any]:
    """Return what became of every row of the file of cases, whose folder is no part of it, and every case in order."""
    rows = {"file": PurePath(cases.read.file.replace("\\", "/")).name, **cases.count.as_json()}
    listed = []
    for index, case in enumerate(cases.cases):
        single = {name: value for name, value in case.answers.items() if not getattr(value, "ndim", 0)}
        listed.append(
            {
                "row": case.row,
                "name": case.name,
                "governing": index == cases.governing,
                "values": _values(setup, case.values),
                "results": _values(setup, single, case.absent),
                "verdict": case.verdict,
                "proposal": _proposal(case.decided.proposal),
                "checks": [_check(check) for check in case.checks],
                "failed": case.reason,
            }
        )
    return {"rows": rows, "cases": listed}


def large_arrays(calculation: Calculation) -> dict[str, Any]:
    """Return the results that are too large for results.json, in the unit each is printed in."""
    large = {name: value for name, value in calculation.answers.items() if np.size(value) > LARGE}
    unit_of = calculation.setup.print_unit
    return {name: from_si(np.asarray(value, dtype=float), unit_of(name)) for name, value in large.items()}


def clean(value: Any) -> Any:
    """Turn what a study gives into plain JSON: arrays to lists, numbers that are not finite to null."""
    if isinstance(value, Mapping):
        return {str(key): clean(one) for key, one in value.items()}
    if hasattr(value, "tolist"):
        return clean(value.tolist())
    if isinstance(value, (list, tuple, set, frozenset)):
        return [clean(one) for one in (sorted(value) if isinstance(value, (set, frozenset)) else value)]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)


def _values(
    setup: Setup, values: Mapping[str, Any], absent: Mapping[str, str] | None = None
) -> dict[str, dict[str, Any]]:
    """Return values in the units they are printed in; words have none, and what does not exist has its reason."""
    said = {}
    for name, value in values.items():
        is_word = isinstance(value, (str, bool))
        said[name] = {"value": value, "unit": ""} if is_word else _value(value, setup.print_unit(name))
        if absent and absent.get(name):
            said[name]["reason"] = absent[name]
    return said


def _value(value: Any, unit: str) -> dict[str, Any]:
    if isinstance(value, int) and unit in PURE:
        return {"value": value, "unit": unit}
    return {"value": clean(from_si(value, unit)), "unit": unit}


def _input_value(setup: Setup, field: InputField, value: Any) -> dict[str, Any]:
    if field.kind == "file":
        return {"value": setup.source.files.get(field.name), "unit": ""}
    if field.kind in {"switch", "text", "choice", "integer"} or getattr(field.spec, "unit", None) is None:
        return {"value": clean(value), "unit": field.unit}
    if field.kind == "series":
        return _value(np.asarray(value, dtype=float), setup.print_unit(field.name))
    return _value(value, setup.print_unit(field.name))


def _as_stated(setup: Setup, name: str, value: Any) -> dict[str, Any]:
    """Return a value once more in the unit in which it is stated, where that is not the one that is printed."""
    unit = setup.source.units.get(name, "")
    if not unit or unit_text(unit) == unit_text(setup.print_unit(name)):
        return {}
    numbers = np.asarray(from_si(np.asarray(value, dtype=float), unit))
    return {"stated": {"value": clean(np.vectorize(_rounded)(numbers)), "unit": unit}}


def _rounded(number: float) -> float:
    """Free a number of what its way through SI has left: 63 lbf·ft and not 63.00000000000001."""
    return float(f"{number:.{STATED_DIGITS}g}")


def _tolerances(setup: Setup) -> dict[str, Any]:
    said: dict[str, Any] = {}
    scattering = setup.distributions()
    for name in setup.model.tolerances:
        on = {}
        for target, distribution in scattering.get(name, {}).items():
            unit = setup.print_unit(target)
            sd = distribution.sd / unit_factor(difference_unit(unit))
            on[target] = {"mean": clean(from_si(distribution.mean, unit)), "sd": clean(sd), "unit": unit}
        said[name] = {"spread": setup.spread_of(name).text if on else "off", "on": on}
    return said


def _correlations(setup: Setup) -> dict[str, Any]:
    """Return by pair how inputs scatter together: the correlation of their normal scores, and that of their values."""
    return {
        f"{pair.first}, {pair.second}": {"value": pair.coefficient, "unit": "", "of_values": pair.of_values}
        for pair in scatter_of(setup).pairs
    }


def _effect_values(active: SwitchedOn) -> dict[str, Any]:
    said = {}
    for unknown in active.unknowns:
        value = _value(active.values[unknown.name], unknown.unit)
        sd = active.sds.get(unknown.name)
        if sd is not None:
            value["sd"] = clean(sd / unit_factor(difference_unit(unknown.unit)))
        said[unknown.name] = value
    return said


def _result(calculation: Calculation, name: str) -> dict[str, Any]:
    value, unit = calculation.answers[name], calculation.setup.print_unit(name)
    if np.size(value) > LARGE:
        return {"value": None, "unit": unit, "array": name, "shape": list(np.shape(value))}
    (said,) = _values(calculation.setup, {name: value}, calculation.absent).values()
    return said
