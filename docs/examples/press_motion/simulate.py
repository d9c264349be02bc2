"""Torque of the cranks of a press from a program of its own: simulate.py writes slow.csv and fast.csv.

It shares nothing with the calculation. There are no joint forces in it: at every time it knows where all joints are and
how much energy the press has, and the drive gives what that energy gains and what the work takes.
"""

import csv
import itertools
import math
import random

CRANK, ROD, ARM, DRIVE, UPPER, LOWER = 0.36, 1.304, 0.6, 0.868, 1.7, 1.6
PIVOT, JOINT, HALF = 1.2, 0.3, 1.6
GROUND = (1.393 * math.cos(0.367), 1.393 * math.sin(0.367))
BOTTOM = math.acos((JOINT - PIVOT) / (CRANK + ROD))
"""Direction of the crank, stretched in line with its rod."""
BARS = {("A", "B"): 57.2, ("B", "E"): 203.0, ("C", "G"): 137.0, ("M", "G"): 265.0, ("G", "H"): 252.5}
"""Links by their joints, kg; C is the end of the arm."""
PLATFORM, SLIDER, ROTOR = 2030.0, 20100.0, 208.0
LIFT = 196e3 * 0.87
"""What is hidden: the cylinders lift with 13 % less than their gauge says, N. Masses are a little off."""
GRAVITY, NOISE, STEP = 9.80665, 0.25, 1e-3
"""m/s2, standard deviation of the torque that the drive shows, kN m, and the step of differences, s."""

Point = tuple[float, float]


def meeting(first: Point, second: Point, reach: float, other: float) -> Point:
    """The point at these distances from two others, outside and below the line between them."""
    across, down = second[0] - first[0], second[1] - first[1]
    apart = math.hypot(across, down)
    inner = math.acos((reach**2 + apart**2 - other**2) / (2 * reach * apart))
    at = math.atan2(down, across) + inner
    return first[0] + reach * math.cos(at), first[1] + reach * math.sin(at)


def joints(angle: float) -> dict[str, Point]:
    """The joints of one side, outward and downward from the middle, m, at a crank angle from the bottom."""
    at = BOTTOM + angle
    pin = (PIVOT + CRANK * math.cos(at), CRANK * math.sin(at))
    platform = pin[1] + math.sqrt(ROD**2 - (pin[0] - JOINT) ** 2)
    arm = (0.0, platform + ARM)
    knee = meeting(arm, GROUND, DRIVE, UPPER)
    slider = knee[1] + math.sqrt(LOWER**2 - (HALF - knee[0]) ** 2)
    return {"A": (PIVOT, 0.0), "B": pin, "E": (JOINT, platform), "C": arm, "G": knee, "M": GROUND, "H": (HALF, slider)}


def turned(time: float, rpm: float, start: float) -> float:
    """Crank angle at a time, rad: the servo swells its speed by a third and slows down for the work."""
    whole = rpm * math.pi / 30
    return start + whole * time + 0.3 * (1 - math.cos(whole * time))


def slope(values: list[float]) -> float:
    """The derivative in the middle of five values one step apart."""
    before, near, _, after, far = values
    return (before - 8 * near + 8 * after - far) / (12 * STEP)


def energy(time: float, rpm: float, start: float) -> float:
    """Kinetic and potential energy of both sides, J; what the cylinders lift is potential, too."""
    around = [turned(time + step * STEP, rpm, start) for step in range(-2, 3)]
    places = [joints(angle) for angle in around]
    here = places[2]
    speed = {
        name: (slope([place[name][0] for place in places]), slope([place[name][1] for place in places]))
        for name in here
    }
    total = ROTOR * slope(around) ** 2
    for (first, last), mass in BARS.items():
        (y, z), (v, w) = speed[first], speed[last]
        total += mass / 3 * (y * y + z * z + v * v + w * w + y * v + z * w)
        total -= mass * GRAVITY * (here[first][1] + here[last][1])
    total += 0.5 * PLATFORM * speed["E"][1] ** 2 - PLATFORM * GRAVITY * here["E"][1]
    return total + 0.5 * SLIDER * speed["H"][1] ** 2 + (LIFT - SLIDER * GRAVITY) * here["H"][1]


def force_at(angle: float, most: float) -> float:
    """The force of the work on the slider, N: none, half, all and none at -40, -30, 0 and 3 degrees."""
    places = [(-40.0, 0.0), (-30.0, most / 2), (0.0, most), (3.0, 0.0)]
    degrees = (math.degrees(angle) + 180) % 360 - 180
    for (low, before), (high, after) in itertools.pairwise(places):
        if low <= degrees < high:
            return before + (after - before) * (degrees - low) / (high - low)
    return 0.0


def write(name: str, rpm: float, start: float, most: float, *, rows: int = 80, seed: int) -> None:
    """Write one turn: what drive and load cell log, and the torque of one crank with noise on it."""
    noise = random.Random(seed)
    with open(name, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(
            ["time [s]", "start_angle [deg]", "crank_speed [rpm]", "forming_force [kN]", "crank_torque [kN*m]"]
        )
        for row in range(rows):
            time = row * 60 / rpm / rows
            near = [time + step * STEP for step in range(-2, 3)]
            angles = [turned(at, rpm, start) for at in near]
            speed, force = slope(angles), force_at(angles[2], most)
            power = slope([energy(at, rpm, start) for at in near])
            power += force * slope([joints(angle)["H"][1] for angle in angles])
            torque = power / 2 / speed / 1e3 + noise.gauss(0, NOISE)
            said = (f"{time:.4f}", round(math.degrees(start), 3), f"{speed * 30 / math.pi:.4f}", f"{force / 1e3:.2f}")
            table.writerow([*said, f"{torque:.3f}"])


if __name__ == "__main__":
    write("slow.csv", 3.0, math.radians(-150), 0.0, seed=1)
    write("fast.csv", 12.0, math.radians(-150), 1.2e6, seed=2)
