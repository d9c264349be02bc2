"""What the rough flanks leave out of the torsion and the stiffness of a drive, or of a measured surface."""

from dataclasses import replace

import numpy as np

from gear_geometry.mesh_load import wave
from harmonic_fractal.calculation import TABLE
from harmonic_fractal.quantities import Drive, Stiffness
from truing import Condition, Effect, Float, Unknown, column

# What else must be measured before the effects of the drive can act: each condition once, for all of them
#
# The torque is an input of the drive; its column holds row by row. Turns, direction and peak are taken from that column
# as it stands, so a column of commanded torque serves better than one with noise.

REVERSAL_TORQUE = Condition("reversal_torque", "N*m", reference=0, derived="last_reversal of torque", low=-500,
                            high=500, note="where the torque last turned; at first where it began")  # fmt: skip
PEAK_TORQUE = Condition("peak_torque", "N*m", reference=0, derived="running_maximum of torque", low=0, high=1000,
                        note="the largest torque so far")  # fmt: skip
DIRECTION = Condition(
    "direction", "", reference=0, derived="direction of torque", low=-1, high=1,
    note="way of the torque: +1 while it grows, -1 while it falls, 0 for the mean of both",
)  # fmt: skip
WAVE_ANGLE = Condition("wave_angle", "deg", reference=0, low=0, high=360,
                       note="angle of the wave generator, against the circular spline")  # fmt: skip
TEMPERATURE = Condition("temperature", "degC", reference=20, low=-10, high=80, role="follows",
                        note="temperature of the drive and its lubricant, when measured")  # fmt: skip
CYCLES = Condition("cycles", "", reference=0, low=0, high=1e8, role="goes_on",
                   note="meshes of a pair of teeth in service, since new")  # fmt: skip
TIME = Condition("time", "h", reference=0, derived="since_start", low=0, high=100,
                 note="time under torque, since the first row")  # fmt: skip
SPEED = Condition("speed", "rpm", reference=0, low=0, high=6000,
                  note="speed of the wave generator; the sign is its sense of turning")  # fmt: skip


# What is in the structure function of a flank beside its fractal roughness: a wave, noise, a blunt instrument


def raised(results: Stiffness, by: Float) -> Stiffness:
    """Return the results with an amount, m², on the structure function."""
    return replace(results, structure_function=results.structure_function + by)


def waviness(drive: Drive, results: Stiffness, *, square: Float, wavelength: Float) -> Stiffness:
    """A wave lies across the flank: A² (1 - cos(2 pi lag/wavelength)), with ``square`` the square of its amplitude."""
    phase = 2.0 * np.pi * np.asarray(drive.lags) / column(wavelength)
    return raised(results, column(square) * (1.0 - np.cos(phase)))


def instrument_noise(drive: Drive, results: Stiffness, *, variance: Float) -> Stiffness:
    """Every height is read with an error of its own: twice its variance at any lag."""
    return raised(results, 2.0 * column(variance))


def lateral_filter(drive: Drive, *, width: Float) -> Drive:
    """The instrument averages over a spot along the line: the finest roughness is lost, waves and noise are not.

    A Gaussian weight of standard deviation ``width``; two spots in a row are one whose variance is their sum.
    """
    return replace(drive, spot_width=np.hypot(drive.spot_width, width))


# What the torsion owes to friction, play and the first load: terms on the angle, in its own sense of the torque

MILLION = 1e6
RATED_SPEED = 1000.0 / 60.0  # turns per second


def turned(results: Stiffness, by: Float) -> Stiffness:
    """Return the results with an angle, rad, on the torsion."""
    return replace(results, torsion=results.torsion + by)


def rated_torque(drive: Drive) -> float:
    """Return T_2 of the size in the catalogue, N m: 25 for size 20."""
    return TABLE[drive.catalogue_size][1]


def held_share(
    drive: Drive, torque_scale: Float, direction: Float, reversal_torque: Float, peak_torque: Float
) -> Float:
    """Return what friction holds back, in halves of its loop: 1 once it has slipped on a way up, -1 on a way down.

    +-(1 - 2 exp(-|T - T_rev|/T_c)) after a turn. The first load starts in the middle and slips through in half that
    torque, 1 - exp(-2 |T - T_rev|/T_c), as Masing's rule has it; a loop that closes at its peak meets it there.
    """
    sense = np.sign(direction)
    way = np.abs(drive.torque - reversal_torque) / (torque_scale * rated_torque(drive))
    is_first = (drive.torque >= peak_torque) & (sense > 0.0)
    return sense * np.where(is_first, -np.expm1(-2.0 * way), 1.0 - 2.0 * np.exp(-way))


def hysteresis(drive: Drive, results: Stiffness, *, loop: Float, torque_scale: Float, **history: Float) -> Stiffness:
    """Dry friction holds the angle back by half of the loop: behind a torque that grows, and before one that falls.

    So the loop takes up energy, and is never negative. Range: every turn but that of the first load follows a branch on
    which the friction has slipped through, so several ``torque_scale`` (in parts of T_2) long. Of the direction only
    the sign counts.
    """
    return turned(results, -0.5 * loop * held_share(drive, torque_scale, **history))


def viscous_hysteresis(
    drive: Drive, results: Stiffness, *, loop: Float, thinning: Float, speed: Float, temperature: Float, **held: Float
) -> Stiffness:
    """The lubricant adds to the loop, in proportion to its viscosity and to the speed; at rest there is none of it.

    ``loop`` is the width at 1000 rpm and 20 degC; the viscosity falls by exp(-``thinning`` (temperature - 20 degC)).
    """
    viscosity = np.exp(-thinning * (temperature - TEMPERATURE.zero))
    width = loop * viscosity * np.abs(speed) / RATED_SPEED
    return hysteresis(drive, results, loop=width, **held)


def crossed(drive: Drive, torque_scale: Float) -> Float:
    """Return the share of a play that is crossed, in the sense of the torque; the scale is in parts of T_2."""
    return np.tanh(drive.torque / (torque_scale * rated_torque(drive)))


def lost_motion(drive: Drive, results: Stiffness, *, play: Float, torque_scale: Float) -> Stiffness:
    """The teeth cross their play and come to bear one after another: ``play`` to either side of the middle."""
    return turned(results, play * crossed(drive, torque_scale))


def flank_wear(drive: Drive, results: Stiffness, *, rate: Float, torque_scale: Float, cycles: Float) -> Stiffness:
    """Both flanks of a pair wear in proportion to the cycles in service, and the drive gains so much play.

    Depth k_w p s n of Archard on either flank, with ``rate`` the depth per million cycles at the pressure and sliding
    of its service; 2 depths along the line of action are 2 depths/(r_p cos alpha) at the output. The gap is crossed
    as any other play is.
    """
    gap = 2.0 * rate * cycles / MILLION
    lever = drive.pitch_radius * np.cos(drive.pressure_angle)
    return turned(results, gap / lever * crossed(drive, torque_scale))


def thermal_preload(drive: Drive, results: Stiffness, *, expansion: Float, temperature: Float) -> Stiffness:
    """The circular spline grows more than the flexspline, which opens a gap: the teeth turn until they bear.

    A distance dr across the pitch circle opens r_p dtheta = dr tan(alpha) to either side, with
    dr = ``expansion`` r_p (temperature - 20 degC).
    """
    strain = expansion * (temperature - TEMPERATURE.zero)
    return turned(results, strain * np.tan(drive.pressure_angle) * np.sign(drive.torque))


def first_load_set(drive: Drive, results: Stiffness, *, peak_torque: Float, **unknowns: Float) -> Stiffness:
    """The first load leaves a set behind, and below its peak the flattened flanks are stiffer than they were.

    The set is ``set`` (peak/T_2)^``exponent``, with T_2 = 25 N m for size 20; the mesh is stiffer by the share
    ``stiffening`` wherever the torque is below the largest so far.
    """
    height = np.maximum(peak_torque, 0.0) / rated_torque(drive)
    left = unknowns.get("set", 0.0) * height ** unknowns.get("exponent", 1.0)
    again = np.abs(drive.torque) < peak_torque
    stiffer = 1.0 + np.where(again, unknowns.get("stiffening", 0.0), 0.0)
    return turned(replace(results, mesh_stiffness=results.mesh_stiffness * stiffer), left)


# What turns and time bring along: an oval and an eccentric wave generator, creep, a rig that drifts


def creep(drive: Drive, results: Stiffness, *, share: Float, time_scale: Float, time: Float) -> Stiffness:
    """The twist goes on under torque: by ``share`` of itself each time that the time grows e-fold.

    Only what is elastic creeps: the mesh and what is in series with it.
    """
    beyond = np.sign(drive.torque) * np.maximum(np.abs(drive.torque) - drive.reference_torque, 0.0)
    elastic = results.mesh_torsion + results.series_compliance * beyond + results.wave_torsion
    return turned(results, share * elastic * np.log1p(np.maximum(time, 0.0) / time_scale))


def ellipticity(drive: Drive, results: Stiffness, *, wave_angle: Float, **unknowns: Float) -> Stiffness:
    """The two lobes of the wave generator are not alike: two waves per turn, of the angle and of the stiffness."""

    by_angle, by_stiffness = (
        wave(2.0 * wave_angle, unknowns.get(f"{name}cosine", 0.0), unknowns.get(f"{name}sine", 0.0))
        for name in ("", "stiffness_")
    )
    return turned(replace(results, mesh_stiffness=results.mesh_stiffness * (1.0 + by_stiffness)), by_angle)


def eccentricity(drive: Drive, results: Stiffness, *, cosine: Float, sine: Float, wave_angle: Float) -> Stiffness:
    """The wave generator is off its axis: one wave of the angle per turn."""
    return turned(results, wave(wave_angle, cosine, sine))


def rig_drift(drive: Drive, results: Stiffness, *, rate: Float, time: Float) -> Stiffness:
    """The rig moves on with time, whatever the torque; the drive does not."""
    return turned(results, rate * time)


# What makes the drive softer or stiffer than its flanks: springs in series, pairs, film, smoothing, heat

FILM_EXPONENT = 0.67  # of viscosity times speed in the thickness of the film
LOAD_EXPONENT = -0.07  # of the load in it
FILM_THINNING = 0.035  # 1/K, of the viscosity
LEAST_TORQUE = 1e-3  # N*m, from which it is counted
LEAST_GAP = 0.1  # over the film at 1000 rpm and 20 degC: without oil the asperities hold the flanks so far apart
YIELDING = 0.02  # likewise: by which the gap grows while the load of the asperities falls by e (Persson 2007)
STEPS = 8  # of Newton's iteration for the gap; six do, from any speed


def series_compliance(drive: Drive, *, compliance: Float) -> Drive:
    """Cup, wave generator, its bearing and the rig twist in proportion to the torque, beside the mesh."""
    return replace(drive, drive_compliance=drive.drive_compliance + compliance)


def thin_cup(drive: Drive, *, lost: Float) -> Drive:
    """The wall of the cup is thinner than stated, by the share ``lost`` of it: the tube twists 1/(1 - lost) as much.

    A crack that leaves so much of the wall is alike. Without a cup_length the cup is rigid, and nothing of this shows.
    """
    return replace(drive, cup_wall=drive.cup_wall * (1.0 - lost))


def soft_wave_generator(drive: Drive, *, torsion: Float) -> Drive:
    """Balls and races of the wave generator give way more than stated: ``torsion`` more under T_2, as torque^(2/3).

    T_2 is 25 N m for size 20. Contacts of balls as Hertz has them, all of them loaded from the first torque on: a
    clearance between them is a play, which is ``lost_motion``.
    """
    more = torsion * np.power(drive.wave_torque / rated_torque(drive), 2.0 / 3.0)
    return replace(drive, wave_torsion_stated=drive.wave_torsion_stated + more)


def engaged_pairs(drive: Drive, *, gain: Float, torque_scale: Float) -> Drive:
    """The flexspline gives way until more pairs touch: the share ``gain`` more of them at a large torque.

    The torsion is added up with the pairs that there are on the way. Beside a gain that is stated, both are one gain
    of their sum, under their mean torque.
    """
    both = drive.engaged_gain + gain
    share = np.where(both > 0.0, gain / np.where(both > 0.0, both, 1.0), 0.0)
    scale = drive.engaged_torque + share * (torque_scale * rated_torque(drive) - drive.engaged_torque)
    return replace(drive, engaged_gain=both, engaged_torque=scale)


def oil_film(drive: Drive, *, stiffness: Float, speed: Float, temperature: Float) -> Drive:
    """The oil between the flanks carries beside their asperities, the stiffer the thinner it is; at rest it is gone.

    ``stiffness`` is that of a film which fills the flank of a pair at 1000 rpm, 20 degC and T_2 of the catalogue, 25 N
    m for size 20: modulus of compression times flank over thickness. Alone it would be as thick as (viscosity
    speed)^0.67 torque^-0.07 says; the asperities hold the flanks apart at a tenth of that, and the film shares the load
    with them. The asperities' own stiffness is that under the whole load, which is too much by what the film carries.
    """
    flow = np.exp(-FILM_THINNING * (temperature - TEMPERATURE.zero)) * np.abs(speed) / RATED_SPEED
    load = np.maximum(np.abs(drive.torque), LEAST_TORQUE) / rated_torque(drive)
    gap, share = shared(flow**FILM_EXPONENT * load**LOAD_EXPONENT)
    return replace(drive, film_stiffness=drive.film_stiffness + stiffness * share / gap)


def shared(alone: Float) -> tuple[Float, Float]:
    """Return the gap between flanks, over the film at 1000 rpm, and the share of the load that the film carries.

    ``alone`` is how thick the film would be without asperities. At a fixed gap h it carries in proportion to viscosity
    times speed (Reynolds), so (alone/h)^(1/0.67), and the asperities exp(-(h - h_r)/gamma); together that is all of it.
    The sum is convex and falls over h, so Newton's iteration closes in from below.
    """
    gap = np.maximum(alone, LEAST_GAP)
    for _ in range(STEPS):
        asperities, film = np.exp((LEAST_GAP - gap) / YIELDING), (alone / gap) ** (1.0 / FILM_EXPONENT)
        gap = gap + (asperities + film - 1.0) / (asperities / YIELDING + film / (FILM_EXPONENT * gap))
    return gap, (alone / gap) ** (1.0 / FILM_EXPONENT)


def asperity_smoothing(drive: Drive, *, dimension: Float, roughness: Float, cycle_scale: Float, cycles: Float) -> Drive:
    """The finest asperities go first: the dimension rises and G falls, until the flanks have run in.

    ``roughness`` is by how much ln G falls.
    """
    run_in = -np.expm1(-cycles / cycle_scale)
    return replace(
        drive,
        dimension_deviation=drive.dimension_deviation + dimension * run_in,
        roughness_deviation=drive.roughness_deviation - roughness * run_in,
    )


def modulus_temperature(drive: Drive, *, softening: Float, temperature: Float) -> Drive:
    """Warm steel is softer, by the share ``softening`` per kelvin: flanks, teeth and all that twists."""
    left = 1.0 - softening * (temperature - TEMPERATURE.zero)
    return replace(drive, modulus_factor=drive.modulus_factor * left)


# They act in the order declared: first what changes flanks, pairs and springs, then what is added to the torsion, then
# the surface, then the readings. A new effect is a function beside the others and one more entry in EFFECTS.

ARCHARD = "Archard, J. F., Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981"
DOWSON = "Dowson, D., Higginson, G. R., Elasto-hydrodynamic lubrication, Pergamon 1966: film of a line contact"
CATALOGUE = "catalogues of harmonic drives: three stiffnesses, hysteresis and lost motion of about 1 arcmin (291 urad)"
MASING = (
    "Masing, G., Eigenspannungen und Verfestigung beim Messing, 2nd Int. Congress of Applied Mechanics, Zurich 1926"
)
PARTS = "in parts of T_2 of the size in the catalogue (25 N*m for size 20)"
FRICTION_SCALE = Unknown("torque_scale", 0.005, 4, "", f"torque after which 63 % has turned round, {PARTS}")
PLAY_SCALE = Unknown("torque_scale", 0.002, 1, "", f"torque at which 76 % of the play is crossed, {PARTS}")


def parts_of_wave(limit: float, unit: str, prefix: str = "", of: str = "the torsion") -> list[Unknown]:
    """Declare both parts of one harmonic."""
    return [
        Unknown(f"{prefix}cosine", -limit, limit, unit, f"part of the wave of {of}"),
        Unknown(f"{prefix}sine", -limit, limit, unit, f"part of the wave of {of}"),
    ]


EFFECTS: list[Effect[Drive, Stiffness]] = [
    Effect("series_compliance", on_inputs=series_compliance,
           unknowns=[Unknown("compliance", 0, 1000, "urad/(N*m)", "1 over a stiffness; 1.4 to 530 in the catalogue")],
           looks_like="the torsion grows in proportion to the torque, alike in both senses; nothing of the mesh "
                      "itself",
           remedy="Twist a solid dummy to find the rig's share and take it off; state the rest as drive_compliance. "
                  "The torsion then fits at any torque.",
           why="cup, wave generator, its bearing and the test rig are springs in series with the mesh, and much "
               "softer",
           source=CATALOGUE),
    Effect("thin_cup", on_inputs=thin_cup,
           unknowns=[Unknown("lost", 0, 0.6, "", "share of the wall; 0.05 to 0.3 from turning, a crack or corrosion")],
           looks_like="the torsion grows in proportion to the torque, alike in both senses, as by any spring in series",
           remedy="Measure the wall of the cup and look for a crack with dye; state the wall as cup_wall, or replace "
                  "the cup, and the torsion fits.",
           why="the wall is turned too thin, or cracked, so that less of it carries the shear",
           source="Bredt: a thin tube twists as 1 over its wall"),
    Effect("soft_wave_generator", on_inputs=soft_wave_generator,
           unknowns=[Unknown("torsion", 0, 2000, "urad", "more than stated, under T_2 of the size in the catalogue")],
           looks_like="the torsion grows as the torque to the power 2/3, alike in both senses: soft at small torques, "
                      "but without a jump",
           remedy="Replace the bearing of the wave generator where its torsion has grown; of a drive that is new, "
                  "state the whole as wave_torsion_stated.",
           why="its races bend and its balls flatten more than stated, or fewer balls carry, as after wear",
           source="Hertz: balls close as load^(2/3)"),
    Effect("engaged_pairs", on_inputs=engaged_pairs,
           unknowns=[Unknown("gain", 0, 2, "", "of pairs at a large torque, over those stated; 1.7 from 15 to 40 %"),
                     Unknown("torque_scale", 0.04, 8, "",
                             f"torque after which 63 % of them have come to bear, {PARTS}")],
           looks_like="the mesh stiffens with the torque more than its flanks do, most where its teeth bend",
           remedy="State the gain as engaged_gain and its torque as engaged_torque; the mesh stiffness then fits at "
                  "small and at large torques.",
           why="the flexspline gives way under its load and lays more teeth against those of the circular spline",
           source="parallel pairs of teeth: at one torque the stiffness grows with their number to the power 1 - m"),
    Effect("oil_film", on_inputs=oil_film, needs=[SPEED, TEMPERATURE], acts_at_reference=True,
           unknowns=[Unknown("stiffness", 0, 200, "kN/um", "of a pair full of oil at 1000 rpm, 20 degC, T_2; 5 to 60")],
           looks_like="the mesh is stiffer while it turns, most at a low speed and with warm oil, by one amount at "
                      "any torque; it is lost again where it creeps, and nothing is left at rest",
           remedy="Keep the effect on for a drive that turns, and measure the flanks at rest; the mesh stiffness "
                  "there is as calculated without oil.",
           why="oil between the flanks cannot leave in time and carries beside the asperities",
           source=f"{DOWSON}; share of a film at a fixed gap: Reynolds 1886; load shared with asperities: Johnson, "
                  "K. L., Greenwood, J. A., Poon, S. Y., A simple theory of asperity contact in elastohydrodynamic "
                  "lubrication, Wear 19 (1972) 91"),
    Effect("asperity_smoothing", on_inputs=asperity_smoothing, needs=[CYCLES],
           unknowns=[Unknown("dimension", 0, 0.2, "", "by which D rises; 0.02 to 0.1"),
                     Unknown("roughness", 0, 5, "", "by which ln G falls; 0.7 to 2.3"),
                     Unknown("cycle_scale", 1e3, 1e7, "", "cycles after which 63 % is done")],
           looks_like="the mesh stiffens with the cycles, soon and then no more; the structure function falls with "
                      "them",
           remedy="Run the drive in before measuring, and map its flanks again; the mesh stiffness then no longer "
                  "changes with the cycles.",
           why="the first load cycles flatten the highest asperities of new flanks",
           source="running-in of machined surfaces: D rises and G falls"),
    Effect("modulus_temperature", on_inputs=modulus_temperature, needs=[TEMPERATURE],
           unknowns=[Unknown("softening", 0, 2e-3, "1/K", "of steel 2.5e-4 to 4e-4")],
           looks_like="torsion too large by one share when warm, of flanks, teeth and cup alike",
           remedy="Measure at one temperature of the drive, or keep the effect on in the inputs file; readings of "
                  "warm and cold days then agree.",
           why="Young's modulus falls with the temperature",
           source="handbook: elasticity of steel over temperature"),
    Effect("creep", on_results=creep, needs=[TIME],
           unknowns=[Unknown("share", 0, 0.2, "", "of the elastic torsion, per e-fold of time; 0.002 to 0.02"),
                     Unknown("time_scale", 1e-3, 10, "h", "time from which it counts")],
           looks_like="the torsion grows with time in proportion to itself, fast at first and ever more slowly",
           remedy="Check the joints, and read the torsion at a fixed time after the torque comes on; readings at one "
                  "torque then agree.",
           why="joints, bearing and bonded cup settle under a torque that stays",
           source="logarithmic creep"),
    Effect("ellipticity", on_results=ellipticity, needs=[WAVE_ANGLE], acts_at_reference=True,
           unknowns=[*parts_of_wave(1000, "urad"),
                     *parts_of_wave(0.5, "", "stiffness_", "the mesh stiffness, as a share of it")],
           parts=[("cosine", "sine"), ("stiffness_cosine", "stiffness_sine")],
           looks_like="two waves per turn of the wave generator, of the torsion at any torque, or of the mesh "
                      "stiffness",
           remedy="Measure both lobes of the wave generator and the bores it sits in, and replace what is off; the "
                  "two waves per turn are gone then.",
           why="the two lobes of the wave generator, or the bores it sits in, are not alike",
           source="second harmonic of the shape of the wave generator"),
    Effect("eccentricity", on_results=eccentricity, needs=[WAVE_ANGLE], acts_at_reference=True,
           unknowns=parts_of_wave(1000, "urad"),
           looks_like="one wave of the torsion per turn of the wave generator, at any torque",
           remedy="Centre the wave generator and its coupling on the axis of the drive; the one wave per turn is gone "
                  "then.",
           why="the wave generator, or its coupling, is off the axis of the drive",
           source="first harmonic of an eccentricity"),
    Effect("hysteresis", on_results=hysteresis, needs=[DIRECTION, REVERSAL_TORQUE, PEAK_TORQUE],
           unknowns=[Unknown("loop", 0, 2000, "urad", "whole width; 290 to 870 (1 to 3 arcmin)"), FRICTION_SCALE],
           looks_like="the torsion is smaller on the way up than on the way down at the same torque, and turns round "
                      "within a short way of it",
           remedy="If the loop is wider than the catalogue's, check the lubricant and what rubs until it is narrower. "
                  "If not, keep the effect on.",
           why="teeth, bearing and cup rub before they slip",
           source=f"{MASING}; {CATALOGUE}"),
    Effect("viscous_hysteresis", on_results=viscous_hysteresis,
           needs=[SPEED, TEMPERATURE, DIRECTION, REVERSAL_TORQUE, PEAK_TORQUE], acts_at_reference=True,
           unknowns=[Unknown("loop", 0, 2000, "urad", "whole width at 1000 rpm and 20 degC, beside that at rest"),
                     FRICTION_SCALE,
                     Unknown("thinning", 0.01, 0.08, "1/K", "of the lubricant's viscosity; 0.02 to 0.05")],
           looks_like="a loop of the torsion that is wider the faster and the colder the drive runs; none at rest",
           remedy="Warm the drive up before measuring, or use a thinner lubricant that its maker allows; the loop is "
                  "then narrower at the same speed.",
           why="the lubricant drags in proportion to its viscosity and to the speed",
           source=f"viscous drag; {MASING}"),
    Effect("lost_motion", on_results=lost_motion,
           unknowns=[Unknown("play", 0, 1000, "urad", "half of it; to 290 (1 arcmin) in catalogues"), PLAY_SCALE],
           looks_like="the torsion jumps about no torque, and is shifted in its sense by one amount at larger ones",
           remedy="If the play exceeds the catalogue's, replace the splines; the jump about no torque is then "
                  "smaller. If not, keep the effect on.",
           why="the teeth have play, which they cross one after another",
           source=CATALOGUE),
    Effect("first_load_set", on_results=first_load_set, needs=[PEAK_TORQUE],
           unknowns=[Unknown("set", 0, 300, "urad", "after a load of T_2 in the catalogue; 6 to 60"),
                     Unknown("exponent", 1, 1.5, "", "power of the peak torque"),
                     Unknown("stiffening", 0, 2, "", "of the mesh below the peak; 0.1 to 0.6")],
           parts=[("set", "exponent"), ("stiffening",)],
           looks_like="a torsion that stays when the torque goes, and grows only with a new peak; a mesh that is "
                      "stiffer below the peak than it was when it was reached",
           remedy="Load the new drive once to its highest torque and set the zero afterwards; torsion and stiffness "
                  "then repeat below that peak.",
           why="the highest asperities flow under the first load, and lie flat from then on",
           source="plastic contact of rough surfaces"),
    Effect("flank_wear", on_results=flank_wear, needs=[CYCLES],
           unknowns=[Unknown("rate", 0, 20, "um", "depth on either flank per million cycles in service"),
                     PLAY_SCALE],
           looks_like="a lost motion that grows in proportion to the cycles",
           remedy="Check the lubricant, and replace the splines when their play is too large; the lost motion is then "
                  "that of a new drive.",
           why="the flanks slide on one another with every wave",
           source=ARCHARD),
    Effect("thermal_preload", on_results=thermal_preload, needs=[TEMPERATURE],
           unknowns=[Unknown("expansion", -20, 20, "um/(m*K)",
                             "linear, of the circular spline less that of the flexspline")],
           looks_like="a lost motion that grows, or shrinks, in proportion to the temperature",
           remedy="Warm the drive up before measuring, or fit splines that expand alike; the lost motion then stays "
                  "the same.",
           why="the two splines are of different metal and move apart, or together, as they get warm",
           source="linear expansion; play of teeth that move apart, 2 tan(alpha) times the distance"),
    Effect("lateral_filter", on_inputs=lateral_filter,
           unknowns=[Unknown("width", 0, 20, "um",
                             "standard deviation of its weight; 0.187 of the cutoff of ISO 16610-21")],
           looks_like="the structure function is too low, by a share at lags below a few widths and by one amount "
                      "above",
           remedy="State the resolution of the instrument as spot_width, or measure with a finer spot; the structure "
                  "function then fits at short lags.",
           why="a stylus, a spot of light or a filter averages over the finest roughness",
           source="Gaussian weight on a power law; ISO 16610-21"),
    Effect("waviness", on_results=waviness,
           unknowns=[Unknown("square", 0, 4, "um^2", "of its amplitude A, since it enters so; A is 0.05 to 1 um"),
                     Unknown("wavelength", 3, 3000, "um", "30 to 500")],
           looks_like="the structure function has a hump at half a wavelength, and a dip at a whole one",
           remedy="Look for chatter or feed marks of this wavelength on the machine that cuts the flanks; on flanks "
                  "cut without them the hump is gone.",
           why="chatter and feed of the tool leave waves on a flank",
           source="structure function of a sine"),
    Effect("rig_drift", on_reading=rig_drift, needs=[TIME],
           unknowns=[Unknown("rate", -500, 500, "urad/h", "1 to 30")],
           looks_like="the torsion moves with time, whatever the torque, as with a sensor that drifts",
           remedy="Let the rig warm up, read the torsion at no torque now and then, and take its drift off; repeated "
                  "readings then agree.",
           why="the rig gets warm and bends",
           source="linear growth with time"),
    Effect("instrument_noise", on_reading=instrument_noise,
           unknowns=[Unknown("variance", 0, 1e4, "nm^2",
                             "square of the noise of one height, since it enters so; 1 to 2500")],
           looks_like="the structure function is too high by one amount at any lag, which is an offset",
           remedy="Average several maps of the same patch, or use a quieter instrument; the structure function then "
                  "falls by one amount at every lag.",
           why="every height has the noise of its instrument",
           source="structure function of white noise: twice its variance"),
]  # fmt: skip
