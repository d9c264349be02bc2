"""The numbers on the theory page of the harmonic drive are those that its formulas and the calculation give."""

import inspect
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.special import gamma

from harmonic_fractal.calculation import TABLE, harmonic_fractal, polyline_of
from harmonic_fractal.contact import Rough, contact_of, equivalent_modulus, patch_rms, pressed
from harmonic_fractal.estimate import noise_fit, straight_fit
from harmonic_fractal.flank import read_flank
from harmonic_fractal.generators import Waves, brownian_profiles, brownian_surface, profile_sum
from harmonic_fractal.micro import domain_factor
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.pressed import LEAST, MOST, Compared, PressedFlanks, press, slope_of
from harmonic_fractal.quantities import Drive
from harmonic_fractal.structure import log_roughness_of, structure_function, structure_sums
from harmonic_fractal.surface import without_line
from pages import EXPLAINED, Page
from published.test_harmonic_printed import default_offer, pieces
from shared import TESTS
from truing.published import compare_published

SURFACES = TESTS / "data" / "surfaces"
PAGE = Page("harmonic_fractal")
STEEL = float(equivalent_modulus(Drive()))
DIMENSIONS = (1.2, 1.4, 1.5, 1.6, 1.8)
TABLES = "areal over profile"


def power_of_ten(value: float, digits: int = 2) -> str:
    """A number as the page writes it: 1.03·10⁷."""
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa}·10{raised}"


def drive(**inputs: Any) -> dict[str, Any]:
    """The results of a drive, SI."""
    return dict(HARMONIC_FRACTAL.read_results(harmonic_fractal(HARMONIC_FRACTAL.inputs(**inputs))))


DEFAULT = drive()
NANOMETRE = {"fractal_dimension": 2.5, "fractal_roughness": 1e-9, "reference_torque": 1.0}


def constants(dimension: float, density: float = 1.5) -> dict[str, float]:
    """Equations 4 and 5, in the first form of Lambda, beside its hole at 1.5."""
    near = dimension + (1e-7 if dimension == 1.5 else 0.0)
    exponent = 4 - 2 * near
    spectral = gamma(2 * near - 3) * np.sin((2 * near - 3) * np.pi / 2) / exponent
    over_directions = gamma((5 - 2 * near) / 2) / (np.sqrt(np.pi) * gamma(3 - near))
    one = (2 * np.pi) ** exponent * spectral
    return {"profile": one / np.log(density), "one": one, "areal": one * over_directions}


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_one_surface_has_three_numbers(dimension: float) -> None:
    known, power = constants(dimension), 1 / (2 * (dimension - 1))
    pairs = [("profile", "areal"), ("profile", "one"), ("one", "areal")]
    ratios = [(known[first] / known[second]) ** power for first, second in pairs]
    assert PAGE.row(str(dimension), after=TABLES) == [f"{ratio:.3g}" for ratio in ratios]


def test_the_factor_that_is_missing() -> None:
    factors = [(2 * np.pi) ** ((2 - each) / (each - 1)) for each in DIMENSIONS]
    assert PAGE.row("$G$ too large by") == [f"{factor:.4g}" if factor > 1e3 else f"{factor:.3g}" for factor in factors]


@pytest.mark.parametrize("dimension", [1.2, 1.5, 1.8])
def test_the_exact_sum_waves_about_the_law(dimension: float) -> None:
    """Over one wave of the ripple, far from both ends of the band; finely, because it has cusps where D_s is large."""
    waves = Waves(dimension=dimension, roughness=1e-9, lowest=1.5**-60, highest=1.5**120)
    lags = np.exp(np.linspace(0.0, np.log(1.5), 20000, endpoint=False)) * 1e-6
    law = constants(dimension)["profile"] * 1e-9 ** (2 * (dimension - 1)) * lags ** (4 - 2 * dimension)
    ratio = profile_sum(waves, lags) / law
    assert ratio.mean() == pytest.approx(1.0, abs=1e-3)
    PAGE.says(f"{50 * (ratio.max() - ratio.min()):.2g} %")


def test_what_a_convention_costs() -> None:
    factor = constants(1.5)["profile"] / constants(1.5)["areal"]
    stiffness = [drive(**{**NANOMETRE, "fractal_roughness": size})["stiffness"] for size in (1e-9, factor * 1e-9)]
    PAGE.says(
        f"1 nm in the profile convention has {factor:.2f} nm in the areal one",
        f"its pair comes out **{stiffness[0] / stiffness[1]:.1f} times too stiff** at 25 N",
    )
    root = np.sqrt(structure_function(np.array([0.4e-6, 20e-6]), 1.4, 1e-11)) * 1e9
    missing = (2 * np.pi) ** (0.6 / 0.4)
    soft = drive(fractal_roughness=missing * 1e-11, reference_torque=0.1)["stiffness"]
    PAGE.says(
        f"too large by {missing:.1f} makes the pair {DEFAULT['stiffness'] / soft:.1f} times too soft",
        f"differ by {root[0]:.1f} nm, root mean square, and two points 20 µm apart by {root[1]:.1f} nm",
    )


STEPS = np.unique(np.round(np.geomspace(1, 50, 16)).astype(np.int64))
SPACING = 0.4e-6


def curve(heights: Any) -> Any:
    sums, counts = structure_sums(heights, STEPS)
    return sums.sum(axis=0) / counts.sum(axis=0)


def test_what_levelling_and_noise_do() -> None:
    """Means of 120 trials; the page is met within three standard errors and its own rounding."""
    rng = np.random.default_rng(3)
    step = float(np.asarray(structure_function(SPACING, 1.5, 1e-9)))
    found: dict[str, list[tuple[float, float]]] = {}
    parabolas, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, 500), 3))
    for _ in range(120):
        lines = brownian_profiles(1.5, step, (20, 500), rng)
        parabola = lines - lines @ parabolas @ parabolas.T
        noisy = without_line(lines + rng.normal(0.0, np.sqrt(step), lines.shape))
        for name, heights, fit in (
            ("as they are", lines, straight_fit),
            ("each line less its straight line", without_line(lines), straight_fit),
            ("each line less its parabola", parabola, straight_fit),
            ("with white noise as large as a step from point to point, less its line", noisy, straight_fit),
            ("the same, noise fitted", noisy, noise_fit),
        ):
            law = fit(STEPS * SPACING, curve(heights))
            dimension = float(2 - law.slope / 2)
            roughness = float(np.exp(log_roughness_of(law.intercept, dimension)))
            found.setdefault(name, []).append((dimension, np.log10(roughness / 1e-9)))
    for name, values in found.items():
        mean, error = np.mean(values, axis=0), 3 * np.std(values, axis=0) / np.sqrt(len(values))
        shown = [float(cell) for cell in PAGE.row(name)]
        assert shown[0] == pytest.approx(mean[0], abs=error[0] + 5e-4)
        assert shown[1] == pytest.approx(mean[1], abs=error[1] + 5e-3)
    scatter = {name: np.std(values, axis=0)[0] for name, values in found.items()}
    noisy_, fitted = list(scatter.values())[3:]
    assert fitted / noisy_ == pytest.approx(2.0, abs=0.35)
    PAGE.says("takes the bias away and doubles the scatter")


@pytest.mark.parametrize(
    ("name", "file", "direction"),
    [
        ("phase map, x", "matrix-4.txt", "x"),
        ("phase map, y", "matrix-4.txt", "y"),
        pytest.param("focus variation, x", "al3d-1.al3d", "x"),
    ],
)
def test_a_good_fit_proves_nothing(name: str, file: str, direction: str) -> None:
    if file.endswith(".al3d"):
        pytest.importorskip("SurfaceTopography")
    options = {"height_unit": "2.91818e-8 m", "spacing": "0.369862 um"} if file.endswith(".txt") else {}
    flank = read_flank(SURFACES / file, fit="all", spikes="keep", filter_width="0 um", bias="kept", **options)
    found = next(item for item in flank.estimates if item.direction == direction)
    slopes = " ".join(f"{value:.2f}" for value in found.local_dimensions)
    assert PAGE.row(name) == [f"{found.dimension:.3f}", f"{found.r_squared:.3f}", slopes]
    assert found.is_accepted is (name == "phase map, y")


PHASE_MAP = {"height_unit": "2.91818e-8 m", "spacing": "0.369862 um"}


def test_bias_interval_and_verdict_of_the_phase_map() -> None:
    used = read_flank(SURFACES / "matrix-4.txt", **PHASE_MAP).used
    assert used is not None
    low, high = used.dimension_interval
    PAGE.says(f"$D_s$ = {used.dimension:.3f} ({low:.2f} to {high:.2f}) and had {used.levelled_dimension:.3f} before")
    PAGE.says(f"lower by {-used.window_disagreement:.2f}, {-used.window_sds:.1f} standard deviations")


def test_the_interferogram_agrees_with_its_windows() -> None:
    pytest.importorskip("SurfaceTopography")
    square = {"rectangle": ["280 um", "280 um"], "fit": "all"}
    found = read_flank(SURFACES / "metropro-1.dat", **square).estimates[-1]
    PAGE.says(f"agrees ({found.window_disagreement:.3f} apart, {found.window_sds:.1f} standard deviations)")


def pressed_row(found: Compared, dimension: float) -> list[str]:
    """What the page says of heights that were pressed."""
    assert found.numbers is not None
    one = found.numbers
    ratio, scaled = found.fractal / one.stiffness, one.between / one.stiffness / found.height
    off = " to ".join(f"{value:.2g}" for value in (ratio.min(), ratio.max()))
    return [f"{dimension:.2f}", f"{one.between[-1]:.2g}", off, f"{scaled.min():.2f} to {scaled.max():.2f}"]


PRESSED: list[tuple[str, str, dict[str, Any]]] = [
    ("phase map, along y", "matrix-4.txt", PHASE_MAP),
    ("focus variation (refused, fit along x)", "al3d-1.al3d", {}),
    ("interferogram, 0.28 mm square", "metropro-1.dat", {"rectangle": ["280 um", "280 um"]}),
]


@pytest.mark.parametrize(("name", "file", "options"), PRESSED)
def test_measured_heights_are_pressed(name: str, file: str, options: dict[str, Any]) -> None:
    pytest.importorskip("ContactMechanics")
    flank = read_flank(SURFACES / file, **options)
    found = PressedFlanks().run(SimpleNamespace(inputs=Drive(surface=flank)))  # type: ignore[arg-type]
    assert PAGE.row(name) == pressed_row(found, (flank.used or flank.estimates[0]).dimension + 1.0)
    title, by_height, stiffness, gap = found.blocks()
    assert ("refused" in title.text) is (flank.used is None)  # type: ignore[union-attr]
    assert f"{found.by_height:.2g}" in by_height.text  # type: ignore[union-attr]
    assert len(stiffness.rows) == len(gap.rows) - 1 == 5  # type: ignore[union-attr]


def test_the_whole_interferogram_is_pressed(full_torture: bool) -> None:
    """640 by 480 points."""
    if not full_torture:
        pytest.skip("half a minute; with --torture=full only")
    pytest.importorskip("ContactMechanics")
    flank = read_flank(SURFACES / "metropro-1.dat")
    assert flank.used is not None
    found = PressedFlanks().run(SimpleNamespace(inputs=Drive(surface=flank)))  # type: ignore[arg-type]
    assert PAGE.row("interferogram, whole") == pressed_row(found, flank.used.dimension + 1.0)


def test_a_profile_is_compared_by_its_rms_height() -> None:
    flank = read_flank(SURFACES / "hfm-1.hfm")
    found = PressedFlanks().run(SimpleNamespace(inputs=Drive(surface=flank)))  # type: ignore[arg-type]
    assert found.numbers is None
    assert not found.warnings()
    PAGE.says(f"Its rms height is {1e9 * found.apart:.0f} nm, and at {found.load:.0f} N", f"$D$ = "
              f"{flank.estimates[0].dimension + 1:.2f}, makes a pair {found.by_height:.0f} times as stiff")  # fmt: skip


@pytest.mark.parametrize("dimension", [1.4, 1.6])
def test_a_gaussian_patch_has_the_stiffness_of_all_scales_and_not_that_of_the_model(dimension: float) -> None:
    """F/K is near 0.48 rms heights (Persson; 0.35 to 0.6 on finite patches); the model is stiffer."""
    pytest.importorskip("ContactMechanics")
    step = 1e-16
    heights = brownian_surface(dimension, step, (128, 128), np.random.default_rng(1))
    level = np.log(step) - (4.0 - 2.0 * dimension) * np.log(SPACING)
    roughness = float(np.exp(log_roughness_of(level, dimension)))
    loads = np.geomspace(LEAST, MOST, 6) * STEEL * slope_of(heights, SPACING) * heights.size * SPACING**2
    one = press(heights, SPACING, STEEL, 3e9, loads)
    contact = contact_of(Drive(), Rough(dimension=dimension + 1.0, roughness=roughness))
    found = Compared("pressed", one, np.asarray(pressed(one.between, contact).stiffness), height=float(heights.std()))
    name = f"{dimension + 1.0:.1f}"
    shown = PAGE.row(f"Brownian patch of D = {name}, 128 points square")
    assert shown == [name, *pressed_row(found, dimension + 1.0)[1:]]
    assert (np.abs(one.between / one.stiffness / heights.std() - 0.48) < 0.12).all()


def test_a_whole_drive_and_the_weight_of_its_parts() -> None:
    for size in TABLE:
        name = "20 (two of them chosen)" if size == "20" else size
        assert PAGE.row(name, after="over the catalogue's") == [", ".join(f"{ratio:.2f}" for ratio in pieces(size))]


def test_the_balls_of_the_wave_generator_are_calculated() -> None:
    offer = default_offer()
    compared = {row.published.name: row for row in compare_published(offer)}
    without = [row.ratio for name, row in compared.items() if name.endswith("nothing fitted")]
    others = [compared[f"K_2, size 20, ratio {ratio}, whole drive"].ratio for ratio in (50, 30)]
    balls = 1e6 * drive(balls=23)["ball_torsion"]
    inclined = drive(balls=23, pressure_angle=np.radians(30.0))["ball_torsion"] * 1e6 / balls
    PAGE.says(
        f"it is {balls:.0f} µrad at 25 N·m",
        f"misses the fit by a factor of {751.6 / balls:.0f}",
        f"the drive is {min(without):.1f} to {max(without):.1f} times as stiff",  # type: ignore[type-var]
        f"change $\\theta_b$ by a factor of {balls / (1e6 * drive(balls=46)['ball_torsion']):.1f} or "
        f"{balls / (1e6 * drive(balls=23, ball_diameter=8e-3)['ball_torsion']):.1f}, a flank of 30° by {inclined:.1f}",
        f"$K_2$ of ratio 50 is {others[0]:.2f} and of ratio 30 is {others[1]:.1f} times the printed one",
    )
    whole = [row for name, row in compared.items() if name.endswith("above 50, whole drive")]
    assert [each.published.obtained for each in whole].count("calibrated") == 2
    PAGE.says(f"{sum(each.matches for each in whole)} of {len(whole)} are within 5 %, two of them chosen")


def test_errors_of_dimension_and_roughness_go_together() -> None:
    rng = np.random.default_rng(1)
    step = float(np.asarray(structure_function(SPACING, 1.5, 1e-9)))
    pairs = []
    for _ in range(200):
        law = straight_fit(STEPS * SPACING, curve(brownian_profiles(1.5, step, (100, 500), rng)))
        dimension = float(2 - law.slope / 2)
        pairs.append((dimension + 1, float(np.exp(log_roughness_of(law.intercept, dimension)))))
    dimensions, roughness = np.array(pairs).T
    stiffness = drive(**{**NANOMETRE, "fractal_dimension": dimensions, "fractal_roughness": roughness})["stiffness"]
    slope_d, slope_g = slopes()
    scatter = np.std(dimensions), np.std(np.log(roughness)), np.std(np.log(stiffness))
    apart = np.hypot(slope_d * scatter[0], slope_g * scatter[1])
    assert PAGE.row("of $D$") == [f"{scatter[0]:.3f}"]
    assert PAGE.row("of $\\ln G$") == [f"{100 * scatter[1]:.0f} %"]
    assert PAGE.row("their correlation") == [f"{np.corrcoef(dimensions, np.log(roughness))[0, 1]:.3f}"]
    assert PAGE.row("of the stiffness, from pairs") == [f"{100 * scatter[2]:.1f} %"]
    start = f"$\\partial\\ln K/\\partial D = {slope_d:.1f}$, $\\partial\\ln K/\\partial\\ln G = {slope_g:.2f}$"
    PAGE.says(f"| of the stiffness, from independent error bars ({start}) | {100 * apart:.0f} % |")
    assert apart / scatter[2] > 10
    PAGE.says("Independent error bars are ten times too wide")


def slopes() -> tuple[float, float]:
    """Derivatives of ln K by D and by ln G at D = 2.5, G = 1 nm, 25 N."""
    by = 1e-5
    in_dimension = drive(**{**NANOMETRE, "fractal_dimension": np.array([2.5 - by, 2.5 + by])})["stiffness"]
    in_roughness = drive(**{**NANOMETRE, "fractal_roughness": 1e-9 * np.exp(np.array([-by, by]))})["stiffness"]
    first, second = (float(np.diff(np.log(values))[0] / (2 * by)) for values in (in_dimension, in_roughness))
    return first, second


def test_two_flanks() -> None:
    both = drive(mating_dimension=2.4, mating_roughness=1e-11)
    assert both["roughness"] / 1e-11 == pytest.approx(2 ** (1 / 0.8), rel=1e-9)
    ratio = DEFAULT["stiffness"] / both["stiffness"]
    PAGE.says(f"are one with {2 ** (1 / 0.8):.2f} times the $G$, and the pair is {ratio:.2f} times softer")


def test_one_pair() -> None:
    PAGE.says(f"{DEFAULT['equivalent_modulus'] / 1e9:.2f} GPa for steel on steel")
    yielding = drive(critical_rule="yield_onset", reference_torque=1.0)
    lower = DEFAULT["critical_pressure"] / yielding["critical_pressure"]
    more, softer = lower ** (2 / 0.4), DEFAULT["stiffness"] / yielding["stiffness"]
    assert yielding["critical_area"] / DEFAULT["critical_area"] == pytest.approx(more, rel=1e-9)
    assert round(float(more), -2) == 3800
    PAGE.says(
        f"lowers $p_c$ by {lower:.1f}, which at $D = 2.4$ raises $a'_c$ 3800 times",
        f"lowers the stiffness at 25 N {softer:.1f} times",
    )
    ends = [float(np.asarray(domain_factor(each))) for each in (2 + 1e-9, 2.4, 2.5, 3 - 1e-9)]
    assert ends[0] == pytest.approx(((1 + np.sqrt(5)) / 2) ** 2, rel=1e-6)
    assert ends[3] == pytest.approx(np.e - 1, rel=1e-6)
    PAGE.says(
        f"{ends[0]:.3f} at $D\\to2$ (the square of the golden section)",
        f"{ends[1]:.3f} at 2.4, {ends[2]:.3f} at 2.5, $e-1$ at $D\\to3$",
        f"Below $F_c = F(a'_L = a'_c)$, {DEFAULT['plastic_limit'] * 1e6:.1f} µN with the defaults",
        f"{drive(tip_rule='scaled')['tip_factor']:.2f} at 2.4",
    )


def test_stiffness_over_the_load() -> None:
    loads = [float(cell) for cell in PAGE.row("$F$, N")]
    stiffness = [drive(pair_load=load)["stiffness"] for load in loads]
    assert PAGE.row("$K$, N/m") == [power_of_ten(float(value)) for value in stiffness]
    PAGE.says(
        f"is {DEFAULT['load_exponent']:.3f} at 25 N",
        f"it tends to $(D-1)/(4-D)$, {(2.4 - 1) / (4 - 2.4):.3f}, for",
    )


def test_clearance() -> None:
    rough = drive(**NANOMETRE)
    assert PAGE.row("`amplitude`")[1] == f"{rough['clearance'] * 1e9:.0f} nm"
    assert (
        PAGE.row("`interference`")[1]
        == f"{drive(**NANOMETRE, clearance_rule='interference')['clearance'] * 1e9:.0f} nm"
    )
    patch = [drive(**NANOMETRE, clearance_rule="patch", pair_load=load)["clearance"] for load in (5.0, 50.0)]
    assert patch[0] == patch[1]
    grown = [drive(pair_load=load)["clearance"] * 1e9 for load in (5.0, 25.0, 100.0)]
    PAGE.says(f"from {grown[0]:.0f} nm at 5 N to {grown[1]:.0f} nm at 25 N and {grown[2]:.0f} nm at 100 N")
    open_, closed = DEFAULT["open_clearance"] * 1e9, DEFAULT["approach"] * 1e9
    PAGE.says(f"With the defaults {open_:.0f} nm, closed by {closed:.0f} nm at 25 N")
    minutes = np.degrees(2 * 0.2e-6 / (25.4e-3 * np.cos(np.radians(20.0)))) * 60
    PAGE.says(f"a clearance of 0.2 µm is {minutes:.2f} arc minutes")


@pytest.mark.parametrize(
    ("size", "text", "dimension", "roughness"),
    [
        ("14", "2.4, 10⁻¹¹ m", 2.4, 1e-11), ("20", "2.4, 10⁻¹¹ m", 2.4, 1e-11), ("20", "2.5, 10⁻⁹ m", 2.5, 1e-9),
        ("32", "2.5, 10⁻⁹ m", 2.5, 1e-9),
    ],
)  # fmt: skip
def test_beside_the_catalogue(size: str, text: str, dimension: float, roughness: float) -> None:
    settings = {
        "catalogue_size": size, "pitch_radius": 1.27e-3 * float(size), "torque": TABLE[size][1],
        "fractal_dimension": dimension, "fractal_roughness": roughness, "reference_torque": 0.01,
    }  # fmt: skip
    rough, bent = drive(**settings), drive(**settings, tooth_stiffness=2e7)
    printed = TABLE[size][2]["above 50"][1] * 1e3
    shares = [100 * printed / float(each["mesh_stiffness"]) for each in (rough, bent)]
    assert PAGE.row(f"{size} | {text}")[1:] == [
        f"{float(rough['largest_pair_force']):.0f}",
        power_of_ten(float(rough["mesh_stiffness"])),
        power_of_ten(float(bent["mesh_stiffness"])),
        power_of_ten(printed, 1),
        f"{shares[0]:.2f} %, {shares[1]:.1f} %",
    ]
    assert shares[0] < 1.0


def test_the_torsion_beside_that_of_the_catalogue() -> None:
    PAGE.says(f"it is {100 * DEFAULT['rough_share']:.2f} % for size 20 with the defaults")
    rougher = drive(**{**NANOMETRE, "reference_torque": 0.05})
    PAGE.says(f"and {100 * rougher['rough_share']:.1f} % with $D = 2.5$, $G = 1$ nm counted from 50 mN·m")
    printed = polyline_of("20", 100.0)
    assert printed is not None
    torque = np.linspace(0.5, 50.0, 100)
    terms, turned = np.stack([torque, torque**0.125 / 0.125], axis=1), np.asarray(printed.torsion(torque))
    weights = np.linalg.lstsq(terms, turned, rcond=None)[0]
    rest = np.sqrt(np.mean((terms @ weights - turned) ** 2))
    PAGE.says(f"fits size 20 up to $2T_2$ within {rest * 1e6:.0f} µrad of {turned[-1] * 1e6:.0f}")
    alone = float(DEFAULT["mesh_stiffness"]) / 25.0**0.875
    PAGE.says(
        f"$\\kappa = {1e-4 / weights[1]:.1f}\\cdot10^4$",
        f"$2.8\\cdot10^6$: {alone * weights[1]:.0f} times stiffer",
    )
    assert alone == pytest.approx(2.8e6, abs=0.05e6)


def test_the_range_of_validity_and_where_the_torsion_may_begin() -> None:
    first = TABLE["20"][0] / (TABLE["20"][2]["50"][0] * 1e3)
    least = [float(drive(**more)["plastic_torque"]) for more in ({}, NANOMETRE)]
    PAGE.says(
        f"that is {float(DEFAULT['resolved_share']):.3f} of the sampling interval",
        f"$T_1/K_1 = {first * 1e4:.1f}\\cdot10^{{-4}}$ rad here",
        f"({least[0] * 1e6:.0f} µN·m with the defaults, {least[1] * 1e3:.1f} mN·m with",
    )


def test_beside_contact_over_all_scales() -> None:
    for settings, text in (
        (NANOMETRE, "that is {:.1f} times softer than (12) at"),
        ({}, "and {:.1f} times softer with"),
    ):
        found = drive(**settings)
        height = patch_rms(Rough(dimension=found["dimension"], roughness=found["roughness"]), 0.2e-3, 1.5)
        PAGE.says(text.format(float(found["stiffness"] / (25.0 / (0.48 * height)))))


def test_every_option_of_a_measured_surface_is_in_its_table() -> None:
    text = (EXPLAINED.parent / "how-to" / "read_a_measured_surface.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| (`[^|]+`) \| ([^|]*) \|", text[text.index("## Options") :], re.MULTILINE))
    named = {name: default for names, default in rows.items() for name in re.findall(r"`(\w+)`", names)}
    taken = {name: item for name, item in inspect.signature(read_flank).parameters.items() if name != "path"}
    assert list(named) == list(taken)
    for name, item in taken.items():
        if isinstance(item.default, bool):
            assert named[name] == f"`{str(item.default).lower()}`"
        elif isinstance(item.default, int):
            assert named[name] == str(item.default)
        elif item.default:
            assert named[name] == f'`"{item.default}"`'
