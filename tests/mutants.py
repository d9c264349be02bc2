"""Would the tests notice a wrong number? Change one line of the code at a time, and run the tests that should fail.

``python tests/mutants.py`` applies every change of ``MUTANTS``, one after another, to a copy of this checkout, runs the
test files that are named beside it and stops at the first failure. A change is *caught* where a test fails, *survived*
where all pass, and *stale* where the code no longer reads as it is written here. Last come the counts; the exit code is
1 unless every change was caught. ``--only WORDS`` takes those whose file, text or tests hold one of the words;
``--unchanged`` runs the named tests without any change: they must pass, or a catch means nothing.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

ROOT = Path(__file__).parents[1]
COPIED = ("kernel", "plugins", "templates", "tests", "docs", "pyproject.toml", "README.md", "LICENSE")
LEFT_OUT = shutil.ignore_patterns("__pycache__", ".*", "site", "browser")
LONGEST_RUN_S = 600.0
FIRST_TIME = 1_000_000_000
"""Seconds since 1970 that a changed file is given as its time, one more with every change: Python compiles it anew."""
State = Literal["caught", "survived", "stale", "no tests", "too slow"]


@dataclass(frozen=True)
class Mutant:
    """One change: in ``file`` the text ``old``, which stands there once, becomes ``new``; ``tests`` should fail."""

    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    @property
    def words(self) -> str:
        """The change in one line."""
        return f"{self.file}: {self.old}  ->  {self.new}"


def changes(file: str, tests: str, *texts: tuple[str, str]) -> Iterator[Mutant]:
    """Give the changes of one file, as (old, new), that the same tests should notice; tests are parted by blanks."""
    for old, new in texts:
        yield Mutant(file, old, new, tuple(f"tests/{name}" for name in tests.split()))


MUTANTS: tuple[Mutant, ...] = (
    *changes(
        "kernel/truing/units/__init__.py", "unit/test_units.py",
        ("plain = plain - known.offset", "plain = plain + known.offset"),
        ("return scaled + known.offset if known.offset", "return scaled - known.offset if known.offset"),
        ("si / (2 * math.pi):.7g} 1/s", "si / math.pi:.7g} 1/s"),
    ),
    *changes(
        "kernel/truing/units/meaning.py", "unit/test_units.py",
        ("own.factor * 10.0**power if power >= 0", "own.factor * 10.0**-power if power >= 0"),
        ("angle += exponent * part.angle", "angle += part.angle"),
    ),
    *changes(
        "kernel/truing/fits.py", "unit/test_fits.py",
        ("if size_mm <= limit * _SAME:", "if size_mm < limit / _SAME:"),
    ),
    *changes(
        "kernel/truing/numbers.py", "unit/test_units.py",
        ('"-" if match["sign"] == "-" else ""', '"" if match["sign"] == "-" else ""'),
    ),
    *changes(
        "kernel/truing/formulas/evaluation.py", "unit/test_formulas.py",
        ("reversed(list(zip(arguments[:-1:2]", "list(list(zip(arguments[:-1:2]"),
        ('"inv": lambda x: np.tan(x) - x', '"inv": lambda x: np.tan(x) + x'),
    ),
    *changes(
        "kernel/truing/declare/spreads.py", "unit/test_declare.py unit/test_studies_reliability.py",
        ('"band": amount / 2 / half_to_sd', '"band": amount / half_to_sd'),
        ("log_variance / 2 + np.sqrt", "log_variance + np.sqrt"),
        ("target.nominal + (low + high) / 2", "target.nominal + (high - low) / 2"),
        ('12**0.5 if self.shape == "uniform"', '3**0.5 if self.shape == "uniform"'),
        ("self.width * (ndtr(standard) - 0.5)", "self.width * ndtr(standard)"),
        ("_positive(quantity.value, self.amount) / 100", "_positive(quantity.value, self.amount) / 10"),
    ),
    *changes(
        "kernel/truing/declare/builtin.py", "unit/test_builtin_effects.py",
        ('own["order"] * observed', "1.0 * observed"),
        ('observed >= own["after"], 1.0, 0.0', 'observed >= own["after"], 0.0, 1.0'),
    ),
    *changes(
        "kernel/truing/prices.py", "unit/test_prices.py",
        ("price.at(next(iter(inner.values())).width)", "price.at(next(iter(inner.values())).sd)"),
    ),
    *changes(
        "kernel/truing/published.py", "unit/test_published_known.py end_to_end/test_cli_verify.py",
        ("value / number.value if number.value", "number.value / value if number.value"),
    ),
    *changes(
        "kernel/truing/measurements/derived.py", "unit/test_gauge.py",
        ("np.cumsum(np.abs(np.diff(values)))", "np.cumsum(np.diff(values))"),
        ("turned_at[turns + 1] = turns", "turned_at[turns + 1] = turns + 1"),
    ),
    *changes(
        "kernel/truing/studies/checks.py", "unit/test_studies_reliability.py",
        ("square / (4 * draws * draws)", "square / (2 * draws * draws)"),
        ("np.where(above > 0, ndtr(-above)", "np.where(above > 0, ndtr(above)"),
        ("return values - beside(limit, values)", "return values + _beside(limit, values)"),
    ),
    *changes(
        "kernel/truing/studies/checks.py", "unit/test_calculation.py",
        ("return distance / abs(limit) if limit", "return distance / limit if limit"),
        ("(limit.high - limit.low) / 2", "(limit.high - limit.low)"),
    ),
    *changes(
        "kernel/truing/studies/first_order.py", "unit/test_studies_allocation.py",
        ("mean = value + sum(", "mean = value - sum("),
    ),
    *changes(
        "kernel/truing/studies/sampling.py", "unit/test_studies_reliability.py",
        ("self.squares / (self.count - 1)", "self.squares / (self.count + 1)"),
        ("apart * apart * (first.count", "apart * (first.count"),
        ("first.mean + apart * (second.count / count)", "first.mean + apart * (first.count / count)"),
    ),
    *changes(
        "kernel/truing/studies/sampling.py", "unit/test_studies_reliability.py unit/test_studies_sensitivity.py",
        ("np.sqrt(np.clip(values, 0.0, None))", "np.clip(values, 0.0, None)"),
    ),
    *changes(
        "kernel/truing/studies/sensitivity.py", "unit/test_studies_sensitivity.py",
        ("{source: value / whole for source", "{source: value / whole**0.5 for source"),
        ("sd[result] = max(whole, 0.0) ** 0.5", "sd[result] = max(whole, 0.0)"),
    ),
    *changes(
        "kernel/truing/studies/first_order.py", "unit/test_studies_sensitivity.py",
        ("central = (up - down) / (above - below)", "central = (up - centre) / above"),
        ("for power in (2.0, 4.0):", "for power in (4.0, 16.0):"),
    ),
    *changes(
        "kernel/truing/studies/first_order.py", "unit/test_studies_reliability.py",
        ("max(0.0, 1.0 - missed)", "max(0.0, 1.0 - missed / 2)"),
    ),
    *changes(
        "kernel/truing/studies/reliability.py", "unit/test_studies_reliability.py",
        ("(value * (1 - value) / draws) ** 0.5", "(value * (1 - value) / draws)"),
    ),
    *changes(
        "kernel/truing/studies/sweep.py", "unit/test_studies_sensitivity.py",
        ("np.floor(axis[-1]) + 1", "np.floor(axis[-1])"),
    ),
    *changes(
        "kernel/truing/studies/allocation.py", "unit/test_studies_allocation.py",
        ("self.variances[demand] * (width / self.start) ** 2", "self.variances[demand] * (width / self.start)"),
        ("paid.imag / (COMPLEX_STEP * widths)", "paid.imag / COMPLEX_STEP"),
        ("GRADES[coarsest - 1]", "GRADES[coarsest - 2]"),
        ("return float((reach * 10.0**log_sd) ** 2)", "return float(reach * 10.0**log_sd)"),
    ),
    *changes(
        "kernel/truing/studies/optimise.py", "unit/test_studies_optimise.py",
        ("mean = mean + slopes[column] * beside(shift", "mean = mean - slopes[column] * beside(shift"),
        ("beside(own[column].sd, slopes[column])) ** 2", "beside(own[column].sd, slopes[column]))"),
        ("(1.0 - scaled.sum(axis=1))", "(scaled.sum(axis=1) - 1.0)"),
        ("(REFERENCE - order[:, 0])", "(order[:, 0])"),
    ),
    *changes(
        "kernel/truing/studies/surrogate.py", "unit/test_studies_surrogate.py",
        ("self.low + (self.high - self.low) * shares", "self.low + self.high * shares"),
        ("np.exp(values) if self.logarithmic", "values if self.logarithmic"),
    ),
    *changes(
        "kernel/truing/diagnosis/noise.py", "unit/test_diagnosis_sample.py unit/test_diagnosis_memory.py",
        ("1 + self.theta**2 - 2 * self.rho * self.theta", "1 + self.theta**2 + 2 * self.rho * self.theta"),
        ("white[1:] -= setting.rho * values[:-1]", "white[1:] -= 0.9 * setting.rho * values[:-1]"),
        ("return 1.4826 * float(np.median(", "return 1.0 * float(np.median("),
        ("begin = white * np.sqrt(ratio)", "begin = white * ratio"),
    ),
    *changes(
        "kernel/truing/diagnosis/gain.py", "unit/test_diagnosis_gain_design.py",
        ("(before2 - after2) / reducible", "(before2 - after2) / before2"),
        ("(1 + (flipped >= least).sum()) / (1 + FLIPS)", "(flipped >= least).sum() / FLIPS"),
        ("gammaln(freedom / 2) - 0.5 * log(pi * (freedom - 2))", "gammaln(freedom / 2) - 0.5 * log(pi * freedom)"),
    ),
    *changes(
        "kernel/truing/diagnosis/intervals.py", "unit/test_diagnosis_fit.py",
        ("QUANTILE = 0.975", "QUANTILE = 0.9"),
        ("log1p(student**2 * certainty.variance / known)", "log1p(student * certainty.variance / known)"),
    ),
    *changes(
        "kernel/truing/diagnosis/findings.py", "unit/test_diagnosis_alarms.py",
        ("1 - floor**2 / rmse**2", "1 - floor / rmse"),
    ),
    *changes(
        "kernel/truing/diagnosis/extended.py", "unit/test_diagnosis_memory.py",
        ("key=lambda i: causes[i].tag)", "key=lambda i: 0)"),
        ("groups.setdefault((tags, b", "groups.setdefault((tags[:1], b"),
    ),
    *changes(
        "kernel/truing/diagnosis/exact.py", "unit/test_diagnosis_memory.py",
        ("predicted=predicted, slopes={}, moves={})", "slopes={}, moves={})"),
    ),
    *changes(
        "kernel/truing/diagnosis/visibility.py", "unit/test_diagnosis_gain_design.py",
        ("1 - LEVEL / (2 * max(explanations, 1))", "1 - LEVEL / (2 * 1)"),
    ),
    *changes(
        "kernel/truing/diagnosis/unit_errors.py", "unit/test_diagnosis_reading.py",
        ("> FAR_OFF * _size(values, mode)", "> 30 * FAR_OFF * _size(values, mode)"),
        ("best = max(gains, key=gains.__getitem__", "best = min(gains, key=gains.__getitem__"),
    ),
    *changes(
        "kernel/truing/diagnosis/sample.py", "unit/test_diagnosis_sample.py",
        ("(self.freedom + 1) / (self.freedom + left**2 / square)", "(self.freedom + 1) / (self.freedom + left**2)"),
    ),
    *changes(
        "kernel/truing/runs/diagnosis_document.py", "unit/test_diagnosis_document.py",
        ("for end in (low, high)]}", "for end in (low, low)]}"),
    ),
    *changes(
        "kernel/truing/explain.py", "end_to_end/test_explain.py",
        ("(unknown.low * unknown.high) ** 0.5", "unknown.low * unknown.high"),
    ),
    *changes(
        "plugins/gear_geometry/roots.py", "published/test_gear_geometry.py",
        ("return 6.0 * arm.height", "return 5.9 * arm.height"),
        ("(1.2 + 0.13 * slenderness)", "(1.2 + 0.12 * slenderness)"),
    ),
    *changes(
        "plugins/gear_geometry/mesh_load.py",
        "published/test_rv_gearing_factors.py published/test_effects_of_machines.py",
        ("2.0 * np.sqrt(held)", "1.9 * np.sqrt(held)"),
    ),
    *changes(
        "plugins/harmonic_fractal/contact.py", "unit/test_harmonic_contact.py",
        ("(1.0 - second.poisson_ratio**2)", "(1.0 + second.poisson_ratio**2)"),
        ("tip * modulus * np.sqrt(2.0 / np.pi)", "tip * modulus * np.sqrt(1.0 / np.pi)"),
    ),
    *changes(
        "plugins/harmonic_fractal/micro.py", "unit/test_harmonic_contact.py",
        ("return np.exp(size), real", "return np.exp(-size), real"),
        ("+ law.decay / np.expm1(law.decay * above)", "+ law.decay * np.expm1(law.decay * above)"),
    ),
    *changes(
        "plugins/harmonic_fractal/mesh.py", "unit/test_harmonic_mesh.py",
        ("self.start * (1.0 - self.gain * np.expm1", "self.start * (1.0 + self.gain * np.expm1"),
        ("np.cos(0.5 * np.pi * way) ** 2", "np.cos(0.5 * np.pi * way)"),
    ),
    *changes(
        "plugins/harmonic_fractal/generators.py", "unit/test_harmonic_generators.py",
        ("2.0 * amplitudes**2 @", "1.0 * amplitudes**2 @"),
        ("(k + 1.0) ** exponent - 2.0 * k**exponent", "(k + 1.0) ** exponent - 1.0 * k**exponent"),
    ),
    *changes(
        "plugins/harmonic_fractal/structure.py", "unit/test_harmonic_structure.py published/test_harmonic_effects.py",
        ("roughness * ratio ** (1.0 / (2.0", "roughness * ratio ** (1.0 / (1.0"),
        ("scale * x ** (-exponent / 2.0), 1.0)", "scale * x ** (exponent / 2.0), 1.0)"),
    ),
    *changes(
        "plugins/harmonic_fractal/estimate.py", "unit/test_harmonic_estimate.py",
        ("2.0 - slopes / 2.0", "2.0 - slopes"),
        ("curve.pooled - 2.0 * noise**2", "curve.pooled - 1.0 * noise**2"),
    ),
    *changes(
        "plugins/harmonic_fractal/made_flank.py", "unit/test_harmonic_generators.py",
        ("single / share ** (1.0 / (2.0 - exponent))", "single * share ** (1.0 / (2.0 - exponent))"),
        ("np.log10(found.roughness / truth.areal)", "np.log(found.roughness / truth.areal)"),
    ),
    *changes(
        "plugins/harmonic_fractal/uncertainty.py", "unit/test_harmonic_uncertainty.py",
        ("rough.roughness * np.exp(pairs[:, 1])", "rough.roughness * np.exp(-pairs[:, 1])"),
        ("np.log(both.roughness / middle.roughness)", "np.log(middle.roughness / both.roughness)"),
    ),
    *changes(
        "plugins/harmonic_fractal/effects.py", "published/test_effects_of_machines.py",
        ("1.0 - 2.0 * np.exp(-way)", "1.0 - np.exp(-way)"),
    ),
    *changes(
        "plugins/press_linkage/kinematics.py", "published/test_press_linkage_by_hand.py",
        ("(2.0 * press.slider_half_width)", "press.slider_half_width"),
        ("0.5 * (half_1.face + half_2.face)", "(half_1.face + half_2.face)"),
    ),
    *changes(
        "plugins/press_linkage/effects.py", "published/test_effects_of_machines.py",
        ("expansion_1 * warmer, expansion_2 * warmer", "expansion_2 * warmer, expansion_1 * warmer"),
        ("-rise * np.expm1(-time / time_constant)", "rise * np.expm1(-time / time_constant)"),
        ("mass_compliance * by_angle * (TURN * speed) ** 2", "mass_compliance * by_angle * speed**2"),
    ),
    *changes(
        "plugins/press_linkage/answers.py", "published/test_press_linkage_model.py",
        ('"knee_along": 0.5 + shorter', '"knee_along": 0.5 - shorter'),
    ),
    *changes(
        "plugins/roller_screw_shift/geometry.py", "published/test_roller_screw_geometry.py",
        ("2.0 * geometry.mounted_distance * opened", "geometry.mounted_distance * opened"),
        ("2.0 * geometry.roller.tip_radius * half", "geometry.roller.tip_radius * half"),
    ),
    *changes(
        "plugins/roller_screw_shift/calculation.py", "published/test_roller_screw_model.py",
        ("0.5 * pair.roller_teeth * sine**2", "pair.roller_teeth * sine**2"),
    ),
    *changes(
        "plugins/roller_screw_shift/objectives.py", "published/test_roller_screw_model.py",
        ("(0.5 * _width(reach)) ** -2", "(0.5 * _width(reach)) ** -1"),
        ("(turn - np.sin(turn))", "(turn + np.sin(turn))"),
    ),
    *changes(
        "plugins/roller_screw_shift/effects.py", "published/test_effects_of_machines.py",
        ("+ at_ring_tip**2", "- at_ring_tip**2"),
    ),
    *changes(
        "plugins/rv_gearing/geometry.py", "published/test_rv_gearing_factors.py",
        ("2.0 * stage.module * (stage.dedendum - gear.shift)", "2.0 * stage.module * (stage.dedendum + gear.shift)"),
        ("contact / np.cos(base_helix) ** 2", "contact / np.cos(base_helix)"),
    ),
    *changes(
        "plugins/rv_gearing/load_factors.py", "published/test_rv_gearing_factors.py",
        ("- 0.24188 * x_2 / second", "- 0.44188 * x_2 / second"),
        ("tooth * (0.75 * contact_ratio + 0.25)", "tooth * (0.85 * contact_ratio + 0.15)"),
    ),
    *changes(
        "plugins/rv_gearing/rating.py", "published/test_rv_gearing_strength.py",
        ("* (u + 1.0) / u", "* (u - 1.0) / u"),
    ),
    *changes(
        "plugins/rv_wear/geometry.py", "published/test_rv_wear_mesh.py",
        ("curvature(mesh, angle) + mesh.pin_radius", "curvature(mesh, angle) - mesh.pin_radius"),
        ("3.0 * square * (pins - 1) / (pins + 1)", "3.0 * square * (pins + 1) / (pins - 1)"),
    ),
    *changes(
        "plugins/rv_wear/calculation.py", "published/test_rv_wear_backlash.py",
        (", 2.0 * felt_wear / arm", ", felt_wear / arm"),
        ("involute - reducer.base_tangent_error", "involute + reducer.base_tangent_error"),
    ),
    *changes(
        "plugins/rv_wear/effects.py", "published/test_effects_of_machines.py",
        ("2.0 * compliance * np.abs(measuring_torque)", "compliance * np.abs(measuring_torque)"),
        ("np.exp(VISCOSITY_EXPONENT * softening", "np.exp(softening"),
    ),
    *changes(
        "plugins/rv_wear/wear.py", "published/test_rv_wear_wear.py",
        ("speed / (modulus * relative_radius)) ** 0.7", "speed / (modulus * relative_radius)) ** 0.6"),
    ),
)  # fmt: skip
"""Number paths of the kernel (units, spreads, studies, checks, diagnosis, reports) and of each plugin's physics."""


def copied(folder: Path) -> Path:
    """Copy what the tests need into a folder, and return where it stands."""
    for name in COPIED:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=LEFT_OUT)
        else:
            shutil.copyfile(source, target)
    return folder


def passes(tree: Path, tests: Iterable[str]) -> bool | None:
    """Run test files of a copy up to the first failure; return whether they pass, None where none was found."""
    paths = os.pathsep.join([str(tree / "kernel"), str(tree / "plugins")])
    environment = {**os.environ, "PYTHONPATH": paths, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    program = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider", *tests]
    done = subprocess.run(
        program, cwd=tree, env=environment, capture_output=True, text=True, timeout=LONGEST_RUN_S, check=False
    )
    if done.returncode not in {0, 1, 2}:
        print(done.stdout[-2000:], done.stderr[-2000:])
        return None
    return done.returncode == 0


def tried(mutant: Mutant, tree: Path, time_of_file: int) -> State:
    """Apply one change to a copy, run its tests, and put the text back."""
    file = tree / mutant.file
    text = file.read_text("utf-8")
    if text.count(mutant.old) != 1:
        return "stale"
    file.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    os.utime(file, (time_of_file, time_of_file))
    try:
        outcome = passes(tree, mutant.tests)
    except subprocess.TimeoutExpired:
        return "too slow"
    finally:
        file.write_text(text, encoding="utf-8")
        os.utime(file, (time_of_file + 1, time_of_file + 1))
    return "no tests" if outcome is None else "survived" if outcome else "caught"


def main() -> None:
    """Try the changes that are asked for and tell what came of each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", default=[""], metavar="WORD", help="changes that hold one of these words")
    parser.add_argument("--unchanged", action="store_true", help="run the named tests without a change")
    asked = parser.parse_args()
    texts = {mutant: f"{mutant.words} {' '.join(mutant.tests)}" for mutant in MUTANTS}
    wanted = [mutant for mutant, text in texts.items() if any(word in text for word in asked.only)]
    with TemporaryDirectory() as folder:
        tree = copied(Path(folder))
        if asked.unchanged:
            files = sorted({name for mutant in wanted for name in mutant.tests})
            sys.exit(0 if passes(tree, files) else f"without a change these do not all pass: {' '.join(files)}")
        counts: Counter[State] = Counter()
        for number, mutant in enumerate(wanted):
            begun = time.monotonic()
            state = tried(mutant, tree, FIRST_TIME + 2 * number)
            counts[state] += 1
            print(f"{state:9} {time.monotonic() - begun:5.1f} s  {mutant.words!r}", flush=True)
    print(f"{len(wanted)} changes: {', '.join(f'{count} {state}' for state, count in counts.items())}")
    sys.exit(0 if counts["caught"] == len(wanted) else 1)


if __name__ == "__main__":
    main()
