"""What the inputs file says beside the name of a surface, checked: a fault is one sentence that names the option."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from harmonic_fractal.cleaning import Form
from harmonic_fractal.estimate import Estimation
from harmonic_fractal.surface import Direction
from harmonic_fractal.surface_files import Layout
from harmonic_fractal.surface_text import length, metres_per_unit

NAN = float("nan")
FILTERS = 3.0  # widths of the instrument's lateral filter below which a lag is smoothed
WORDS: Mapping[str, tuple[str, ...]] = {
    "form": ("second_order", "plane", "none"), "spikes": ("remove", "keep"), "direction": ("auto", "x", "y", "both"),
    "sliding": ("x", "y"), "method": ("pooled", "per_line"), "fit": ("self_affine", "all"),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Options:
    """How a surface is read, cleaned and judged; lengths in m, NaN and empty where the file or the data decide."""

    layout: Layout
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


def _layout(given: Mapping[str, Any]) -> Layout:
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
    return Layout(
        spacing_x=along[0] if along[0] == along[0] else both, spacing_y=along[1] if along[1] == along[1] else both,
        height_unit=given["height_unit"], skip_lines=lines, columns=tuple(columns),
    )  # fmt: skip


def _estimation(given: Mapping[str, Any]) -> Estimation:
    shortest, longest = _length(given, "shortest_lag"), _length(given, "longest_lag")
    if longest <= shortest:
        raise ValueError(f"longest_lag = {given['longest_lag']} must be above shortest_lag = {given['shortest_lag']}")
    return Estimation(
        method=given["method"], noise_aware=given["noise_aware"], shortest_lag=shortest, longest_lag=longest,
        fit=given["fit"],
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
