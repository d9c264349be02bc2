"""Tables, words and figures by section of the sheet: each is there where its study ran."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from rv_gearing.capacity import Reserve
from rv_gearing.catalogue import MODULE, catalogue_table
from rv_gearing.drawn_groups import groups_figure, stresses_figure, window_words
from rv_gearing.drawn_look import Run, number
from rv_gearing.drawn_mesh import mesh_figure, meshing_of
from rv_gearing.drawn_safeties import AXES, safeties_figure
from rv_gearing.drawn_tooth import notched_of, root_figure
from rv_gearing.search import MEETING, SIZES, STRENGTH, Column, Found, printed_in
from truing import Block, Drawing, Swept, Table, Words

HEADS = {
    "deviation": "deviation", "torque": "output torque", "centre_distance": "centre distance",
    "circle_low": "pin circle from", "circle_high": "to", "root_stress_sun": "root, sun",
    "root_stress_planet": "root, planet", "contact_stress_sun": "contact, sun",
    "contact_stress_planet": "contact, planet", "root_safety_sun": "breakage, sun",
    "root_safety_planet": "breakage, planet", "contact_safety_sun": "pitting, sun",
    "contact_safety_planet": "pitting, planet", "common_first": "common factor, sun and planet",
    "common_second": "disc and pins", "planet_kinds": "kinds of planet", "mesh_phases": "phases",
}  # fmt: skip
DIGITS: dict[Column, int] = {"ratio": 4, "deviation": 3, "torque": 2, "centre_distance": 3, "circle_low": 2,
                             "circle_high": 2}  # fmt: skip


def search(record: "Run") -> "Sequence[Block]":
    """All groups as a table, where they lie in the window, and the catalogue beside them."""
    found = record.outcome(Found)
    if found is None:
        return []
    if not found.count:
        words = (
            "No group of tooth numbers meets all five conditions: widen ratio_tolerance, the range of pins or the "
            "window, or change the module. What is rated below are the stated teeth."
        )
        return [Words(words, "warning"), *_catalogue(found)]
    order = f" Sorted by {found.sort_by.replace('_', ' ')}{', the largest first' if found.descending else ''}."
    table = _table(found, "Groups of tooth numbers", SIZES, _rated_words(found) + order)
    if not len(found.groups):
        return [Words("None of the groups has just the wanted ratio.", "warning"), *_catalogue(found)]
    caption = "Every group by its number. Both dashed pairs are limits: of the ratio and of the centre distance."
    return [
        table,
        _preferred(found),
        Words(window_words(found)),
        Drawing("Groups in their window", partial(groups_figure, found), caption),
        *_catalogue(found),
    ]


def _catalogue(found: Found) -> "list[Block]":
    """The catalogue of the example's size, beside stages of its module."""
    same = np.isclose(float(found.inputs.module), MODULE) and float(found.inputs.helix_angle) == 0.0
    return [catalogue_table(found.inputs)] if same else []


def _rated_words(found: Found) -> str:
    if found.rated is None:
        return "The teeth that are rated are stated, and in none of these groups."
    return f"Rated below: no. {found.rated}."


def _table(found: Found, title: str, columns: Sequence[Column], note: str) -> Table:
    """Some columns of the list, with the number of the group in front."""
    named: tuple[Column, ...] = ("group", *columns)
    values = [np.asarray(found.column(name)) * printed_in(name)[1] for name in named]
    digits = [DIGITS.get(name) for name in named]
    rows = [
        tuple(_cell(value, places) for value, places in zip(row, digits, strict=True))
        for row in zip(*values, strict=True)
    ]
    heads = tuple({"group": "no."}.get(name, HEADS.get(name, name)) for name in named)
    return Table(title, heads, rows, tuple(printed_in(name)[0] for name in named), note)


def _preferred(found: Found) -> Table:
    """Common factors, assembly and sharing of every group, with its preference and the reason."""
    of = f"{found.inputs.planets} planet{'s' if found.inputs.planets > 1 else ''}"
    note = (
        f"For {of} at equal spacing. Common factor 1: hunting teeth, so that every tooth meets every other and errors "
        "spread. Phase 1: planets mesh in phase and carry alike at any moment. Kinds: planets that differ by the angle "
        'of their teeth on the crank. sort_by = "preference" lists the better groups first.'
    )
    table = _table(found, "Which groups are better", ("sun", "planet", *MEETING), note)
    rows = [(*row, reason) for row, reason in zip(table.rows, found.reasons(), strict=True)]
    return replace(table, columns=(*table.columns, "reason"), rows=rows, units=(*table.units, ""))


def _cell(value: float, places: int | None) -> float | None:
    if not np.isfinite(value):
        return None
    return round(float(value), places) if places is not None else float(value)


def geometry(record: "Run") -> "Sequence[Block]":
    """The gears and their mesh to scale."""
    caption = (
        "Left the stage, the circle of the crank shafts dashed; right the mesh in its transverse section, both teeth "
        "as their rack generates them. A to E: path of contact, in single contact between B and D; C: pitch point. "
        "Dotted: base circles; chain lines: pitch circles."
    )
    meshing = meshing_of(record, record.acting)
    return [Drawing("Sun and planets, and one mesh", partial(mesh_figure, meshing), caption)]


def bending(record: "Run") -> "Sequence[Block]":
    """The critical sections of both teeth."""
    caption = (
        "Normal section. Tangents at 30° touch the fillets at the ends of the chord. The force at the tip meets the "
        "axis of the tooth at the height of its arm; grey: the force at the outer point of single contact, for "
        "method B."
    )
    teeth = notched_of(record, record.acting)
    return [Drawing("Critical sections of the teeth", partial(root_figure, teeth), caption)]


def method_b(record: "Run") -> "Sequence[Block]":
    """Say that the two conventions do not mix."""
    tip, outer = number(record, "root_safety"), number(record, "root_safety_outer")
    return [
        Words(
            f"Least safety with the load at the tip {tip:.3f}, with that at the outer point of single contact "
            f"{outer:.3f}. These are two conventions, each with its own form factor, stress correction and contact "
            "ratio factor; a factor of one must not be used with those of the other. The first is the paper's and is "
            "the one that is checked."
        )
    ]


def comparison(record: "Run") -> "Sequence[Block]":
    """Stresses and safeties of all groups."""
    found = record.outcome(Found)
    if found is None or not len(found.groups) or not any(np.isfinite(found.strength[name]).any() for name in STRENGTH):
        return []
    note = "Under the power or torque of the run, with the same face width, material and factors. " + _rated_words(
        found
    )
    caption = "What is permitted differs a little from group to group, by cycles, speed and notch."
    return [
        Drawing("Stresses of all groups", partial(stresses_figure, found), caption),
        _table(found, "Strength of all groups", ("sun", "planet", *STRENGTH), note),
    ]


def courses(record: "Run") -> "Sequence[Block]":
    """The safeties along what was swept, one figure for each sweep."""
    blocks: list[Block] = []
    for swept in record.studies.values():
        if not isinstance(swept, Swept):
            continue
        over = AXES.get(swept.over, (swept.over.replace("_", " "), 1.0))[0].split(",")[0]
        here = _here(record, swept.over)
        caption = "Dotted: what is asked of each. Breakage goes with the load, pitting with its square root."
        title = f"Safeties over the {over}"
        blocks.append(Drawing(title, partial(safeties_figure, swept, here), caption if not blocks else ""))
    reserve = record.outcome(Reserve)
    if reserve is not None and np.isfinite(reserve.torque).any():
        torque = float(np.min(reserve.torque))
        words = f"{reserve.governing[0].upper()}{reserve.governing[1:]} comes first, at {torque:.1f} N m at the output."
        blocks.append(Words(words))
    return blocks


def _here(record: "Run", over: str) -> float:
    """Where the run itself lies along an input."""
    if over == "load_torque":
        return number(record, "output_torque")
    value = getattr(record.acting, over, np.nan)
    return float(value) if np.ndim(value) == 0 else float("nan")
