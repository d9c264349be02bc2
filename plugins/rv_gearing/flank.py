"""How hot flanks get while they slide, and how thick the oil between them is: scuffing and micropitting.

Both follow the path of contact, point by point: radii of curvature, speeds of the flanks along themselves, the share of
the load that one pair of teeth carries there. Points have the first axis, (points, ...); SI throughout. References:
Blok's flash temperature and ISO/TS 6336-20 (ISO/TR 13989-1), integral temperature of ISO/TS 6336-21 (ISO/TR 13989-2),
film thickness of Dowson and Higginson as in ISO/TS 6336-22 (ISO/TR 15144-1); read in public projects that quote them.

Valid for external pairs without interference, contact ratio 1 to 2 (flash) or 2.5 (integral), oil at -10 to 150 degC.
Left out: the factors of tip relief and of the approach in the flash temperature, and the buttressing of helical teeth.
Flash and integral temperature have bulk temperatures of their own, and so has the film. Friction is that of the
integral method in all three: speeds of 1 to 50 m/s; slower teeth rub more than it says.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from gear_geometry.mesh_load import viscosity_at
from rv_gearing.geometry import Duty, GearSize, MeshSize
from rv_gearing.quantities import Gearing
from truing import Array, Float, either, found, results

TURN = 2.0 * np.pi
BLOK_FACTOR = 1.11  # largest rise of a band with Hertz's pressure, at high speed, over that of its whole width
CONTACT_COEFFICIENT = 13784.0  # N/(m s^0.5 K) of steel: root of 50 W/(m K) times 3.8 MJ/(m³ K)
FRICTION = "ISO/TR 13989-2:2000, equation 1"
FLASH = "Blok 1937; ISO/TS 6336-20 (ISO/TR 13989-1:2000)"
INTEGRAL = "ISO/TS 6336-21 (ISO/TR 13989-2:2000)"
FILM = "Dowson and Higginson; ISO/TS 6336-22 (ISO/TR 15144-1:2014)"
PATH = "15 points along the path of contact"
QUARTERS = (0.0, 0.25, 0.5, 0.75, 1.0)
ZERO = 273.15  # K
HOTTEST = 600.0  # K, up to which oil is followed; flanks above it have scuffed


@results
class FlankState:
    """Friction, temperatures and film of the flanks under load."""

    oil_viscosity: Float = found("mPa*s", symbol="eta", note="dynamic viscosity of the oil at work", source="ASTM D341",
                                 method="oil of viscosity index 95")  # fmt: skip
    speed_sum: Float = found(
        "m/s", symbol="v_Sigma C", note="sum of the speeds of both flanks along themselves at the pitch point",
        formula="2 * pi * mesh_speed * base_diameter_sun * tan(working_angle)",
    )  # fmt: skip
    flank_load: Float = found(
        "N/mm", symbol="w_Bt", note="line load with all factors", source=FLASH,
        formula="line_load * dynamic_factor * face_factor * transverse_factor * planet_factor * (1 + 0.2"
        " * sqrt(max(min(total_contact_ratio, 3.5) - 2, 0) * (5 - min(total_contact_ratio, 3.5))))",
    )  # fmt: skip
    normal_curvature: Float = found("mm", symbol="rho_redC", note="radius of relative curvature at the pitch point, "
                                    "normal section", formula="curvature / cos(base_helix_angle)")  # fmt: skip
    flank_friction: Float = found(
        "", symbol="mu_mC", note="mean friction of the flanks, at 150 N/mm at least; as stated where it is",
        source=FRICTION, numeric=True,
        formula="either(stated_friction, 0.045 * (max(flank_load, 150) / (speed_sum * normal_curvature))**0.2"
        " * oil_viscosity**(-0.05) * 2.2 * ((flank_roughness_sun + flank_roughness_planet) / (12 * normal_curvature))"
        "**0.25 * oil_factor)",
    )  # fmt: skip
    flash_temperature: Float = found("K", symbol="Theta_fl", note="largest flash temperature on the path", source=FLASH,
                                     method=PATH)  # fmt: skip
    mean_flash_temperature: Float = found("K", symbol="Theta_flm", note="mean flash temperature over the path",
                                          source=FLASH, method=PATH)  # fmt: skip
    bulk_rise: Float = found(
        "K", symbol="Delta Theta_M", note="of the gears above the oil", source=FLASH,
        formula="0.47 * lubrication_factor * (1 + planets) / 2 * mean_flash_temperature",
    )  # fmt: skip
    contact_rise: Float = found("K", symbol="Delta Theta_B", note="of the hottest contact above the oil", source=FLASH,
                                formula="bulk_rise + flash_temperature", key=True)  # fmt: skip
    scuffing_rise: Float = found(
        "K", symbol="Delta Theta_S", note="above the oil, at which it scuffs, by the load stage of the oil",
        source=FLASH, numeric=True,
        formula="80 + (0.85 + 1.4 * welding_factor) * oil_factor * oil_viscosity**(-0.05) * scuffing_stage**2"
        " - oil_temperature",
    )  # fmt: skip
    permitted_contact_rise: Float = found("K", symbol="Delta Theta_BP", note="with the distance that is asked for",
                                          formula="scuffing_rise - least_scuffing_distance")  # fmt: skip
    welding_factor: Float = found("", symbol="X_W", note="of the material against welding", source=FLASH,
                                  method="by the material: 1.5 of nitrided steel, else 1")  # fmt: skip
    tip_contact_ratio: Float = found(
        "", symbol="epsilon_1", note="contact ratio of the addendum of the sun", source=INTEGRAL,
        formula="teeth_sun / (2 * pi) * (tan(tip_angle_sun) - tan(working_angle))",
    )  # fmt: skip
    root_contact_ratio: Float = found("", symbol="epsilon_2", note="contact ratio of the addendum of the planet",
                                      source=INTEGRAL, formula="contact_ratio - tip_contact_ratio")  # fmt: skip
    tip_flash: Float = found("K", symbol="Theta_flE", note="flash temperature at the tip of the sun under the whole "
                             "load", source=FLASH, method="Blok's formula there")  # fmt: skip
    mean_by_tip: Float = found("", symbol="X_epsilon", note="mean over the path by that at the tip", source=INTEGRAL,
                               method="by the contact ratios of both addenda, equations 39 to 44")  # fmt: skip
    integral_rise: Float = found(
        "K", symbol="Delta Theta_int", note="integral temperature above the oil", source=INTEGRAL,
        formula="(0.7 * lubrication_factor * (1 + planets) / 2 + 1.5) * tip_flash * mean_by_tip"
        " / min(max(1.4 - 4 / 15 * root_contact_ratio / tip_contact_ratio, 0.6), 1)",
    )  # fmt: skip
    scuffing_integral_rise: Float = found(
        "K", symbol="Delta Theta_intS", note="integral temperature above the oil, at which it scuffs", source=INTEGRAL,
        numeric=True,
        formula="80 + 3.726 * scuffing_stage**2 * oil_factor * (0.23 + 0.3 * welding_factor * (100 / viscosity)**0.02)"
        " - oil_temperature",
    )  # fmt: skip
    loss_factor: Float = found(
        "", symbol="H_v", note="power lost over passed power and friction, of teeth that share evenly", source=FILM,
        formula="pi * (1 / teeth_sun + 1 / teeth_planet) / cos(base_helix_angle) * cases(contact_ratio / 2,"
        " contact_ratio >= 2, tip_contact_ratio**2 + root_contact_ratio**2 + 1 - contact_ratio)",
    )  # fmt: skip
    film_bulk_rise: Float = found(
        "K", symbol="Delta Theta_M,GF", note="of the gears above the oil, for the film; planets as in the flash method",
        source=FILM, numeric=True,
        formula="7400 / 1.2 * lubrication_factor * (1 + planets) / 2 * (tangential_force * pitch_line_velocity / 1000"
        " * flank_friction * loss_factor / (centre_distance * carrying_width))**0.72",
    )  # fmt: skip
    film_ratio: Float = found("", symbol="lambda_GF", note="least film of oil over the mean roughness of both flanks",
                              source=FILM, method=PATH)  # fmt: skip
    film_safety: Float = found("", symbol="S_lambda", note="against micropitting", source=FILM,
                               formula="film_ratio / least_film_ratio")  # fmt: skip


class Path(NamedTuple):
    """Points of the path of contact, (points, ...): radii of curvature, m, flank speeds, m/s, share of the load."""

    radii: tuple[Array, Array]
    speeds: tuple[Array, Array]
    share: Array


@dataclass(frozen=True, kw_only=True)
class Oil:
    """Viscosity at a temperature, Pa s, and the pressure coefficient, 1/Pa; mineral oil of viscosity index 95."""

    at_forty: Float  # mm²/s
    density: Float  # kg/m³, at 15 degC

    def viscosity(self, temperature: Float) -> Float:
        """Return the dynamic viscosity, Pa s, at a temperature in K, 600 at most; 0.7 kg/m³ lighter each kelvin."""
        temperature = np.minimum(temperature, HOTTEST)
        density = self.density - 0.7 * (temperature - 289.0)
        viscosity: Float = 1e-6 * viscosity_at(temperature, self.at_forty) * density
        return viscosity

    def pressure_coefficient(self, temperature: Float) -> Float:
        """Return the pressure coefficient of the viscosity, 1/Pa (equations 8 and 9 of ISO/TR 15144-1)."""
        temperature = np.minimum(temperature, HOTTEST)
        at_38 = 2.657e-8 * self.viscosity(311.0) ** 0.1348
        return at_38 * (1.0 + 516.0 * (1.0 / temperature - 1.0 / 311.0))


def blok(force: Float, radii: tuple[Float, Float], speeds: tuple[Float, Float], softness: Float) -> Float:
    """Return the largest flash temperature per coefficient of friction, K: 1.11 w |v1^1/2 - v2^1/2|/((2 b)^1/2 B_M).

    ``force`` is the line load along the normal, N/m; softness is the sum of (1 - nu²)/E, 1/Pa; both bodies of steel.
    """
    width = 2.0 * np.sqrt(4.0 * force * (radii[0] * radii[1] / (radii[0] + radii[1])) * softness / np.pi)  # Hertz
    slip = np.abs(np.sqrt(speeds[0]) - np.sqrt(speeds[1]))
    rise: Float = BLOK_FACTOR * force * slip / (np.sqrt(np.maximum(width, 1e-12)) * CONTACT_COEFFICIENT)
    return rise


def softness_of(stage: Gearing) -> Float:
    """Return the sum of (1 - nu²)/E of both gears, 1/Pa."""
    return (1.0 - stage.sun.poisson_ratio**2) / stage.sun.young_modulus + (
        1.0 - stage.planet.poisson_ratio**2
    ) / stage.planet.young_modulus


def path_of(stage: Gearing, duty: Duty, mesh: MeshSize, sizes: tuple[GearSize, GearSize], nothing: Float = 0.0) -> Path:
    """Return 15 points: five from A to B, five from B over C to D, five from D to E; C within B and D.

    A pair carries its whole load from B to D. Outside two pairs share it: a third at A and E (more from grade 8 on),
    two thirds where the other pair begins or ends, in a straight line between, so that both together carry the whole.
    Wide helical teeth, of a total contact ratio above 2, share evenly. ``nothing`` is 0 of the shape (...).
    """
    whole = 0.5 * (sizes[0].base_diameter + sizes[1].base_diameter) * np.tan(mesh.working_angle)
    end = 0.5 * sizes[0].base_diameter * np.tan(sizes[0].tip_angle)
    start = np.maximum(sizes[0].start_curvature, 1e-3 * end) + nothing
    outer = np.minimum(end, (1.0 - 1e-3) * whole)
    inner = np.maximum(end - mesh.base_pitch, start), np.minimum(start + mesh.base_pitch, outer)
    first, last = np.minimum(*inner), np.maximum(*inner)
    pitch = np.clip(0.5 * sizes[0].base_diameter * np.tan(mesh.working_angle), first, last)
    ends = np.broadcast_arrays(start, first, pitch, last, outer + nothing)
    spans = zip(ends[:-1], ends[1:], (QUARTERS, (0.0, 0.5), (0.0, 0.5, 1.0), QUARTERS), strict=True)
    radius = np.stack([low + part * (high - low) for low, high, parts in spans for part in parts])
    least = (max(stage.accuracy_grade, 7) - 2.0) / 15.0
    shared = np.minimum(least + np.array(QUARTERS) / 3.0, 1.0)
    alone = np.concatenate([shared, np.ones(len(QUARTERS)), shared[::-1]])
    alone = alone.reshape(-1, *(1,) * (radius.ndim - 1))
    even = (mesh.overlap_ratio > 0.0) & (mesh.total_contact_ratio > 2.0)
    speed = TURN * duty.mesh_speed
    other = whole - radius
    return Path(
        radii=(radius, other),
        speeds=(np.asarray(speed * radius), np.asarray(speed * other / mesh.tooth_ratio)),
        share=np.where(even, 1.0 / mesh.contact_ratio, alone) + 0.0 * radius,
    )


def mean_over(path: Path, values: Array) -> Float:
    """Return the mean over the path by trapezia."""
    steps = np.diff(path.radii[0], axis=0)
    mean: Float = np.sum(0.5 * (values[1:] + values[:-1]) * steps, axis=0) / np.sum(steps, axis=0)
    return mean


def mean_by_tip(one: Float, two: Float) -> Float:
    """Return X_epsilon: mean flash temperature over the path by that at the sun's tip, from both addenda's ratios.

    Equations 39 to 44 of ISO/TR 13989-2, for contact ratios below 3. An addendum without contact counts as 0.01.
    """
    one, two = np.maximum(one, 0.01), np.maximum(two, 0.01)
    both = one + two
    short = 0.70 * (one**2 + two**2) - 0.22 * both + 0.52 - 0.60 * one * two
    long_one = 0.18 * one**2 + 0.70 * two**2 + 0.82 * one - 0.52 * two - 0.30 * one * two
    long_two = 0.70 * one**2 + 0.18 * two**2 - 0.52 * one + 0.82 * two - 0.30 * one * two
    high_one = 0.44 * one**2 + 0.59 * two**2 + 0.30 * one - 0.30 * two - 0.15 * one * two
    high_two = 0.59 * one**2 + 0.44 * two**2 - 0.30 * one + 0.30 * two - 0.15 * one * two
    below = np.where(one >= 1.0, long_one, np.where(two >= 1.0, long_two, short))
    return np.where(both < 2.0, below, np.where(one >= two, high_one, high_two)) / (2.0 * both * one)


def film_over(path: Path, oil: Oil, heat: tuple[Float, Float], force: Float, softness: Float) -> Float:
    """Return the film of oil, m, at every point: 1.6 R G^0.6 U^0.7 W^-0.13 S^0.22 (Dowson and Higginson, S for heat).

    ``heat`` are the temperatures of the bulk and of the contact, K, ``force`` the line load along the normal, N/m.
    Where G is alpha E', U is eta v_sum/(2 E' R), W is w/(E' R) and E' is 2 over the softness.
    """
    modulus, radius = 2.0 / softness, path.radii[0] * path.radii[1] / (path.radii[0] + path.radii[1])
    alpha, eta = oil.pressure_coefficient(heat[0]), oil.viscosity(heat[0])
    hot = oil.pressure_coefficient(heat[1]) * oil.viscosity(heat[1]) / (alpha * eta)
    speed = eta * (path.speeds[0] + path.speeds[1]) / (2.0 * modulus * radius)
    load = np.maximum(force, 1.0) / (modulus * radius)
    return 1.6 * radius * (alpha * modulus) ** 0.6 * speed**0.7 * load**-0.13 * hot**0.22


def friction_of(stage: Gearing, load: Float, speed_sum: Float, radius: Float, eta: Float) -> Float:
    """Return the mean friction of the flanks: load in N/m, v in m/s, radius of curvature in mm, eta in mPa s."""
    pressed = np.maximum(load / 1e3, 150.0) / (speed_sum * radius)
    roughness = 1e6 * (stage.sun.flank_roughness + stage.planet.flank_roughness) / 12.0
    calculated = 0.045 * pressed**0.2 * eta**-0.05 * 2.2 * (roughness / radius) ** 0.25 * stage.oil_factor
    return either(stage.stated_friction, calculated)


def film_bulk(stage: Gearing, duty: Duty, mesh: MeshSize, friction: Float, loss: Float) -> Float:
    """Return the bulk temperature above the oil for the film, K: an empirical law in kW and mm, for unmodified teeth.

    Equation 84 of ISO/TR 15144-1, of one mesh; (1 + planets)/2 is taken over from the flash method.
    """
    lost = duty.tangential_force * duty.pitch_line_velocity / 1e3 * friction * loss
    area = 1e6 * mesh.centre_distance * duty.carrying_width
    rise: Float = 7400.0 / 1.2 * stage.lubrication_factor * 0.5 * (1.0 + stage.planets) * (lost / area) ** 0.72
    return rise


def loss_factor(mesh: MeshSize, teeth: tuple[Float, Float], one: Float, two: Float) -> Float:
    """Return H_v: lost over passed power and friction, from the contact ratios of both addenda."""
    shared = np.where(mesh.contact_ratio >= 2.0, 0.5 * mesh.contact_ratio, one**2 + two**2 + 1.0 - mesh.contact_ratio)
    return np.pi * (1.0 / teeth[0] + 1.0 / teeth[1]) / np.cos(mesh.base_helix_angle) * shared


def scuffing_rises(stage: Gearing, eta: Float, welding: float) -> tuple[Float, Float]:
    """Return above the oil, K, where flanks scuff by the flash and by the integral method; eta in mPa s."""
    square, celsius = np.square(stage.scuffing_stage), stage.oil_temperature - ZERO
    by_flash = 80.0 + (0.85 + 1.4 * welding) * stage.oil_factor * eta**-0.05 * square
    by_integral = 0.23 + 0.3 * welding * (100e-6 / stage.viscosity) ** 0.02
    return by_flash - celsius, 80.0 + 3.726 * square * stage.oil_factor * by_integral - celsius


def flank_state(
    stage: Gearing, duty: Duty, mesh: MeshSize, sizes: tuple[GearSize, GearSize], factors: Float
) -> FlankState:
    """Return friction, temperatures and film of the flanks; ``factors`` are all load factors behind K_A."""
    oil = Oil(at_forty=stage.viscosity / 1e-6, density=stage.oil_density)
    eta, over = 1e3 * oil.viscosity(stage.oil_temperature), np.minimum(mesh.total_contact_ratio, 3.5)
    load = duty.line_load * factors * (1.0 + 0.2 * np.sqrt(np.maximum(over - 2.0, 0.0) * (5.0 - over)))
    speed_sum = TURN * duty.mesh_speed * sizes[0].base_diameter * np.tan(mesh.working_angle)
    radius = mesh.curvature / np.cos(mesh.base_helix_angle)
    friction = friction_of(stage, load, speed_sum, 1e3 * radius, eta)
    soft, heated = softness_of(stage), 0.5 * stage.lubrication_factor * (1.0 + stage.planets)
    path = path_of(stage, duty, mesh, sizes, 0.0 * (load * eta * friction * soft * heated))
    normal = load / np.cos(mesh.transverse_angle)
    rises = np.asarray(friction * blok(normal * path.share, path.radii, path.speeds, soft))
    largest, mean = np.max(rises, axis=0), mean_over(path, rises)
    bulk = 0.47 * heated * mean
    tip = [(own[-1], other[-1]) for own, other in (path.radii, path.speeds)]
    tip_flash = friction * blok(normal, tip[0], tip[1], soft)
    one = sizes[0].teeth / TURN * (np.tan(sizes[0].tip_angle) - np.tan(mesh.working_angle))
    two = mesh.contact_ratio - one
    by_tip, approach = mean_by_tip(one, two), np.clip(1.4 - 4.0 / 15.0 * two / one, 0.6, 1.0)
    welding = 1.5 if stage.material == "nitrided" else 1.0
    scuffs = scuffing_rises(stage, eta, welding)
    loss = loss_factor(mesh, (sizes[0].teeth, sizes[1].teeth), one, two)
    warm = film_bulk(stage, duty, mesh, friction, loss)
    at_work = stage.oil_temperature + warm
    film = film_over(path, oil, (at_work, at_work + rises), normal * path.share, soft)
    ratio = 12.0 * np.min(film, axis=0) / (stage.sun.flank_roughness + stage.planet.flank_roughness)
    return FlankState(
        oil_viscosity=1e-3 * eta, speed_sum=speed_sum, normal_curvature=radius, flank_load=load,
        flank_friction=friction, flash_temperature=largest, mean_flash_temperature=mean, bulk_rise=bulk,
        contact_rise=bulk + largest, scuffing_rise=scuffs[0],
        permitted_contact_rise=scuffs[0] - stage.least_scuffing_distance, welding_factor=0.0 * load + welding,
        tip_contact_ratio=one, root_contact_ratio=two, tip_flash=tip_flash, mean_by_tip=by_tip,
        integral_rise=(0.7 * heated + 1.5) * tip_flash * by_tip / approach, scuffing_integral_rise=scuffs[1],
        loss_factor=loss, film_bulk_rise=warm, film_ratio=ratio, film_safety=ratio / stage.least_film_ratio,
    )  # fmt: skip
