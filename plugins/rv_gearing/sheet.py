"""The sheet, in the order in which an engineer rates a stage; a figure or table is there where its study ran."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from rv_gearing import figures, groups, load_factors
from rv_gearing.flank import FlankState
from rv_gearing.material import Steel
from rv_gearing.rating import Reserve
from rv_gearing.second_stage import SecondStage
from truing import Block, Drawing, Section, Swept, Table, Words

# Tables, words and figures by section of the sheet: each is there where its study ran

HEADS = {
    "deviation": "deviation", "torque": "output torque", "centre_distance": "centre distance",
    "circle_low": "pin circle from", "circle_high": "to", "root_stress_sun": "root, sun",
    "root_stress_planet": "root, planet", "contact_stress_sun": "contact, sun",
    "contact_stress_planet": "contact, planet", "root_safety_sun": "breakage, sun",
    "root_safety_planet": "breakage, planet", "contact_safety_sun": "pitting, sun",
    "contact_safety_planet": "pitting, planet", "common_first": "common factor, sun and planet",
    "common_second": "disc and pins", "planet_kinds": "kinds of planet", "mesh_phases": "phases",
    "efficiency": "efficiency", "reserve": "least safety over asked", "from_best": "from best",
}  # fmt: skip
FRONT = "Filled: no other group is as good in all criteria and better in one. Dashed: what is asked of the safeties."
HEAT = "Blue: heat of one pair of teeth over the gears' own temperature, dotted its mean. Dashed: the pitch point."
MOST_SHOWN = 20  # groups of the front
DIGITS: dict[groups.GroupColumn, int] = {"ratio": 4, "deviation": 3, "torque": 2, "centre_distance": 3, "circle_low": 2,
                             "circle_high": 2, "efficiency": 3, "reserve": 4, "from_best": 3}  # fmt: skip


def search(record: figures.GearingRun) -> "Sequence[Block]":
    """All groups as a table, where they lie in the window, and the catalogue beside them."""
    found = record.outcome(groups.FoundGroups)
    if found is None:
        return []
    if not found.count:
        words = (
            "No group of tooth numbers meets all five conditions: widen ratio_tolerance, the range of pins or the "
            "window, or change the module. What is rated below are the stated teeth."
        )
        return [Words(words, "warning"), *_catalogue(found)]
    order = f" Sorted by {found.sort_by.replace('_', ' ')}{', the largest first' if found.descending else ''}."
    table = _table(found, "Groups of tooth numbers", groups.SIZES, _rated_words(found) + order)
    if not len(found.groups):
        return [Words("None of the groups has just the wanted ratio.", "warning"), *_catalogue(found)]
    caption = "Every group by its number. Both dashed pairs are limits: of the ratio and of the centre distance."
    return [
        table,
        _preferred(found),
        Words(figures.window_words(found)),
        Drawing("Groups in their window", partial(figures.groups_figure, found), caption),
        _front(found),
        Drawing("Groups that no other beats, by size and strength", partial(figures.front_figure, found), FRONT),
        *_catalogue(found),
    ]


def _catalogue(found: groups.FoundGroups) -> "list[Block]":
    """The catalogue of the example's size, beside stages of its module."""
    same = np.isclose(float(found.inputs.module), groups.MODULE) and float(found.inputs.helix_angle) == 0.0
    return [groups.catalogue_table(found.inputs)] if same else []


def _rated_words(found: groups.FoundGroups) -> str:
    if found.rated is None:
        return "The teeth that are rated are stated, and in none of these groups."
    return f"Rated below: no. {found.rated}."


def _table(found: groups.FoundGroups, title: str, columns: Sequence[groups.GroupColumn], note: str) -> Table:
    """Some columns of the list, with the number of the group in front."""
    named: tuple[groups.GroupColumn, ...] = ("group", *columns)
    values = [np.asarray(found.column(name)) * groups.printed_in(name)[1] for name in named]
    digits = [DIGITS.get(name) for name in named]
    rows = [
        tuple(_cell(value, places) for value, places in zip(row, digits, strict=True))
        for row in zip(*values, strict=True)
    ]
    heads = tuple({"group": "no."}.get(name, HEADS.get(name, name)) for name in named)
    return Table(title, heads, rows, tuple(groups.printed_in(name)[0] for name in named), note)


def _preferred(found: groups.FoundGroups) -> Table:
    """Common factors, assembly and sharing of every group, with its preference and the reason."""
    of = f"{found.inputs.planets} planet{'s' if found.inputs.planets > 1 else ''}"
    note = (
        f"For {of} at equal spacing. Common factor 1: hunting teeth, so that every tooth meets every other and errors "
        "spread. Phase 1: planets mesh in phase and carry alike at any moment. Kinds: planets that differ by the angle "
        'of their teeth on the crank. sort_by = "preference" lists the better groups first.'
    )
    table = _table(found, "Which groups are better", ("sun", "planet", *groups.MEETING), note)
    rows = [(*row, reason) for row, reason in zip(table.rows, found.reasons(), strict=True)]
    return replace(table, columns=(*table.columns, "reason"), rows=rows, units=(*table.units, ""))


def _front(found: groups.FoundGroups) -> Table:
    """List the groups that no other beats in all criteria, the one nearest to the best of all first."""
    distance = found.column("from_best")
    unbeaten = int(np.sum(np.isfinite(distance)))
    order = np.argsort(distance, kind="stable")[: min(unbeaten, MOST_SHOWN)]
    of = ", ".join(HEADS.get(name, name.replace("_", " ")) for name in found.criteria)
    note = (
        f"{unbeaten} of {len(distance)} groups, {len(order)} shown: against each of these every other group is worse "
        f"in one of {of}, or no better in any. First the one nearest to the best of all at once, each criterion from "
        '0 to 1 over these groups; your own need may weigh them otherwise: [studies.search] criteria = ["deviation", '
        '"reserve"]. A size, safety or ratio that differs by less than matters counts as equal.'
    )
    some = replace(found, groups=found.groups.at(order), numbers=found.numbers[order],
                   strength={name: values[order] for name, values in found.strength.items()})  # fmt: skip
    columns = tuple(name for name in found.criteria if name not in ("sun", "planet"))
    table = _table(some, "Groups that no other beats", ("sun", "planet", *columns), note)
    rows = [(*row, _cell(distance[place], 3)) for row, place in zip(table.rows, order, strict=True)]
    return replace(table, columns=(*table.columns, HEADS["from_best"]), rows=rows, units=(*table.units, ""))


def _cell(value: float, places: int | None) -> float | None:
    if not np.isfinite(value):
        return None
    return round(float(value), places) if places is not None else float(value)


def geometry(record: figures.GearingRun) -> "Sequence[Block]":
    """The gears and their mesh to scale."""
    caption = (
        "Left the stage, the circle of the crank shafts dashed; right the mesh in its transverse section, both teeth "
        "as their rack generates them. A to E: path of contact, in single contact between B and D; C: pitch point. "
        "Dotted: base circles; chain lines: pitch circles."
    )
    meshing = figures.meshing_of(record, record.acting)
    return [Drawing("Sun and planets, and one mesh", partial(figures.mesh_figure, meshing), caption)]


def heat(record: figures.GearingRun) -> "Sequence[Block]":
    """The heat along the path of contact."""
    return [Drawing("Heat along the path of contact", partial(figures.heat_figure, record.acting), HEAT)]


def bending(record: figures.GearingRun) -> "Sequence[Block]":
    """The critical sections of both teeth."""
    caption = (
        "Normal section. Tangents at 30° touch the fillets at the ends of the chord. The force at the tip meets the "
        "axis of the tooth at the height of its arm; grey: the force at the outer point of single contact, for "
        "method B."
    )
    teeth = figures.notched_of(record, record.acting)
    return [Drawing("Critical sections of the teeth", partial(figures.root_figure, teeth), caption)]


def method_b(record: figures.GearingRun) -> "Sequence[Block]":
    """Say that the two conventions do not mix."""
    tip, outer = figures.number(record, "root_safety"), figures.number(record, "root_safety_outer")
    return [
        Words(
            f"Least safety with the load at the tip {tip:.3f}, with that at the outer point of single contact "
            f"{outer:.3f}. These are two conventions, each with its own form factor, stress correction and contact "
            "ratio factor; a factor of one must not be used with those of the other. The first is the paper's and is "
            "the one that is checked."
        )
    ]


def comparison(record: figures.GearingRun) -> "Sequence[Block]":
    """Stresses and safeties of all groups."""
    found = record.outcome(groups.FoundGroups)
    if found is None or not any(np.isfinite(found.strength[name]).any() for name in groups.STRENGTH):
        return []
    note = "Under the power or torque of the run, with the same face width, material and factors. " + _rated_words(
        found
    )
    caption = "What is permitted differs a little from group to group, by cycles, speed and notch."
    return [
        Drawing("Stresses of all groups", partial(figures.stresses_figure, found), caption),
        _table(found, "Strength of all groups", ("sun", "planet", *groups.STRENGTH), note),
    ]


def courses(record: figures.GearingRun) -> "Sequence[Block]":
    """The safeties along what was swept, one figure for each sweep."""
    blocks: list[Block] = []
    for swept in record.studies.values():
        if not isinstance(swept, Swept):
            continue
        over = figures.AXES.get(swept.over, (swept.over.replace("_", " "), 1.0))[0].split(",")[0]
        here = _here(record, swept.over)
        caption = "Dotted: what is asked of each. Breakage goes with the load, pitting with its square root."
        title = f"Safeties over the {over}"
        blocks.append(Drawing(title, partial(figures.safeties_figure, swept, here), caption if not blocks else ""))
    reserve = record.outcome(Reserve)
    if reserve is not None and np.isfinite(reserve.torque).any():
        torque = float(np.min(reserve.torque))
        words = f"{reserve.governing[0].upper()}{reserve.governing[1:]} comes first, at {torque:.1f} N m at the output."
        blocks.append(Words(words))
    return blocks


def _here(record: figures.GearingRun, over: str) -> float:
    """Where the run itself lies along an input."""
    if over == "load_torque":
        return figures.number(record, "output_torque")
    value = getattr(record.acting, over, np.nan)
    return float(value) if np.ndim(value) == 0 else float("nan")


def both(*names: str) -> tuple[str, ...]:
    """The results of sun and planet by name."""
    return tuple(chain.from_iterable((f"{name}_sun", f"{name}_planet") for name in names))


SECTIONS = [
    Section(
        "Ratio, efficiency and torque",
        *both("teeth"), "pins", "ratio", "pin_ratio", "mesh_efficiency", "efficiency", "sun_speed", "mesh_speed",
        "asked_torque", "sun_torque", "output_torque",
        text="A sun drives planets, each planet turns a crank, and the cranks drive cycloid discs in a ring of pins "
        "that stands still; the output is the carrier of the cranks. The mesh of sun and planet turns with it, so its "
        "speed is that of the sun relative to the carrier.",
    ),
    Section(
        "Search for tooth numbers",
        "group_count", "exact_count",
        text="Five conditions: the ratio within its tolerance; a sun that is not undercut; a planet large enough to "
        "spare the second stage; an even number of pins, one more than teeth of a disc; a centre distance between "
        "shares of the radius of the pin circle, which follows the cube root of the output torque (in N mm).",
        blocks=search,
    ),
    Section(
        "The list as results",
        *(name for name in groups.Listed.__dataclass_fields__ if name not in ("group_count", "exact_count")),
        level="full",
    ),
    Section(
        "Geometry of the pair",
        "tooth_ratio", "transverse_angle", "base_helix_angle", *both("reference_diameter", "base_diameter",
        "tip_diameter", "root_diameter"), "tight_angle", "tight_centre_distance", "centre_distance", "working_angle",
        "base_pitch", "curvature", *both("tip_angle"), "contact_ratio", "overlap_ratio", "total_contact_ratio",
        "tooth_height", *both("tip_thickness", "start_curvature", "form_diameter"), "backlash",
        blocks=geometry,
    ),
    Section(
        "Load of one mesh",
        "tangential_force", "pitch_line_velocity", "carrying_width", "line_load", "planet_factor",
        "planet_factor_bending",
        text="The torque of the sun, not that of the output, shared by the planets. A factor says by how much "
        "the worst of them carries more than its share.",
    ),
    Section(
        "Deviations of the teeth",
        *both("pitch_deviation", "profile_deviation", "helix_deviation", "pitch_running_in", "profile_running_in"),
        *load_factors.MeshQuality.__dataclass_fields__,
    ),
    Section(
        "Stiffness of the mesh",
        *load_factors.MeshStiffness.__dataclass_fields__,
    ),
    Section(
        "Dynamic factor",
        *load_factors.MeshDynamics.__dataclass_fields__,
        text="Method B of ISO 6336-1. A first stage runs far below the resonance of its mesh; what resonates in a "
        "reducer is its structure, which is not in this factor.",
    ),
    Section(
        "Face load factors",
        *load_factors.FaceLoad.__dataclass_fields__,
        text="Method C of ISO 6336-1. In small gears under a small load the deviations count for more than the load, "
        "and the factor becomes large. Where it was measured or calculated otherwise, state it: 1.1 to 1.3 is usual "
        "for crowned suns that align themselves.",
    ),
    Section(
        "Transverse load factors",
        *load_factors.Sharing.__dataclass_fields__,
    ),
    Section(
        "Contact stress",
        "zone_factor", "elasticity_factor", "contact_ratio_factor", "helix_power", "helix_factor",
        "single_contact_counts", "single_contact_factor_sun", "single_contact_factor_planet",
        "nominal_contact_stress", *both("contact_stress"), "contact_stress",
        text="At the inner point of single contact of each gear, by the factors of single contact; the paper leaves "
        "these out and has the stress at the pitch point (single_contact = false).",
    ),
    Section(
        "Root stress, load at the tip",
        *both("virtual_teeth"), "virtual_contact_ratio", *both("root_offset", "root_angle", "root_chord",
        "root_fillet", "notch_parameter", "virtual_tip_diameter", "virtual_base_diameter", "virtual_tip_angle",
        "tip_load_angle", "tip_arm", "form_factor", "stress_correction"), "contact_ratio_factor_bending",
        "helix_factor_bending", "tip_load_factor", *both("nominal_root_stress", "root_stress"),
        text="The convention of the paper, with the form factor, stress correction and contact ratio factor that "
        "belong to it.",
        blocks=bending,
    ),
    Section(
        "Root stress, load at the outer single contact",
        *both("outer_diameter", "outer_angle", "outer_load_angle", "outer_arm", "form_factor_outer",
               "stress_correction_outer"),
        "deep_tooth_factor", *both("nominal_root_stress_outer", "root_stress_outer", "root_safety_outer"),
        "root_safety_outer",
        text="Method B of ISO 6336-3, with a form factor and stress correction of its own and without a contact ratio "
        "factor, for comparison.",
        blocks=method_b,
    ),
    Section(
        "Constants of the material",
        *Steel.__dataclass_fields__,
        level="full",
    ),
    Section(
        "Permissible contact stress",
        "load_cycles_sun", "load_cycles_planet", *both("contact_life_factor"), "lubricant_constant",
        "lubricant_factor", "velocity_factor", "relative_roughness", "roughness_exponent", "roughness_factor",
        *both("permitted_contact_stress"),
    ),
    Section(
        "Permissible root stress",
        *both("bending_life_factor", "notch_sensitivity", "root_surface", "bending_size", "mean_stress_factor",
        "permitted_root_stress"),
        text="Planets of this stage mesh with the sun alone: their roots are not bent to both sides in every turn. "
        "But robots reverse: state how large the opposite load is, by the stress ratio of each gear.",
    ),
    Section(
        "Scuffing and micropitting",
        *FlankState.__dataclass_fields__,
        text="Flanks that slide heat one another; where the contact gets as hot as the lubricant bears in its test, "
        "they weld for a moment and scuff. The flash method takes the hottest point, the integral method a mean of the "
        "path: two readings of one risk, with one friction. Where the oil film is thin beside the roughness, flanks "
        "turn grey by micropitting; what the lubricant bears must come from its own test.",
        blocks=heat,
    ),
    Section(
        "Second stage and crank bearings",
        *SecondStage.__dataclass_fields__,
        text="Discs and pins without clearance: every force passes through the pitch point, so the pins of a disc push "
        "with one resultant that turns with the crank. A crank bearing gets its share of it, and its share of the "
        "torque, which stands in the disc; both meet once per turn. What clearance and wear change is the business "
        "of the calculation rv_wear.",
    ),
    Section(
        "Safeties",
        *both("contact_safety", "root_safety"), "contact_safety", "root_safety", "torque_capacity",
        "power_capacity",
        blocks=courses,
    ),
    Section(
        "Strength of all groups",
        text="Every group of the search under the same duty.",
        blocks=comparison,
    ),
    Section(
        "What effects act on",
        "transmission_error", "flank_temperature",
        text="Nothing by itself; what the calculation leaves out appears here once an effect is on.",
    ),
]  # fmt: skip
