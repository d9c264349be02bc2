"""A measured flank, read once from a file: options, surface made ready, and what each direction says."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from harmonic_fractal import surface as surfaces
from harmonic_fractal.estimate import FEWEST_POINTS, Estimate, Estimation, estimate_of
from harmonic_fractal.levelling import Levelling
from harmonic_fractal.surface import Direction, Form, Lines, Surface
from harmonic_fractal.surface_files import FileLayout, Reading, length, metres_per_unit, read_surface

# What the inputs file says beside the name of a surface, checked: a fault is one sentence that names the option

NAN = float("nan")
FILTERS = 3.0  # widths of the instrument's lateral filter below which a lag is smoothed
WORDS: Mapping[str, tuple[str, ...]] = {
    "form": ("second_order", "plane", "none"), "spikes": ("remove", "keep"), "direction": ("auto", "x", "y", "both"),
    "sliding": ("x", "y"), "method": ("pooled", "per_line"), "fit": ("self_affine", "all"),
    "bias": ("taken_out", "kept"),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Options:
    """How a surface is read, cleaned and judged; lengths in m, NaN and empty where the file or the data decide."""

    layout: FileLayout
    rectangle: tuple[float, ...] = ()
    corner: tuple[float, ...] | None = None
    form: Form = "second_order"
    spikes: Literal["remove", "keep"] = "remove"
    direction: Literal["auto"] | Direction = "auto"
    sliding: Literal["x", "y"] = "x"
    filter_width: float = NAN
    estimation: Estimation


def options_of(given: Mapping[str, Any]) -> Options:
    """Check the options as they stand in the inputs file. Raises ValueError with one sentence."""
    for name, words in WORDS.items():
        if given[name] not in words:
            raise ValueError(f"{name} = {_shown(given[name])}, but it is one of: {', '.join(words)}")
    if not isinstance(given["noise_aware"], bool):
        raise ValueError(f"noise_aware = {_shown(given['noise_aware'])}, but it is true or false")
    rectangle, corner = (_lengths(given, name) for name in ("rectangle", "corner"))
    if corner and not rectangle:
        raise ValueError("corner needs rectangle, the lengths along x and y that are cut from there")
    return Options(
        layout=_layout(given), rectangle=rectangle, corner=corner or None, form=given["form"], spikes=given["spikes"],
        direction=given["direction"], sliding=given["sliding"], filter_width=_width(given["filter_width"]),
        estimation=_estimation(given),
    )  # fmt: skip


def _layout(given: Mapping[str, Any]) -> FileLayout:
    if given["spacing"] != "" and (given["spacing_x"] != "" or given["spacing_y"] != ""):
        raise ValueError("spacing is that of both directions: leave out spacing_x and spacing_y, or spacing")
    both = _length(given, "spacing")
    along = [_length(given, name) for name in ("spacing_x", "spacing_y")]
    if given["height_unit"] != "":
        metres_per_unit(given["height_unit"])
    lines = given["skip_lines"]
    if isinstance(lines, bool) or not isinstance(lines, int) or lines < 0:
        raise ValueError(f"skip_lines = {_shown(lines)}, but it is a whole number of lines, 0 or more")
    columns = given["columns"]
    if isinstance(columns, str) or not all(isinstance(name, str) for name in columns):
        raise ValueError(f'columns = {_shown(columns)}, but it is a list of names, as in ["x [um]", "z [um]"]')
    return FileLayout(
        spacing_x=along[0] if along[0] == along[0] else both, spacing_y=along[1] if along[1] == along[1] else both,
        height_unit=given["height_unit"], skip_lines=lines, columns=tuple(columns),
    )  # fmt: skip


def _estimation(given: Mapping[str, Any]) -> Estimation:
    shortest, longest = _length(given, "shortest_lag"), _length(given, "longest_lag")
    if longest <= shortest:
        raise ValueError(f"longest_lag = {given['longest_lag']} must be above shortest_lag = {given['shortest_lag']}")
    return Estimation(
        method=given["method"], noise_aware=given["noise_aware"], shortest_lag=shortest, longest_lag=longest,
        fit=given["fit"], bias=given["bias"],
    )  # fmt: skip


def _length(given: Mapping[str, Any], name: str) -> float:
    return NAN if given[name] == "" else length(given[name], name)


def _width(text: Any) -> float:
    """Return the width of the filter, m: 0 switches off what the file states."""
    if isinstance(text, str) and text.strip().split(" ")[0] in {"0", "0.0"}:
        return 0.0
    return NAN if text == "" else length(text, "filter_width")


def _lengths(given: Mapping[str, Any], name: str) -> tuple[float, ...]:
    texts: Sequence[Any] = given[name]
    if isinstance(texts, str) or not isinstance(texts, Sequence) or len(texts) > 2:
        raise ValueError(f'{name} = {_shown(texts)}, but it is a list of lengths along x and y: ["0.2 mm", "0.1 mm"]')
    if name == "corner":
        return tuple(0.0 if str(text).strip().split(" ")[0] in {"0", "0.0"} else length(text, name) for text in texts)
    return tuple(length(text, name) for text in texts)


def _shown(value: object) -> str:
    words = repr(value) if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else str(value)
    return words if len(words) <= 60 else words[:57] + "..."


# A surface made ready for its structure function: cut, form removed, spikes out, and what is to be said about it

FEW_MISSING, MANY_MISSING = 0.05, 0.20  # shares of the points: above the one a warning, above the other an error
FEW_SPIKES = 0.02
FITTED: tuple[Form, Form] = ("plane", "second_order")


@dataclass(frozen=True, eq=False, kw_only=True)
class Flank:
    """A surface after cleaning, with the estimates along x and y and the direction whose D and G are used.

    ``chosen`` is None where no direction has a self-affine range: then ``reason`` says why and the contact is that of
    the stated D and G. ``both`` are the lines along x and along y pooled. ``warnings`` are sentences for the sheet.
    ``raw`` is the surface as it was read. ``missing`` and ``spiked`` are shares of the points of the rectangle, the
    ``sq`` their root mean square heights, m: as read, less the plane, less the second-order surface (spikes included).
    """

    raw: Surface
    surface: Surface
    estimates: tuple[Estimate, ...] = ()
    chosen: Direction | None = None
    reason: str = ""
    warnings: tuple[str, ...] = ()
    missing: float = 0.0
    spiked: float = 0.0
    sq_raw: float = float("nan")
    sq_plane: float = float("nan")
    sq_second_order: float = float("nan")

    def __post_init__(self) -> None:
        self.raw.heights.setflags(write=False)
        self.surface.heights.setflags(write=False)

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self.__post_init__()  # arrays come out of another process writeable

    @property
    def used(self) -> Estimate | None:
        """The estimate whose D and G are used, or None."""
        return next((item for item in self.estimates if item.direction == self.chosen), None)

    @property
    def height(self) -> float:
        """The height from the lowest to the highest point after cleaning, S_z, in m."""
        return float(np.nanmax(self.surface.heights) - np.nanmin(self.surface.heights))

    @property
    def resampled(self) -> NDArray[np.float64]:
        """Pairs of D and ln G (B, 2) of the chosen direction; empty without one."""
        return np.empty((0, 2)) if self.used is None else self.used.resampled


def prepared(raw: Surface, options: Options) -> Flank:
    """Cut the rectangle, count the holes, remove the form, take out spikes; no direction is estimated yet.

    Raises ValueError with one sentence.
    """
    surface = surfaces.cut(raw, options.rectangle, options.corner) if options.rectangle else raw
    rows, points = surface.heights.shape
    if max(rows, points) < FEWEST_POINTS:
        raise ValueError(f"{rows} x {points} points (rows x points) are too few: a line needs {FEWEST_POINTS} or more")
    missing = float(np.mean(~np.isfinite(surface.heights)))
    if missing > MANY_MISSING:
        raise ValueError(
            f"{missing:.1%} of the points are missing, more than {MANY_MISSING:.0%}: cut another rectangle"
        )
    plane, second = (surfaces.without_form(surface.heights, form) for form in FITTED)
    heights = {"none": surface.heights, "plane": plane, "second_order": second}[options.form]
    step = surfaces.quantisation(surface.heights)
    spikes = surfaces.spikes_of(heights, step)
    spiked = float(spikes.sum() / np.isfinite(heights).sum())
    if options.spikes == "remove":
        heights = np.where(spikes, np.nan, heights)
    clean = Surface(np.array(heights), surface.spacing_x, surface.spacing_y, surface.name)
    return Flank(
        raw=raw, surface=clean, missing=missing, spiked=spiked, sq_raw=surfaces.root_mean_square(surface.heights),
        sq_plane=surfaces.root_mean_square(plane), sq_second_order=surfaces.root_mean_square(second),
        warnings=(*_shares(missing, spiked, options), *_steps(clean, step)),
    )  # fmt: skip


def _shares(missing: float, spiked: float, options: Options) -> list[str]:
    said = []
    if missing > FEW_MISSING:
        said.append(f"{missing:.1%} of the points are missing, more than {FEW_MISSING:.0%}")
    if spiked > FEW_SPIKES:
        done = "taken out" if options.spikes == "remove" else "kept"
        said.append(f"{spiked:.1%} of the points are spikes, more than {FEW_SPIKES:.0%}; they were {done}")
    return said


def _steps(surface: Surface, step: float) -> list[str]:
    """Say where the numbers of the instrument are coarser than the roughness from point to point."""
    said = []
    for axis in ("x",) if surface.is_profile else ("x", "y"):
        change = np.diff(surface.heights, axis=1 if axis == "x" else 0)
        known = change[np.isfinite(change)]
        least = float(np.sqrt(np.mean(np.square(known)))) if known.size else float("inf")
        if step > least:
            said.append(
                f"the heights come in steps of {step * 1e9:.3g} nm, more than they change from point to point along "
                f"{axis}, {least * 1e9:.3g} nm: short lags show the steps"
            )
    return said


# What each direction of a surface says, and whose D and G are used

ISOTROPIC = 0.15  # difference of the dimensions along x and y up to which a flank is the same in all directions
ALIKE = 3.0  # ratio of the structure functions along x and y, at the lags they share, up to which it is, too
ROUNDING = 1e-18  # of the structure function along the other direction: no relief but rounding


def with_choice(clean: Flank, options: Options) -> Flank:
    """Estimate D and G along each direction, each line less its own straight line, and choose.

    A profile keeps its lines: its form was removed. With ``auto`` both directions are pooled where both are
    self-affine, their dimensions agree within 0.15, their structure functions within a factor of 3 and their spacings
    within 1 %; else the direction of sliding is used, or the only one.
    Raises ValueError where a direction is asked for that the surface does not have.
    """
    surface, settings = clean.surface, options.estimation
    if surface.is_profile:
        if options.direction in {"y", "both"} or options.sliding == "y":
            raise ValueError("one profile has the direction x alone: leave out direction and sliding")
        return _asked(clean, (estimate_of(_level(surface.lines("x"), options.form), "x", settings),), "x")
    axes: tuple[Direction, Direction] = "x", "y"
    lines = {axis: _level(surface.lines(axis), options.form) for axis in axes}
    alone = _with_relief(tuple(estimate_of(each, axis, settings) for axis, each in lines.items()))
    said = _anisotropy(alone)
    if options.direction == "both":
        return _asked(clean, (*alone, _together(lines, settings)), "both", said)
    if options.direction != "auto":
        return _asked(clean, alone, options.direction, said)
    if not said and surface.is_square and all(estimate.is_accepted for estimate in alone):
        both = _together(lines, settings)
        if both.is_accepted:
            return _asked(clean, (*alone, both), "both")
    return _best(clean, alone, options, said)


def _level(lines: Lines, form: Form) -> Lines:
    """Take its straight line from each line, but for a profile, which lost its form, and say what was taken."""
    is_profile = len(lines.heights) == 1
    taken = Levelling((lines.heights.shape,), line=not is_profile or form != "none", curved=form == "second_order")
    return Lines(lines.heights if is_profile else surfaces.without_line(lines.heights), lines.spacing, taken)


def _together(lines: dict[Direction, Lines], settings: Estimation) -> Estimate:
    return estimate_of(surfaces.pooled(lines["x"], lines["y"]), "both", settings)


def _asked(clean: Flank, estimates: tuple[Estimate, ...], direction: Direction, said: tuple[str, ...] = ()) -> Flank:
    """Use this direction, or none with its reason."""
    found = next(estimate for estimate in estimates if estimate.direction == direction)
    return replace(
        clean, estimates=estimates, chosen=direction if found.is_accepted else None, reason=found.reason,
        warnings=(*clean.warnings, *said, *found.warnings),
    )  # fmt: skip


def _best(clean: Flank, alone: tuple[Estimate, ...], options: Options, said: tuple[str, ...]) -> Flank:
    accepted = [estimate.direction for estimate in alone if estimate.is_accepted]
    refused = [f"along {estimate.direction}: {estimate.reason}" for estimate in alone if not estimate.is_accepted]
    if not accepted:
        return replace(clean, estimates=alone, reason="; ".join(refused))
    chosen = options.sliding if options.sliding in accepted else accepted[0]
    if refused:
        said = (*said, f"the direction {chosen} alone is used; {refused[0]}")
    elif not said:
        said = (f"the direction of sliding, {chosen}, is used; the directions cannot be pooled",)
    return _asked(clean, alone, chosen, said)


def _with_relief(alone: tuple[Estimate, ...]) -> tuple[Estimate, ...]:
    """Refuse a direction along which the surface has no relief, only rounding: ridges that run along it."""
    largest = [float(np.max(estimate.all_values, initial=0.0)) for estimate in alone]
    return tuple(
        replace(each, reason=f"no relief along {each.direction}: the heights of a line are all the same")
        if each.is_accepted and each.all_values.size and own <= ROUNDING * max(largest)
        else each
        for each, own in zip(alone, largest, strict=True)
    )


def _anisotropy(alone: tuple[Estimate, ...]) -> tuple[str, ...]:
    x, y = alone
    if not (x.is_accepted and y.is_accepted):
        return ()
    meaning = "the contact model knows no lay and takes it as alike in all directions"
    if abs(x.dimension - y.dimension) > ISOTROPIC:
        return (
            f"the flank is anisotropic: the dimension of its profiles is {x.dimension:.3f} along x and "
            f"{y.dimension:.3f} along y; {meaning}",
        )
    ratio = _ratio(x, y)
    if 1.0 / ALIKE <= ratio <= ALIKE:
        return ()
    return (f"the flank is anisotropic: its structure function along x is {ratio:.3g} times that along y; {meaning}",)


def _ratio(x: Estimate, y: Estimate) -> float:
    """Return the structure function along x over that along y at the lags that they share; 1 where there are none."""
    if not (x.lags.size and y.lags.size):
        return 1.0
    low, high = max(x.lags[0], y.lags[0]), min(x.lags[-1], y.lags[-1])
    if low >= high:
        return 1.0
    shared = np.log(np.geomspace(low, high, len(x.lags)))
    along_x, along_y = (np.interp(shared, np.log(each.lags), np.log(each.values)) for each in (x, y))
    return float(np.exp(np.mean(along_x - along_y)))


# A measured flank, read once from a file: its surface, what was cleaned away, and what each direction says
#
# In the inputs file: ``surface = { file = "flank.csv", spacing = "0.4 um", height_unit = "um" }``. Options of the file:
#
# - ``spacing``, or ``spacing_x`` and ``spacing_y``: from point to point of a matrix, where the file is silent.
# - ``height_unit``: "um", or the length of one count, "2.918e-8 m"; never guessed.
# - ``skip_lines``: lines at the top that are no data although they look like numbers.
# - ``columns``: names of columns that have none, ["x [um]", "y [um]", "z [um]"].
#
# Of cleaning:
#
# - ``rectangle``: ["0.2 mm", "0.1 mm"] along x and y, from the middle or from ``corner``, ["10 um", "20 um"].
# - ``form``: "second_order", "plane" or "none" is removed; then each line of a patch loses its straight line.
# - ``spikes``: "remove" or "keep" what lies 4 robust standard deviations from the median of 11 neighbours.
#
# Of the fit:
#
# - ``filter_width``: of the instrument, laterally; lags below 3 of it are left out ("0 um": whatever the file says).
# - ``shortest_lag``, ``longest_lag``: limits; without them one point (or 3 filter widths) and a tenth of a line.
# - ``method``: "pooled", one fit to the mean over all lines, or "per_line", the mean of the fits.
# - ``noise_aware``: whether instrument noise is fitted beside the power law.
# - ``fit``: over the "self_affine" range, or over "all" lags within the limits.
#
# Of the choice:
#
# - ``direction``: "auto", "x", "y", or "both" pooled.
# - ``sliding``: "x" or "y", along the height of the tooth; used where x and y differ.


def read_flank(  # the signature is the list of options of the inputs file
    path: Path,
    *,
    spacing: str = "",
    spacing_x: str = "",
    spacing_y: str = "",
    height_unit: str = "",
    skip_lines: int = 0,
    columns: Sequence[str] = (),
    rectangle: Sequence[str] = (),
    corner: Sequence[str] = (),
    form: str = "second_order",
    spikes: str = "remove",
    filter_width: str = "",
    shortest_lag: str = "",
    longest_lag: str = "",
    method: str = "pooled",
    noise_aware: bool = False,
    fit: str = "self_affine",
    bias: str = "taken_out",
    direction: str = "auto",
    sliding: str = "x",
) -> Flank:
    """Read a measured flank, clean it, and look for its self-affine range; the options stand at the top of this file.

    Raises ValueError with one sentence.
    """
    options = options_of({name: value for name, value in locals().items() if name != "path"})
    reading = read_surface(path, options.layout)
    clean = prepared(reading.surface, options)
    options, filtered = _filtered(options, reading)
    found = with_choice(clean, options)
    return replace(found, warnings=(*reading.remarks, *filtered, *found.warnings))


def _filtered(options: Options, reading: Reading) -> tuple[Options, tuple[str, ...]]:
    """Leave out lags below three widths of the instrument's filter, unless the shortest lag is stated."""
    is_stated = np.isfinite(options.filter_width)
    width = options.filter_width if is_stated else reading.filter_width
    if not width > 0.0 or np.isfinite(options.estimation.shortest_lag):
        return options, ()
    shortest = FILTERS * width
    if shortest >= options.estimation.longest_lag:
        raise ValueError(f"longest_lag lies below 3 filter widths, {shortest * 1e6:.4g} um, where lags are smoothed")
    said = (
        f"the file states a lateral filter of {width * 1e6:.4g} um: lags below {shortest * 1e6:.4g} um are left out; "
        'filter_width = "0 um" takes them in',
    )
    estimation = replace(options.estimation, shortest_lag=shortest)
    return replace(options, estimation=estimation), () if is_stated else said
