"""How the outcome of an allocation is written: results.json and the sheet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from truing.declare.blocks import Block, Drawing, Table, Words
from truing.studies.demands import as_number, wilson
from truing.studies.reading import printed_step, spoken
from truing.studies.sampling import Tally
from truing.studies.strips import Strip
from truing.studies.synthesis import Plan

if TYPE_CHECKING:
    from truing.studies.allocation import Allotted


def allotted_json(allotted: Allotted) -> dict[str, Any]:
    """Return what results.json holds; widths in mm."""
    return {
        "steps": [
            {
                "number": step.number,
                "tolerance": step.tolerance,
                "from": step.before,
                "to": step.after,
                "width": {"from": _mm(step.width_before), "to": _mm(step.width_after), "unit": "mm"},
                "probabilities": dict(step.chances),
            }
            for step in allotted.steps
        ],
        **_design(allotted, allotted.rule, "rule"),
        "adjustments": allotted.adjustments,
        "start": _start(allotted),
        "coefficients": {name: as_number(value) for name, value in allotted.coefficients.items()},
        "finest": allotted.finest,
        "least_cost": {"steps": allotted.least_steps, **_design(allotted, allotted.least, "least")},
    }


def _start(allotted: Allotted) -> dict[str, Any]:
    start = allotted.shop.start
    plan = Plan(start, allotted.shop.cost(start), allotted.start, allotted.shop.reached(start))
    return _design(allotted, plan, "start")


def _design(allotted: Allotted, plan: Plan, key: str) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "tolerances": dict(allotted.texts.get(key, plan.grades)),
        "cost": {"value": plan.cost, "unit": allotted.shop.unit},
        "reached": plan.reached,
        "probabilities": dict(plan.chances),
    }
    if plan.status:
        entry["status"] = plan.status
    if allotted.shop.strips:
        entry["widths"] = {strip.name: _width(strip, plan) for strip in allotted.shop.strips.values()}
    if key in allotted.sampled:
        entry["monte_carlo"] = _sampled(allotted.sampled[key])
    return entry


def _width(strip: Strip, plan: Plan) -> dict[str, Any]:
    width = plan.widths.get(strip.name, strip.start)
    return {
        "from": printed_step(strip.start, strip.unit),
        "to": printed_step(width, strip.unit),
        "unit": strip.unit,
        "price": {"from": strip.cost(strip.start), "to": strip.cost(width), "unit": strip.price.unit},
    }


def _sampled(tally: Tally) -> dict[str, Any]:
    return {
        name: {
            "probability": float(hits / tally.draws),
            "interval95": list(wilson(hits, tally.draws)),
            "draws": tally.draws,
            "failed": tally.failed,
        }
        for name, hits in tally.hits.items()
    }


def _mm(width: float) -> float:
    from truing.units import from_si

    return float(from_si(width, "mm"))


def allotted_blocks(allotted: Allotted) -> Sequence[Block]:
    """Return the steps, rule against least cost, and the probabilities along the synthesis."""
    blocks: list[Block] = []
    if not allotted.reached:
        far = " and ".join(f"{spoken(name)} {100 * value:.2f} %" for name, value in allotted.final.items())
        blocks.append(Words(f"The goal is {allotted.rule.status}. It comes to {far}.", "finding"))
    if allotted.shop.parts:
        blocks.append(_steps(allotted))
    blocks.append(_comparison(allotted))
    if allotted.shop.parts:
        blocks.append(_grades(allotted))
    if allotted.shop.strips:
        blocks += [_widths(allotted, what, plan) for what, plan in allotted.spoken.values()]
    if allotted.steps:
        blocks.append(Drawing("Probability along the synthesis", _drawn(allotted)))
    return blocks


def _steps(allotted: Allotted) -> Table:
    names = list(allotted.start)
    rows: list[list[Any]] = [[0, "start", None, None, None, *(100 * value for value in allotted.start.values())]]
    for step in allotted.steps:
        grades = f"{step.before} to {step.after}"
        widths = (_mm(step.width_before), _mm(step.width_after))
        rows.append([step.number, step.tolerance, grades, *widths, *(100 * step.chances[name] for name in names)])
    columns = ("step", "tolerance", "grade", "width before", "width after", *names)
    units = ("", "", "", "mm", "mm", *("%" for _ in names))
    return Table("Synthesis grade by grade", columns, rows, units, "First-order probabilities after each step.")


def _comparison(allotted: Allotted) -> Table:
    names = list(allotted.start)
    shop = allotted.shop
    start = Plan(shop.start, shop.cost(shop.start), allotted.start, shop.reached(shop.start))
    designs: Mapping[str, tuple[Plan, str, int]] = {
        "start": (start, "start", 0),
        **({"rule": (allotted.rule, "rule", allotted.adjustments)} if shop.parts else {}),
        "least cost": (allotted.least, "least", allotted.least_steps),
    }
    rows: list[list[Any]] = []
    for title, (plan, key, steps) in designs.items():
        sampled = allotted.monte_carlo.get(key, {})
        chances = [value for name in names for value in (100 * plan.chances[name], _percent(sampled.get(name)))]
        rows.append([title, *([steps] if shop.parts else []), plan.cost, *chances, plan.reached])
    pairs = [column for name in names for column in (name, "Monte Carlo")]
    unit = shop.unit
    note = (
        "Cost: the sum of the prices of the tolerances, each paid once however many inputs it is on."
        if shop.priced
        else "Cost: the sum of 1/width over the tolerances, the reciprocal law; not every one has a price."
    )
    note += f" First order beside {_drawn_words(allotted)}" if allotted.sampled else ""
    counted = ("grades",) if shop.parts else ()
    columns = ("design", *counted, "cost", *pairs, "reached")
    units = ("", *("" for _ in counted), unit, *("%" for _ in pairs), "")
    title = "Rule against least cost" if shop.parts else "In force and at least cost"
    return Table(title, columns, rows, units, note)


def _drawn_words(allotted: Allotted) -> str:
    """Say how many machines of each design were drawn, and how far their shares may be off."""
    half = max(
        (high - low) / 2
        for tally in allotted.sampled.values()
        for low, high in (wilson(hits, tally.draws) for hits in tally.hits.values())
    )
    draws = max(tally.draws for tally in allotted.sampled.values())
    within = f"95 % intervals within ±{100 * half:.2g} percentage points"
    return f"{draws} machines of each design on the exact model, {within}."


def _percent(value: float | None) -> float | None:
    return None if value is None else 100 * value


def _grades(allotted: Allotted) -> Table:
    rows = [
        [
            name,
            as_number(allotted.coefficients[name]),
            part.start,
            allotted.rule.grades[name],
            allotted.least.grades[name],
        ]
        for name, part in sorted(allotted.shop.parts.items(), key=lambda item: allotted.coefficients[item[0]])
    ]
    return Table("Grades", ("tolerance", "coefficient", "start", "rule", "least cost"), rows)


def _widths(allotted: Allotted, what: str, plan: Plan) -> Table:
    """Say what became of every width that has a price."""
    from truing.units import unit_text

    rows: list[list[Any]] = []
    for strip in allotted.shop.strips.values():
        width = plan.widths.get(strip.name, strip.start)
        ends = {strip.low: "tightest", strip.high: "widest"}
        at_end = next((word for end, word in ends.items() if abs(width / end - 1) < 1e-6), "")
        pair = [printed_step(one, strip.unit) for one in (strip.start, width)]
        prices = [strip.cost(strip.start), strip.cost(width)]
        rows.append([strip.name, unit_text(strip.unit), *pair, width / strip.start, *prices, at_end])
    unit = allotted.shop.unit
    columns = ("tolerance", "unit", "in force", "bought", "times", "price in force", "price", "at the end")
    note = "Full widths. Those at an end would go further if tightest and widest allowed it."
    return Table(what[:1].upper() + what[1:], columns, rows, ("", "", "", "", "", unit, unit, ""), note)


def _drawn(allotted: Allotted) -> Any:
    from truing.studies.drawings import lines

    names = list(allotted.start)
    series = {name: [allotted.start[name], *(step.chances[name] for step in allotted.steps)] for name in names}
    goals = {demand.name: demand.goal for demand in allotted.shop.demands if demand.goal is not None}
    return lines(range(len(allotted.steps) + 1), series, ("step", "probability"), goals)
