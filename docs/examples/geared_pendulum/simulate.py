"""Records of a pendulum on a geared drive from a program of its own: simulate.py writes swing_1.csv and swing_2.csv.

It shares nothing with the calculation: small equal steps after Heun, dry friction that holds the arm by a test of its
own, and a gauge with noise.
"""

import csv
import math
import random

GRAVITY, LENGTH, INERTIA = 9.80665, 0.501, 0.021
DRY, OIL = 0.11, 0.012
"""What is hidden: dry friction, N m, and friction of the oil, N m s."""
VERTICAL, NOISE = 0.2, 0.15
"""Where the gauge shows the vertical, and the standard deviation of its noise, degrees."""
STEP = 1e-4


def swing(mass: float, release: float, times: list[float]) -> list[float]:
    """Angles of the arm, degrees, at rising times in s, of a tip mass in kg that is let go at an angle in degrees."""
    whole, angle, speed, now = INERTIA + mass * LENGTH**2, math.radians(release), 0.0, 0.0
    angles = []
    for time in times:
        while now < time - STEP / 2:
            angle, speed = stepped(mass, whole, angle, speed)
            now += STEP
        angles.append(math.degrees(angle))
    return angles


def stepped(mass: float, whole: float, angle: float, speed: float) -> tuple[float, float]:
    """Angle and speed one step later."""
    pull = -mass * GRAVITY * LENGTH * math.sin(angle)
    if speed == 0 and abs(pull) <= DRY:
        return angle, 0.0
    sense = math.copysign(1, speed or pull)
    first = (pull - OIL * speed - DRY * sense) / whole
    middle, fast = angle + STEP / 2 * speed, speed + STEP / 2 * first
    second = (-mass * GRAVITY * LENGTH * math.sin(middle) - OIL * fast - DRY * sense) / whole
    after = speed + STEP * second
    return angle + STEP * fast, 0.0 if speed * after < 0 else after


def write(name: str, mass: float, release: float, times: list[float], seed: int) -> None:
    """Write one record."""
    noise = random.Random(seed)
    with open(name, "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["time [s]", "tip_mass [kg]", "angle [deg]"])
        for time, angle in zip(times, swing(mass, release, times), strict=True):
            rows.writerow([f"{time:.3f}", mass, f"{angle + VERTICAL + noise.gauss(0, NOISE):.2f}"])


if __name__ == "__main__":
    write("swing_1.csv", 1.2, 61.0, [0.2 * row for row in range(63)], 1)
    write("swing_2.csv", 0.6, 43.5, [0.17 * row for row in range(50)], 2)
