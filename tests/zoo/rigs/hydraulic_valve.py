"""A spool valve on a bench: the spool hangs in seals that stick, slip and give, and is followed in small steps.

Five elements of friction, each a spring that slips at a force of its own, hold the spool against the spring of the
magnet. A worn land leaks through a gap in which part of the loss is laminar and part is that of an orifice.
"""

from dataclasses import dataclass

import numpy as np

from zoo.zoo import Array, Columns, drawn_size, hideable, sized

HIDDEN = hideable(friction="spool_friction", leak="worn_land")
NOISE = 0.6
"""Standard deviation of the flow meter, l/min."""
EDGE, STROKE, DENSITY = 20e-3, 1e-3, 860.0
ELEMENTS = np.array([0.8, 0.9, 1.0, 1.1, 1.2])
"""Forces at which the elements of friction slip, relative to their mean; each bears an equal part."""
GIVE = 0.06
"""How far the seals give before they slip, as a share of what friction can hold back."""
FINEST = 0.03
"""Longest step of the command while the spool is followed, V."""
ORIFICE = 0.15
"""Share of the loss of pressure of a worn land that is that of an orifice, at 70 bar."""
TURBULENT = 0.002
"""Opening over stroke below which the jet at an edge is not quite turbulent."""


@dataclass(frozen=True)
class Run:
    """How it is driven: time in s, command in V, loss of pressure in Pa; each of shape (rows,)."""

    time: Array
    command: Array
    loss: Array


def followed(command: Array, width: float) -> Array:
    """Where the spool stands, in V: seals that can hold back ``width`` in all stretch, then slip, from rest at 0."""
    if width == 0:
        return command.copy()
    most = width * ELEMENTS / np.sum(ELEMENTS)
    stiff = most / (GIVE * width)
    spool, before, held, places = 0.0, 0.0, np.zeros(len(ELEMENTS)), []
    for target in command.tolist():
        steps = max(1, int(np.ceil(abs(target - before) / FINEST)))
        for pull in np.linspace(before, target, steps + 1)[1:].tolist():
            holding = np.abs(held) < most * (1 - 1e-12)
            lacking = pull - spool - float(np.sum(held))
            move = lacking / (1 + float(np.sum(stiff[holding | (held * lacking < 0)])))
            spool, held = spool + move, np.clip(held + stiff * move, -most, most)
        before = target
        places.append(spool)
    return np.array(places)


def leaking(loss: Array, rated: float) -> Array:
    """Flow in l/min of a worn land, rated at 70 bar: laminar part and orifice part make the loss (Newton's method)."""
    if rated == 0:
        return np.zeros(len(loss))
    flow = rated * loss / 7e6
    for _ in range(20):
        missed = (1 - ORIFICE) * 7e6 * flow / rated + ORIFICE * 7e6 * (flow / rated) ** 2 - loss
        flow = flow - missed / ((1 - ORIFICE) * 7e6 / rated + 2 * ORIFICE * 7e6 * flow / rated**2)
    return np.asarray(flow)


def flow(run: Run, machine: tuple[float, float], width: float, leak: float) -> Array:
    """Flow to port A in l/min of a machine (discharge coefficient, null bias in V) with friction in V and a leak."""
    discharge, bias = machine
    opening = (followed(run.command, width) - bias) / 10
    sharp = discharge * np.abs(opening) / (np.abs(opening) + TURBULENT)
    jet = sharp * EDGE * STROKE * opening * np.sqrt(2 * run.loss / DENSITY)
    return np.asarray(6e4 * jet + leaking(run.loss, leak))


def programme(generator: np.random.Generator, rows: int) -> Run:
    """Slow ramps of the command, to and fro between changing peaks, at a pressure that the pump lets wander."""
    peaks = np.append(0.0, generator.uniform(5, 9.5, 8) * np.tile([1.0, -1.0], 4))
    length = np.append(0.0, np.cumsum(np.abs(np.diff(peaks))))
    command = np.interp(np.linspace(0, length[-1], rows), length, peaks)
    time = np.linspace(0, 4 * length[-1], rows)
    swing = np.sin(2 * np.pi * time / generator.uniform(90, 170) + generator.uniform(0, 6))
    return Run(time, command, np.asarray(1e5 * (65 + 25 * swing + generator.normal(0, 2, rows))))


def measure(hidden: str | None, generator: np.random.Generator, rows: int) -> Columns:
    """Four loops of the command within some minutes: what the flow meter would show without noise."""
    machine = (generator.normal(0.65, 0.013), generator.normal(0, 0.05))
    run = programme(generator, rows)
    plain = flow(run, machine, 0.0, 0.0)
    width = leak = 0.0
    if hidden in ("friction", "friction_and_leak"):
        size = drawn_size(generator) * NOISE
        width = sized(lambda held: flow(run, machine, held, 0.0), plain, size, 3.0, low=0.01, rtol=1e-2)
    if hidden in ("leak", "friction_and_leak"):
        leak = drawn_size(generator) * NOISE * 7e6 / float(np.max(run.loss))
    return {
        "time [s]": run.time,
        "command [V]": run.command,
        "pressure_loss [bar]": run.loss / 1e5,
        "flow [l/min]": flow(run, machine, width, leak),
    }
