"""What changes the wear of the disc, and what of it is felt as backlash."""

from dataclasses import replace

import numpy as np

from rv_wear.conditions import OIL_TEMPERATURE
from rv_wear.effects_of_clearance import RATED_TORQUE
from rv_wear.quantities import Reducer
from truing import Float

VISCOSITY_EXPONENT = 7.377  # of the pressure-viscosity coefficient in the regression of the wear coefficient
THINNING = 0.0411  # 1/K, oil ISO VG 220 of viscosity index 95: 220 mm²/s at 40 degC, 18.7 mm²/s at 100 degC


def running_in(reducer: Reducer, *, depth: Float, run_in_time: Float) -> Reducer:
    """Fresh asperities go first: a depth beside the law of wear, complete after a few times the run-in time."""
    lost = -depth * np.expm1(-reducer.working_time / run_in_time)
    return replace(reducer, extra_wear=reducer.extra_wear + lost)


def wear_temperature(reducer: Reducer, *, softening: Float, oil_temperature: Float) -> Reducer:
    """Warm oil stiffens less under pressure, by ``softening`` per kelvin: the wear coefficient grows by its power."""
    faster = np.exp(VISCOSITY_EXPONENT * softening * (oil_temperature - OIL_TEMPERATURE.zero))
    return replace(reducer, wear_rate_factor=reducer.wear_rate_factor * faster)


def film_lubrication(reducer: Reducer, *, film_factor: Float, oil_temperature: Float) -> Reducer:
    """A film parts disc and pins wherever it is thick against the roughness; the oil thins out with its temperature."""
    thinner = np.exp(-THINNING * (oil_temperature - OIL_TEMPERATURE.zero))
    return replace(
        reducer, film_factor=reducer.film_factor + film_factor, oil_viscosity=reducer.oil_viscosity * thinner
    )


def pin_rolling(reducer: Reducer, *, rolling: Float) -> Reducer:
    """The pins turn in their grooves and take over this share of the sliding."""
    return replace(reducer, sliding_factor=reducer.sliding_factor * (1.0 - rolling))


def pin_wear(reducer: Reducer, *, ratio: Float) -> Reducer:
    """The pins wear too, ``ratio`` times as deep as the disc, and the backlash feels both."""
    return replace(reducer, pin_wear_ratio=reducer.pin_wear_ratio + ratio)


def lost_motion_share(reducer: Reducer, *, loss: Float) -> Reducer:
    """The backlash does not feel the deepest wear but what is left of it where disc and pins first touch."""
    return replace(reducer, lost_motion_share=reducer.lost_motion_share * (1.0 - loss))


def lubricant_ageing(reducer: Reducer, *, rate: Float) -> Reducer:
    """Additives are used up and debris gathers: the momentary wear coefficient grows evenly with the working time."""
    return replace(reducer, ageing_rate=reducer.ageing_rate + rate)


def load_exponent(reducer: Reducer, *, exponent: Float) -> Reducer:
    """The wear depth follows another power of the load than calculated; at the rated torque nothing changes."""
    return replace(reducer, depth_factor=reducer.depth_factor * (reducer.output_torque / RATED_TORQUE) ** exponent)


def duty_share(reducer: Reducer, *, idle: Float) -> Reducer:
    """Either flank is idle for this share of the working time: 0.5 where both share it evenly."""
    return replace(reducer, loaded_share=reducer.loaded_share * (1.0 - idle))
