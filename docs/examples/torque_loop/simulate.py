"""Records of two drives from a program of its own: simulate.py writes drive_1.csv and drive_2.csv.

It shares nothing with the calculation: a mass moves between two flanks in time, and dry friction holds it, in small
equal steps. The torque is turned up and down within 80 s; both gauges have noise.
"""

import csv
import math
import random

ARCMIN = math.pi / 180 / 60
INERTIA, DAMPING = 2.0, 300.0
"""Of what moves, kg m2, and of grease and flanks, N m s."""
STIFFNESS, HOUSING = 20.4 / ARCMIN, 59.0 / ARCMIN
"""Of the gearing and of a sound housing, N m/rad."""
ZERO, NOISE = 0.3, 0.03
"""Where the gauge was put, and the standard deviation of its noise, arcmin."""
STEP = 1e-3
"""s"""
LARGEST, BETWEEN = 200.0, 12.5
"""Largest torque, and that from reading to reading, N m; one reading a second."""


def torques() -> list[float]:
    """Torque at each reading, N m: up, down to the other side, up again."""
    quarter = round(LARGEST / BETWEEN)
    steps = [1] * quarter + [-1] * 2 * quarter + [1] * 2 * quarter
    return [BETWEEN * sum(steps[:end]) for end in range(len(steps) + 1)]


def loop(play: float, friction: float, rest: float) -> list[float]:
    """Twist of the gearing at each reading, arcmin; play and the twist at first in arcmin, friction in N m."""
    angle, speed, shown, given = rest * ARCMIN, 0.0, [], torques()
    for second, torque in enumerate(given):
        shown.append(angle / ARCMIN)
        if second + 1 == len(given):
            break
        for part in range(round(1 / STEP)):
            now = torque + (given[second + 1] - torque) * part * STEP
            angle, speed = moved(now, angle, speed, play * ARCMIN, friction)
    return shown


def moved(torque: float, angle: float, speed: float, play: float, friction: float) -> tuple[float, float]:
    """Angle and speed one step later."""
    flank = angle - play / 2 if angle > play / 2 else angle + play / 2 if angle < -play / 2 else 0.0
    pull = torque - STIFFNESS * flank
    if speed == 0 and abs(pull) <= friction:
        return angle, 0.0
    sense = math.copysign(1, speed or pull)
    after = speed + STEP * (pull - friction * sense - DAMPING * speed) / INERTIA
    if speed * after < 0:
        after = 0.0
    return angle + STEP * after, after


def write(name: str, gearing: list[float], softer: float, seed: int) -> None:
    """Write one record of a drive whose housing gives way more by a share."""
    noise = random.Random(seed)
    with open(name, "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["time [s]", "torque [N*m]", "twist [arcmin]", "housing [arcmin]"])
        for second, (torque, angle) in enumerate(zip(torques(), gearing, strict=True)):
            housing = torque * (1 + softer) / HOUSING / ARCMIN
            twist = angle + housing + ZERO + noise.gauss(0, NOISE)
            rows.writerow([second, torque, f"{twist:.3f}", f"{housing + noise.gauss(0, NOISE):.3f}"])


if __name__ == "__main__":
    write("drive_1.csv", loop(play=1.3, friction=10.0, rest=-0.2), 0.0, 1)
    write("drive_2.csv", loop(play=0.5, friction=6.0, rest=0.1), 0.3, 2)
