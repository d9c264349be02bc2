"""What is said of a measured flank: whether it is used and along which direction, and the tables behind that."""

from collections.abc import Iterator, Sequence
from functools import partial

from harmonic_fractal.drawn_flank import map_figure, profiles_figure, structure_figure
from harmonic_fractal.drawn_look import MICRO, NANO, microns, signed
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.flank import Flank
from truing import Block, Drawing, Table, Words

ALONG = {"x": "along x", "y": "along y", "both": "x and y together"}
COMPARISON = (
    "Its fit stands below for comparison only: a straight line through ln S over ln lag always finds some D and G, and "
    "its R² does not tell whether the surface is self-affine."
)


def verdict(flank: "Flank", body: str, instead: str) -> "Iterator[Block]":
    """Say whether a flank is used; ``instead`` says what the contact is made of where it is refused."""
    name = flank.surface.name
    if flank.used is None:
        yield Words(
            f"REFUSED: the flank of the {body}, {name}, has no D and G. The contact below is NOT that of this surface: "
            f"{instead}. Reason: {flank.reason}. {COMPARISON}",
            "warning",
        )
    else:
        yield Words(f"The flank of the {body}, {name}, is used. {_used(flank, flank.used)}")
    for sentence in flank.warnings:
        yield Words(f"{name}: {sentence}.", "warning")
    yield Words(_cleaned(flank))


def _used(flank: "Flank", used: "Estimate") -> str:
    found = (
        f"Its profiles have the dimension {used.dimension:.3f} and G = {signed(used.roughness)} m over lags of "
        f"{microns(used.range[0])} to {microns(used.range[1])}."
    )
    if flank.surface.is_profile:
        return f"{found} It is one profile: that the flank is the same in all directions is assumed, not measured."
    if flank.chosen == "both":
        return f"{found} Lines along x and along y agree and are pooled."
    return (
        f"{found} It is taken along {flank.chosen} only: the contact is that of a surface that looks in all directions "
        f"as this one does along {flank.chosen}."
    )


def _cleaned(flank: "Flank") -> str:
    rows, points = flank.surface.heights.shape
    surface = flank.surface
    size = f"{points} points, {microns(surface.spacing_x, '.4g')} apart"
    if not surface.is_profile:
        size = f"{points} × {rows} points, {microns(surface.spacing_x, '.4g')} apart along x"
        size += "" if surface.is_square else f" and {microns(surface.spacing_y, '.4g')} along y"
        size += " and y" if surface.is_square else ""
    return (
        f"{size}. Root mean square height: {microns(flank.sq_raw, '.4g')} as read, {microns(flank.sq_plane, '.4g')} "
        f"less the mean {'line' if surface.is_profile else 'plane'}, {microns(flank.sq_second_order, '.4g')} less the "
        f"second-order form. Not measured: {100 * flank.missing:.2g} % of the points; taken as spikes: "
        f"{100 * flank.spiked:.2g} %."
    )


def pictures(flank: "Flank") -> "Iterator[Block]":
    """The surface, some profiles, and the structure function."""
    title = f"{flank.surface.name}: "
    if not flank.surface.is_profile:
        yield Drawing(f"{title}from above", partial(map_figure, flank), "Cleaned. Orange: not measured, or a spike.")
    caption = "The form is removed; the levelling of single lines is not shown."
    yield Drawing(f"{title}profiles", partial(profiles_figure, flank), "" if flank.surface.is_profile else caption)
    yield Drawing(
        f"{title}structure function and local dimension", partial(structure_figure, flank),
        "A self-affine surface is a straight line above and a level one below. Dotted: 1.05 and 1.95, below which a "
        "surface is smooth and above which it is noise.",
    )  # fmt: skip


def tables(flank: "Flank") -> "Iterator[Block]":
    """Both directions with their verdict, and the local slopes."""
    name = flank.surface.name
    rows = [_row(found, flank) for found in flank.estimates]
    columns: tuple[str, ...] = (
        "direction",
        "lags of the fit from",
        "to",
        "D_s",
        "G, areal",
        "R²",
        "sd of D_s over lines",
        "verdict",
    )
    units: tuple[str, ...] = ("", "µm", "µm", "", "m", "", "", "")
    has_noise = any(found.noise > 0.0 for found in flank.estimates)
    if has_noise:
        columns, units = (*columns[:-1], "noise", columns[-1]), (*units[:-1], "nm", "")
        rows = [(*row[:-1], NANO * found.noise, row[-1]) for row, found in zip(rows, flank.estimates, strict=True)]
    yield Table(f"{name}: what each direction says", columns, rows, units)
    yield _others(flank)
    yield _slopes(flank)


def _row(found: "Estimate", flank: "Flank") -> tuple[str | float | None, ...]:
    low, high = (found.lags[0], found.lags[-1]) if found.lags.size else (None, None)
    state = "self-affine, not used" if found.is_accepted else "refused, for comparison only"
    known = [_known(value) for value in (found.dimension, found.roughness, found.r_squared)]
    return (
        ALONG[found.direction],
        None if low is None else MICRO * float(low),
        None if high is None else MICRO * float(high),
        *known,
        _known(found.line_scatter),
        "used" if found.direction == flank.chosen else state,
    )


def _others(flank: "Flank") -> Table:
    """The dimension by other ways, which only compare."""
    rows = [
        (
            ALONG[found.direction],
            *(_known(value) for value in (found.dimension, found.window_dimension, found.noise_dimension)),
            _known(100.0 * found.noise_share),
        )
        for found in flank.estimates
    ]
    columns = ("direction", "fit of S", "roughness-length", "fit of S with noise", "noise in S at the shortest lag")
    note = (
        "The roughness-length method, which the patent names, looks at windows of a line; the fit with noise takes a "
        "constant beside the power law. Where they differ much, D and G are partly those of instrument and window."
    )
    return Table(f"{flank.surface.name}: D_s by other ways, for comparison", columns, rows, ("", "", "", "", "%"), note)


def _known(value: float) -> float | None:
    return value if value == value else None


def _slopes(flank: "Flank") -> Table:
    """The local slopes, the directions side by side: each has lags of its own."""
    longest = max((len(found.local_lags) for found in flank.estimates), default=0)
    rows: list[list[float | None]] = [[] for _ in range(longest)]
    for found in flank.estimates:
        for place, row in enumerate(rows):
            known = place < len(found.local_lags)
            row += [MICRO * found.local_lags[place], found.local_dimensions[place]] if known else [None, None]
    columns = [f"{ALONG[found.direction]}: {what}" for found in flank.estimates for what in ("lag", "local D_s")]
    note = (
        "Between neighbouring lags, at their geometric mean. Asked for: a decade of lags over which D_s spans less "
        "than 0.2 and stays within 1.05 to 1.95. Near 1 the instrument smooths or form is left; near 2 there is noise "
        "(short lags) or the correlation length is passed (long lags)."
    )
    return Table(f"{flank.surface.name}: local slopes", columns, rows, ("µm", "") * len(flank.estimates), note)


def said_of(flank: "Flank", body: str, instead: str) -> "Sequence[Block]":
    """Everything about one flank, in order."""
    return [*verdict(flank, body, instead), *pictures(flank), *tables(flank)]
