"""How the safeties run over load and face width."""

from typing import Any

from matplotlib.figure import Figure

from rv_gearing.capacity import SAFETIES
from rv_gearing.drawn_look import BLUE, INK, MM, ORANGE, one_panel
from truing import Swept

LOOKS = {
    "root_safety_sun": (BLUE, "-", "sun, breakage"),
    "root_safety_planet": (ORANGE, "-", "planet, breakage"),
    "contact_safety_sun": (BLUE, "--", "sun, pitting"),
    "contact_safety_planet": (ORANGE, "--", "planet, pitting"),
}
RANGE = (0.7, 12.0)
TICKS = (0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
AXES = {
    "load_torque": ("output torque, N m", 1.0),
    "stated_sun_torque": ("torque of the sun, N m", 1.0),
    "face_width": ("face width, mm", MM),
    "power": ("input power, kW", 1e-3),
    "working_life": ("working time, h", 1.0 / 3600.0),
}


def safeties_figure(swept: "Swept", here: float) -> "Figure":
    """Draw the four safeties along the swept input, with what is asked of them and the value of the run."""
    figure, panel = one_panel(3.2)
    label, factor = AXES.get(swept.over, (swept.over.replace("_", " "), 1.0))
    axis = factor * swept.axis
    for name in SAFETIES:
        if name in swept.results:
            colour, dashes, words = LOOKS[name]
            panel.plot(axis, swept.results[name], color=colour, linestyle=dashes, label=words)
    stage: Any = swept.inputs
    asked = ((stage.least_bending_safety, "S_{Fmin}"), (stage.least_contact_safety, "S_{Hmin}"))
    for level, symbol in asked:
        panel.axhline(float(level), color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        above = float(level) == max(float(one) for one, _ in asked)
        panel.annotate(f"${symbol}$", (1.0, float(level)), (3, 4 if above else -4), textcoords="offset points",
                       xycoords=("axes fraction", "data"), fontsize=8, va="center")  # fmt: skip
    if swept.axis.min() <= here <= swept.axis.max():
        panel.axvline(factor * here, color=INK, linewidth=0.8, linestyle=(0, (6, 3)))
        panel.annotate("this run", (factor * here, 1.0), (3, -9), textcoords="offset points", fontsize=8,
                       xycoords=("data", "axes fraction"))  # fmt: skip
    panel.set_xlim(float(axis.min()), float(axis.max()))
    panel.set_yscale("log")
    panel.set_ylim(*RANGE)
    panel.set_yticks(TICKS, [f"{tick:g}" for tick in TICKS])
    panel.set_yticks([], minor=True)
    panel.set_xlabel(label)
    panel.set_ylabel("safety")
    panel.legend(ncols=4, loc="upper center", bbox_to_anchor=(0.5, 1.15), handlelength=1.8, columnspacing=1.2)
    panel.grid(alpha=0.35)
    panel.set_axisbelow(True)
    return figure
