"""Links that lengthen with heat. Frame, platform width and slider keep their size."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from press_linkage.conditions import LINK_TEMPERATURE
from press_linkage.quantities import Press, Side
from truing import Float

HEATED = ("crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length")


def longer(side: Side, by: Mapping[str, Float]) -> Side:
    """One side with these lengths off by so much more, m, named without ``_deviation``."""
    names = {kind: f"{kind}_deviation" for kind in by}
    return replace(side, **{name: getattr(side, name) + by[kind] for kind, name in names.items()})


def stretched(press: Press, strain_1: Float, strain_2: Float) -> Press:
    """The press with every link of a side longer by the strain of that side, the platform arm by their mean."""
    arm = 0.5 * (strain_1 + strain_2) * press.platform_arm
    return replace(
        press,
        platform_arm_deviation=press.platform_arm_deviation + arm,
        side_1=longer(press.side_1, {kind: strain_1 * getattr(press, kind) for kind in HEATED}),
        side_2=longer(press.side_2, {kind: strain_2 * getattr(press, kind) for kind in HEATED}),
    )


def link_heating(press: Press, *, expansion: Float, link_temperature: Float) -> Press:
    """All links of both sides lengthen with their temperature; frame, platform width and slider do not."""
    strain = expansion * (link_temperature - LINK_TEMPERATURE.zero)
    return stretched(press, strain, strain)


def warm_up(press: Press, *, rise: Float, time_constant: Float, time: Float) -> Press:
    """All links of both sides lengthen with the time at work, towards a last strain: a body that heats up."""
    strain = -rise * np.expm1(-time / time_constant)
    return stretched(press, strain, strain)


def side_heating(press: Press, *, expansion_1: Float, expansion_2: Float, link_temperature: Float) -> Press:
    """The links of each side lengthen at their own rate, the platform arm, common to both, at the mean rate."""
    warmer = link_temperature - LINK_TEMPERATURE.zero
    return stretched(press, expansion_1 * warmer, expansion_2 * warmer)
