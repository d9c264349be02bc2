"""Slow runs up and down through the speeds: steady vibration at each, jumps, hysteresis, impacts on both flanks.

A record in time would have to settle at every speed, some 10 000 turns of the mesh for a run: seconds of calculation,
where a search for a cause asks a thousand times. So the periodic motions are found by harmonic balance, of all
machines of a batch at once, along the curve that connects them; the record in time is another model and checks this
one.
"""

from dataclasses import dataclass

import numpy as np

from harmonic_fractal import vibration_response as response
from harmonic_fractal.vibration import GearPair, Mesh, mesh_quantities
from truing import Array, Float, axis, column, feasible, found, given, inputs, results

SLOWEST = 0.97
"""Where the curve begins, in parts of the lowest speed, or of one at which the flanks do not part."""
BEYOND = 1.05
"""Where it ends, in parts of the highest speed, or of the natural frequency where that is higher."""


@inputs
class RunUp(GearPair):
    """A gear pair that is run slowly up through some speeds and down again."""

    speeds: Float = given(tuple(float(speed) for speed in range(2500, 6001, 250)), "rpm", along="speed", symbol="n",
                          note="speeds of the wave generator at which the vibration is looked at, rising")  # fmt: skip


@results
class Response(Mesh):
    """The steady vibration over the speed, on the way up and on the way down."""

    speed: Float = axis("rpm", symbol="n", note="speed of the wave generator", follows="speeds")
    mesh_frequency: Float = found("Hz", symbol="f", note="of the mesh", along="speed", formula="order * speed")
    amplitude_up: Float = found("um", symbol="y_up", note="half the height of the transmission error, on the way up",
                                along="speed", method="harmonic balance")  # fmt: skip
    amplitude_down: Float = found("um", symbol="y_dn", note="the same on the way down", along="speed",
                                  method="harmonic balance")  # fmt: skip
    force_up: Float = found("N", symbol="F_up", note="largest elastic force of the mesh, on the way up", along="speed",
                            method="stiffness times backlash function")  # fmt: skip
    force_down: Float = found("N", symbol="F_dn", note="the same on the way down", along="speed",
                              method="stiffness times backlash function")  # fmt: skip
    impacts_up: Float = found("", symbol="s_up", note="flanks that are hit, on the way up: 0 without loss of contact, "
                              "1 the driving ones, 2 both", along="speed", digits=1, method="least deflection of the "
                              "mesh against the clearance")  # fmt: skip
    impacts_down: Float = found("", symbol="s_dn", note="the same on the way down", along="speed", digits=1,
                                method="least deflection of the mesh against the clearance")  # fmt: skip
    multiplier_up: Float = found("", symbol="mu_up", note="largest Floquet multiplier, on the way up; above 1 the "
                                 "vibration does not repeat with every mesh", along="speed",
                                 method="product of the transitions over a period")  # fmt: skip
    multiplier_down: Float = found("", symbol="mu_dn", note="the same on the way down", along="speed",
                                   method="product of the transitions over a period")  # fmt: skip
    largest_amplitude: Float = found(
        "um", symbol="y_max", note="largest of both runs", method="of the speeds stated", key=True
    )
    largest_force: Float = found(
        "N", symbol="F_max", note="largest of both runs", method="of the speeds stated", key=True
    )
    most_impacts: Float = found("", symbol="s_max", note="most flanks that are hit in either run", digits=1,
                                method="of the speeds stated", key=True)  # fmt: skip
    jump_up: Float = found("rpm", symbol="n_up", note="speed of the largest jump on the way up",
                           method="where the curve of all motions turns back", key=True)  # fmt: skip
    jump_down: Float = found("rpm", symbol="n_dn", note="speed of the largest jump on the way down",
                             method="where the curve of all motions turns back", key=True)  # fmt: skip
    hysteresis: Float = found("rpm", symbol="n_h", note="speeds between the two jumps", formula="jump_up - jump_down")


ALONG = tuple(f"{name}_{way}" for name in ("amplitude", "force", "impacts", "multiplier") for way in ("up", "down"))
BLOCK = 128
"""Machines at a time, so that memory stays flat."""


@dataclass(frozen=True)
class Runs:
    """Both runs of n machines: frequency ratios (n, k), and the curve behind them."""

    machines: response.Oscillators
    ratio: Array
    curve: response.Curve
    up: response.Run
    down: response.Run


def runs_of(machines: response.Oscillators, ratio: Array) -> Runs:
    """Return the runs of machines (n,) through frequency ratios (n, k)."""
    calm = response.still_in_contact(machines)
    first = SLOWEST * np.where(calm > 0.0, np.minimum(ratio[:, 0], calm), ratio[:, 0])
    curve = response.traced(machines, first, BEYOND * np.maximum(ratio[:, -1], 1.0))
    up, down = (response.run(machines, curve, ratio, down=way) for way in (False, True))
    return Runs(machines, ratio, curve, up, down)


def oscillators_of(pair: GearPair, mesh: dict[str, Float], count: int) -> tuple[response.Oscillators, Array]:
    """Return the machines without dimension, and their scale of length (n,), m: clearance and static deflection."""
    scale = each_of(mesh["clearance"] + mesh["deflection"], count)
    force = each_of(mesh["mesh_stiffness"], count) * scale
    machines = response.Oscillators(
        clearance=each_of(mesh["clearance"], count) / scale,
        mean=each_of(mesh["mean_force"], count) / force,
        force=each_of(mesh["wave_force"], count) / force,
        error=each_of(pair.error_amplitude, count) / scale,
        damping=each_of(mesh["damping"], count),
        variation=each_of(pair.stiffness_variation, count),
    )
    return machines, scale


def each_of(value: Float, count: int) -> Array:
    """Return a value for each of so many machines, (n,)."""
    return np.array(np.broadcast_to(value, (count,)), dtype=float)


def transmission_error(machines: response.Oscillators, harmonics: Array) -> Array:
    """Return the harmonics of y from those of the deflection of the mesh, y - e."""
    whole = harmonics.copy()
    whole[..., 1] += machines.error[:, np.newaxis]
    return whole


def answers(machines: response.Oscillators, ratio: Array) -> dict[str, Array]:
    """Return what is seen of both runs without dimension, (n, k) and (n,), by the names of the results."""
    runs, gap = runs_of(machines, ratio), machines.clearance[:, np.newaxis]
    values: dict[str, Array] = {"is_whole": np.asarray(runs.curve.is_whole, dtype=float)}
    values |= {"jump_up": runs.up.jump, "jump_down": runs.down.jump}
    for way, harmonics in (("up", runs.up.harmonics), ("down", runs.down.harmonics)):
        x = response.motion_of(harmonics)
        error = response.motion_of(transmission_error(machines, harmonics))
        touching = response.stiffness_wave(machines) * response.backlash(x, gap[:, :, np.newaxis])
        lowest = x.min(axis=-1)
        values |= {
            f"amplitude_{way}": np.ptp(error, axis=-1) / 2.0,
            f"force_{way}": touching.max(axis=-1),
            f"impacts_{way}": np.where(lowest < -gap, 2.0, np.where(lowest < gap, 1.0, 0.0)),
            f"multiplier_{way}": response.largest_multiplier(machines, harmonics, ratio),
        }
    return values


def in_blocks(machines: response.Oscillators, ratio: Array) -> dict[str, Array]:
    """Return what ``answers`` does, block by block of machines; NaN for one that is none, without stiffness say."""
    numbers = np.column_stack([*vars(machines).values(), ratio])
    rows = np.flatnonzero(np.isfinite(numbers).all(axis=1))
    blocks = np.split(rows, range(BLOCK, len(rows), BLOCK))
    parts = [answers(machines.part(block), ratio[block]) for block in blocks if len(block)]
    if not parts:
        return {name: np.full(len(ratio), np.nan) for name in ("is_whole", "jump_up", "jump_down")} | {
            name: np.full(ratio.shape, np.nan) for name in ALONG
        }
    values = {}
    for name in parts[0]:
        found = np.concatenate([part[name] for part in parts])
        values[name] = np.full((len(ratio), *found.shape[1:]), np.nan)
        values[name][rows] = found
    return values


def run_up(pair: RunUp) -> Response:
    """One gear pair or a batch of them; every Float is a number or an array (n,), SI."""
    rising = bool(np.all(np.diff(pair.speeds) > 0.0) and np.all(np.asarray(pair.speeds) > 0.0))
    feasible(rising, "the speeds of a run are above 0 and rise from one to the next")
    mesh = mesh_quantities(pair)
    numbers = (*mesh.values(), pair.error_amplitude, pair.stiffness_variation)
    sizes = [np.size(value) for value in numbers if np.ndim(value)]
    count, own = max(sizes, default=1), slice(None) if sizes else 0
    machines, scale = oscillators_of(pair, mesh, count)
    resonance, force = each_of(mesh["resonance_speed"], count), each_of(mesh["mesh_stiffness"], count) * scale
    shown = in_blocks(machines, np.asarray(pair.speeds, dtype=float) / resonance[:, np.newaxis])
    feasible(
        shown.pop("is_whole")[own] > 0.0,
        "the curve of the vibration over the speed cannot be followed to its end: raise damping_ratio, or leave out "
        "the lowest speeds",
    )
    units = {"amplitude": column(scale), "force": column(force), "jump": resonance}
    values = {name: (units.get(name.partition("_")[0], 1.0) * value)[own] for name, value in shown.items()}
    for name in ("jump_up", "jump_down"):
        feasible(np.isfinite(values[name]), "the curve of the vibration does not turn back: there is no jump",
                 only=(name, "hysteresis"))  # fmt: skip
    return Response(
        **mesh, **values,
        speed=pair.speeds,
        mesh_frequency=column(np.asarray(mesh["order"])) * pair.speeds,
        hysteresis=values["jump_up"] - values["jump_down"],
        largest_amplitude=_largest(values, "amplitude"),
        largest_force=_largest(values, "force"),
        most_impacts=_largest(values, "impacts"),
    )  # fmt: skip


def _largest(values: dict[str, Array], name: str) -> Array:
    return np.asarray(np.maximum(values[f"{name}_up"].max(axis=-1), values[f"{name}_down"].max(axis=-1)))
