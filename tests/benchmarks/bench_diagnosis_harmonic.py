"""How often is what is wrong with a harmonic drive, or a flank, found and named? Every effect hidden in fresh records.

Run it: ``python tests/benchmarks/bench_diagnosis_harmonic.py --cases 40 --seed 1000``. A quarter of the cases hides
nothing, a quarter something that nobody registered, and half of them one effect at a size drawn between half and the
whole of a clear one, on every noise, with all columns written down. A name counts if it is the verdict alone or another
name of its curve. Prints counts, the names of what went wrong, how often an interval held the truth, and the error on
rows that were not fitted over that of the truth itself. ``--catalogue`` asks for every size and ratio of the catalogue
instead: which causes carry the torsion, and with what shares.
"""

import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402

from benchmarks.diagnosis_tally import Tally, parsed  # noqa: E402
from hidden_effects.harmonic_asking import diagnosed  # noqa: E402
from hidden_effects.harmonic_cases import Case, Wish, make_case  # noqa: E402
from hidden_effects.harmonic_machine import MESH, TORSION, Array, Rows  # noqa: E402
from hidden_effects.harmonic_surface import SurfaceCase, SurfaceWish, make_surface, true_structure  # noqa: E402
from hidden_effects.noises import KINDS  # noqa: E402
from hidden_effects.plugin_asking import Answer  # noqa: E402

Wishes = Wish | SurfaceWish
CLEAR: list[tuple[str, dict[str, float], str]] = [  # effect, unknowns, result in which it shows
    ("series_compliance", {"compliance": 12}, TORSION),
    ("engaged_pairs", {"gain": 1.8, "torque_scale": 0.8}, MESH),
    ("oil_film", {"stiffness": 0.03}, MESH),
    ("asperity_smoothing", {"dimension": 0.03, "roughness": 0.6, "cycle_scale": 2e5}, MESH),
    ("modulus_temperature", {"softening": 8e-4}, TORSION),
    ("creep", {"share": 0.03, "time_scale": 0.1}, TORSION),
    ("ellipticity", {"cosine": 20, "sine": -25}, TORSION),
    ("ellipticity", {"stiffness_cosine": 0.08, "stiffness_sine": 0.06}, MESH),
    ("eccentricity", {"cosine": -16, "sine": 20}, TORSION),
    ("hysteresis", {"loop": 200, "torque_scale": 0.16}, TORSION),
    ("viscous_hysteresis", {"loop": 100, "torque_scale": 0.2, "thinning": 0.03}, TORSION),
    ("lost_motion", {"play": 60, "torque_scale": 0.12}, TORSION),
    ("first_load_set", {"set": 40, "exponent": 1.2}, TORSION),
    ("first_load_set", {"stiffening": 0.3}, MESH),
    ("flank_wear", {"rate": 1.0, "torque_scale": 0.08}, TORSION),
    ("thermal_preload", {"expansion": 3}, TORSION),
    ("rig_drift", {"rate": 6}, TORSION),
    ("waviness", {"square": 0.01, "wavelength": 25}, ""),
    ("instrument_noise", {"variance": 100}, ""),
    ("lateral_filter", {"width": 0.8}, ""),
]
SHAPES = {"torque_scale", "thinning", "exponent", "time_scale", "cycle_scale", "wavelength"}
OF_ITS_OWN = {"lost_motion": "torque_scale", "flank_wear": "torque_scale", "creep": "time_scale"}
STIFFNESS = {  # of the catalogues, kN m/rad, by size and ratio (100 stands for all above 50), and where it changes, N m
    "14": ((2.0, 6.9), {30: (1.9, 2.4, 3.4), 50: (3.4, 4.7, 5.7), 100: (4.7, 6.1, 7.1)}),
    "17": ((3.9, 12.0), {30: (3.4, 4.4, 6.7), 50: (8.1, 11.0, 13.0), 100: (10.0, 14.0, 16.0)}),
    "20": ((7.0, 25.0), {30: (5.7, 7.1, 11.0), 50: (13.0, 18.0, 23.0), 100: (16.0, 25.0, 29.0)}),
    "25": ((14.0, 48.0), {30: (10.0, 13.0, 21.0), 50: (25.0, 34.0, 44.0), 100: (31.0, 50.0, 57.0)}),
    "32": ((29.0, 108.0), {30: (24.0, 30.0, 49.0), 50: (54.0, 78.0, 98.0), 100: (67.0, 110.0, 120.0)}),
    "40": ((54.0, 196.0), {50: (100.0, 140.0, 180.0), 100: (130.0, 200.0, 230.0)}),
    "50": ((108.0, 382.0), {50: (200.0, 280.0, 340.0), 100: (250.0, 400.0, 440.0)}),
    "58": ((168.0, 598.0), {50: (310.0, 440.0, 540.0), 100: (400.0, 610.0, 710.0)}),
}


def fifth_order(rows: Rows) -> Array:
    """A wave that nobody registered."""
    return 12 * np.sin(5 * np.radians(rows.wave_angle) + 0.4)


def stiff_when_hot_and_fast(rows: Rows) -> Array:
    """A product of two conditions."""
    return 2.5e5 * (rows.temperature - 30) / 30 * (rows.speed - 1000) / 1000


def feed_marks(at: Array) -> Array:
    """Steps across a flank."""
    return np.asarray(0.06 * np.sign(np.sin(2 * np.pi * at / 9 + 1)))


def wished(seed: int) -> Wishes:
    """The case of a seed."""
    rng = np.random.default_rng([seed, 37])
    kind = KINDS[int(rng.integers(len(KINDS)))]
    points: dict[str, Any] = {"design": "points", "results": (MESH,)}
    if seed % 4 == 0:
        which = int(rng.integers(3))
        return SurfaceWish(seed=seed) if which == 2 else Wish(seed=seed, kind=kind, **(points if which else {}))
    if seed % 4 == 2:
        which = int(rng.integers(3))
        if which == 2:
            return SurfaceWish(seed=seed, strange=feed_marks)
        if which == 1:
            return Wish(seed=seed, kind=kind, strange=stiff_when_hot_and_fast, **points)
        return Wish(seed=seed, kind=kind, strange=fifth_order)
    name, unknowns, result = CLEAR[seed // 2 % len(CLEAR)]
    share = rng.uniform(0.5, 1.0)
    hidden = {name: {key: value if key in SHAPES else share * value for key, value in unknowns.items()}}
    if not result:
        return SurfaceWish(seed=seed, hidden=hidden)
    tooth = 2e7 if name == "engaged_pairs" else np.inf
    return Wish(seed=seed, kind=kind, hidden=hidden, tooth=tooth, **(points if result == MESH else {}))


def judge(seed: int, tally: Tally) -> None:
    """Ask one case and count what was said."""
    wish = wished(seed)
    case = make_case(wish) if isinstance(wish, Wish) else make_surface(wish)
    answer = diagnosed(case)
    said = tally.count(wish, answer.document, answer.seconds)
    if wish.hidden:
        tally.left.append(left_over(case, answer))
    if said == "named":
        (cause,) = answer.document["causes"]
        tally.cover(wish, cause, without={OF_ITS_OWN.get(cause["effect"], "")})


def left_over(case: Case | SurfaceCase, answer: Answer) -> float:
    """Error on the rows that were not fitted over that of the truth."""
    (name,) = case.wish.results
    if isinstance(case, Case):
        true, scale = case.held_true[name], np.ones(len(case.held))
    else:
        true, scale = true_structure(case.wish, case.held.lag), case.held.sigma_structure_function
    read = case.held_readings[name]
    left, least = (np.mean(((read - values) / scale) ** 2) for values in (answer.predicted[name], true))
    return float(np.sqrt(left / least))


# The catalogue


def catalogue(seed: int) -> None:
    """Ask what carries the torsion of every drive of the catalogue; flanks as by default, all else rigid."""
    for size, (changes, by_ratio) in STIFFNESS.items():
        for ratio, stiff in by_ratio.items():
            document, rough = asked(size, ratio, drawn_line(changes, stiff, np.random.default_rng([seed, ratio])))
            causes = ", ".join(f"{each['effect']} {100 * each['share']:.0f} %" for each in document["causes"])
            others = "; ".join(" + ".join(each["causes"]) for each in document["alternatives"])
            print(f"  {size:>3} {ratio:>4}: flanks {rough:.2%}; {causes or document['verdict']}; or {others or 'none'}")


def drawn_line(changes: tuple[float, float], stiff: tuple[float, ...], rng: np.random.Generator) -> tuple[Array, Array]:
    """Torques, N m, to twice the second change, and torsions, urad, with 10 urad of scatter."""
    torque = np.round(changes[1] / 50 * np.arange(1, 101), 4)
    ends = np.array([0.0, *changes, 3 * changes[1]])
    angles = np.concatenate([[0.0], np.cumsum(np.diff(ends) / (1e-3 * np.array(stiff)))])
    return torque, np.interp(torque, ends, angles) + 10 * rng.standard_normal(len(torque))


def asked(size: str, ratio: int, read: tuple[Array, Array]) -> tuple[dict[str, Any], float]:
    """What the diagnosis says to a record, and the share of the torsion that the flanks alone explain."""
    from truing.diagnosis.engine import diagnose
    from truing.diagnosis.reading import read_records
    from truing.inputs_file import read_setup
    from truing.kernel import Kernel
    from truing.runs.diagnosis_document import diagnosis_document

    offer = Kernel.installed().offer("harmonic_fractal")
    larger = int(size) / 20
    text = (
        f'[inputs]\ncatalogue_size = "{size}"\npitch_radius = "{25.4 * larger:g} mm"\n'
        f'face_width = "{10 * larger:g} mm"\nflank_height = "{0.4 * larger * 100 / ratio:g} mm"\n'
        f"flexspline_teeth = {2 * ratio}\nengaged_pairs = {2 * int(0.3 * ratio)}\n"
    )
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "inputs.toml").write_text(text, encoding="utf-8")
        rows = "".join(
            f"{torque!r},{angle!r}\n" for torque, angle in zip(*(part.tolist() for part in read), strict=True)
        )
        (folder / "measured.csv").write_text("torque [N*m],torsion [urad]\n" + rows, encoding="utf-8")
        setup = read_setup(folder / "inputs.toml", offer)
        found = diagnose(setup, read_records([folder / "measured.csv"], offer, setup))
        document = diagnosis_document(found)
    left = document["wrong"]["torsion"]["rmse"]["value"]
    return document, 1 - left / float(np.sqrt(np.mean(read[1] ** 2)))


def main() -> None:
    """Read the options and run."""
    options = parsed(__doc__, 40, catalogue="ask for the drives of the catalogue instead")
    if options.catalogue:
        catalogue(options.seed)
        return
    tally = Tally()
    for seed in range(options.seed, options.seed + options.cases):
        judge(seed, tally)
    tally.tell()


if __name__ == "__main__":
    main()
