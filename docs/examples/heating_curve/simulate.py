"""Records of a gear unit that warms and cools, from a program of its own: simulate.py writes day_1.csv and day_2.csv.

It shares nothing with the calculation: equal steps of one second after Heun, and sensors with noise.
"""

import csv
import math
import random

LOAD_LOSS, DRAG, THINNING = 0.0205, 0.78, 0.015
"""Share of the power that is lost; drag torque at 40 degC, N m; share of it that is lost per kelvin."""
OIL, HOUSING, CONTACT = 8.2e3, 28.3e3, 63.0
"""Heat capacities, J/K, and heat transfer from the oil to the housing, W/K."""
STILL, FAN = 5.1, 0.0027
"""Heat transfer of the clean housing to still air, W/K, and of the fan, W/K per rpm."""
FOULED, ROUGH = 0.25, 0.008
"""What is hidden: the share of that transfer that dust takes, and what worn flanks lose besides, of the power."""
NOISE = 0.15
"""Standard deviation of a reading, K."""

Shift = list[tuple[float, float, float]]
"""From when on, s, with which torque, N m, at which speed, rpm."""
DAY_1: Shift = [(0, 100, 1450), (7200, 150, 1450), (12960, 0, 0)]
DAY_2: Shift = [(0, 40, 1450), (5400, 100, 900), (10800, 0, 0)]


def setting(shift: Shift, time: float) -> tuple[float, float]:
    """Torque, N m, and speed, rpm, at a time."""
    return next((torque, speed) for begin, torque, speed in reversed(shift) if time >= begin)


def air(time: float) -> float:
    """Temperature of the air, degC: it rises slowly."""
    return 21 + 2 * math.sin(time / 9000)


def gains(oil: float, housing: float, time: float, run: tuple[float, float]) -> tuple[float, float]:
    """What oil and housing gain, K/s."""
    torque, speed = run
    drag = DRAG * math.exp(-THINNING * (oil - 40))
    loss = 2 * math.pi * speed / 60 * ((LOAD_LOSS + ROUGH) * torque + drag)
    passed = CONTACT * (oil - housing)
    away = (1 - FOULED) * (STILL + FAN * speed) * (housing - air(time))
    return (loss - passed) / OIL, (passed - away) / HOUSING


def day(shift: Shift, oil: float, housing: float, times: list[int]) -> list[tuple[float, float]]:
    """Temperatures of oil and housing, degC, at rising times in whole seconds."""
    readings = []
    for now in range(times[-1] + 1):
        if now in times:
            readings.append((oil, housing))
        run = setting(shift, now)
        first = gains(oil, housing, now, run)
        second = gains(oil + first[0], housing + first[1], now + 1, run)
        oil, housing = oil + (first[0] + second[0]) / 2, housing + (first[1] + second[1]) / 2
    return readings


def write(name: str, shift: Shift, start: tuple[float, float], times: list[int], seed: int) -> None:
    """Write one record of a unit that starts with these temperatures of oil and housing, degC.

    Where the oil starts is the mean of ten readings before the unit is switched on.
    """
    noise = random.Random(seed)
    began = sum(start[0] + noise.gauss(0, NOISE) for _ in range(10)) / 10
    with open(name, "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["time [min]", "torque [N*m]", "speed [rpm]", "air [degC]", "oil_start [degC]", "oil [degC]"])
        for time, (oil, _) in zip(times, day(shift, *start, times), strict=True):
            read = f"{oil + noise.gauss(0, NOISE):.2f}"
            rows.writerow([f"{time / 60:g}", *setting(shift, time), f"{air(time):.2f}", f"{began:.2f}", read])


if __name__ == "__main__":
    write("day_1.csv", DAY_1, (20.5, 20.5), [720 * row for row in range(26)], 1)
    write("day_2.csv", DAY_2, (46.0, 43.0), [900 * row for row in range(19)], 2)
