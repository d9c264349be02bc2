"""A study of our own: the exact play over the turn beside equation 21, and what it makes of the assumptions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rv_wear.play import Carried, Parts, carried, drawn_parts, ideal_parts, play_of, touches
from rv_wear.quantities import Reducer
from truing import Array, Bench, Block, Float, Outcome, Table, TruingError, axis, found, results

ARCMIN = np.pi / 10800.0
MOST = 10_000
BY = "first tooth to touch, over both discs and all pins"
OF_MACHINES = "mean of the machines of the study 'exact_play'"


FIRST = "first machine drawn"


def arcmin(symbol: str, note: str, method: str, *, key: bool = False) -> Any:
    """Declare an angle at the output."""
    return found("arcmin", symbol=symbol, note=note, method=method, key=key)


@results
class ExactAnswers:
    """The play of real parts, and what the assumptions of equation 21 become."""

    exact_new: Float = arcmin("Delta phi_x,0", "backlash of new machines, exact geometry", BY)
    exact_backlash: Float = arcmin("Delta phi_x", "backlash after the working time, exact geometry", BY, key=True)
    exact_difference: Float = arcmin("Delta phi_x - Delta phi", "exact backlash less that of equation 21",
                                     "what equation 21 adds and the parts do not show")  # fmt: skip
    exact_least: Float = arcmin("Delta phi_min", "least backlash over a turn of the output", FIRST)
    exact_most: Float = arcmin("Delta phi_max", "largest backlash over a turn of the output", FIRST)
    averaged_errors: Float = found("", symbol="n_eff", note="how many pins the errors of single pins average over",
                                   method="variance by the coefficients of equation 21 over the exact one")  # fmt: skip
    worse_share: Float = found("%", symbol="kappa_x", note="torque on the worse of the two discs, mean over the turn",
                               method=OF_MACHINES, key=True)  # fmt: skip
    worst_share: Float = found("%", symbol="kappa_max", note="largest share of a disc in any machine and position",
                               method="of these machines")  # fmt: skip
    force_of_both: Float = found("N", symbol="F_x", note="largest force of a disc on a pin, both discs carrying",
                                 method=OF_MACHINES)  # fmt: skip
    error_free: Float = arcmin("TE_0", "error of transmission without load, peak to peak",
                               "where the first tooth touches over the crank; mean of the machines")  # fmt: skip
    error_loaded: Float = arcmin("TE", "error of transmission under the torque, peak to peak",
                                 "contact solution of both discs; mean of the machines")  # fmt: skip
    crank_position: Float = axis("deg", symbol="phi", note="angle of the crank")
    backlash_of_like_parts: Float = found("arcmin", symbol="Delta phi_x", along="crank_position", method=BY,
                                          note="exact backlash after the working time, all pins alike")  # fmt: skip
    backlash_of_a_machine: Float = found("arcmin", symbol="Delta phi_x,1", along="crank_position", method=BY,
                                         note="the same, the first machine drawn")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class ExactPlay:
    """Draw ``machines`` with pins and teeth of their own; look at ``points`` angles within a turn of the crank.

    The first machine is followed over a whole turn of the output, as many turns of the crank as a disc has teeth.
    """

    machines: int = 40
    points: int = 48
    name: str = "exact_play"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not 2 <= self.machines <= MOST or not 4 <= self.points <= MOST:
            raise TruingError(
                f"study '{self.name}': 2 to {MOST} machines can be drawn and 4 to {MOST} points looked at, not "
                f"{self.machines} and {self.points}"
            )

    def run(self, bench: Bench) -> "Played":
        """Find the play new and after the working time, the shares of the discs and the error of transmission."""
        reducer: Reducer = bench.inputs
        time, seed = float(reducer.working_time), bench.setup.seed
        crank = np.linspace(0.0, 2.0 * np.pi, self.points, endpoint=False)
        drawn = drawn_parts(reducer, np.random.default_rng(seed), self.machines, time)
        bare = replace(reducer, disc_runout=0.0)
        only_own = drawn_parts(bare, np.random.default_rng(seed), self.machines)
        turns = reducer.pin_count - 1
        whole = np.linspace(0.0, 2.0 * np.pi * turns, self.points * turns, endpoint=False)
        beside = float(bench.answers["backlash_involute"]) + float(bench.answers["backlash_bearing"])
        return Played(
            crank=crank,
            linear=float(bench.answers["backlash"]),
            linear_wear=float(bench.answers["backlash_of_wear"]),
            alike=_play(ideal_parts(reducer, time), crank)[:, 0] + beside,
            new=_play(new_of(drawn), crank) + beside,
            worn=_play(drawn, crank) + beside,
            whole=_play(first_of(drawn), whole)[:, 0] + beside,
            own_sd=float(_play(only_own, crank).std(axis=1, ddof=1).mean()),
            linear_sd=_by_equation_21(reducer),
            free=touches(drawn, crank, 1).first,
            held=carried(drawn, crank, 1),
            torque_share=float(reducer.torque_share),
            one_disc=float(bench.answers["largest_force"]),
        )


def _play(parts: Parts, crank: Array) -> Array:
    return play_of(parts, crank)


def new_of(parts: Parts) -> Parts:
    """The same machines before anything has worn."""
    return replace(parts, wear=np.zeros_like(parts.wear))


def first_of(parts: Parts) -> Parts:
    """The first machine alone."""
    numbers = ("pin_radius", "pin_radial", "pin_along", "tooth_along", "throw", "phase", "offset")
    return replace(parts, **{name: getattr(parts, name)[..., :1] for name in numbers})


def _by_equation_21(reducer: Reducer) -> float:
    """Standard deviation (rad) that errors 7, 10 and 11 of one pin would give were they those of all pins."""
    short_width = reducer.eccentricity * reducer.pin_count / reducer.pin_circle_radius
    gaps = (2.0 * reducer.pin_radius_spread, 2.0 * short_width * reducer.pin_position_spread,
            short_width * reducer.tooth_pitch_spread)  # fmt: skip
    arm = reducer.eccentricity * (reducer.pin_count - 1)
    return float(np.sqrt(sum(np.square(gap) for gap in gaps)) / arm)


@dataclass(frozen=True, kw_only=True, eq=False)
class Played(Outcome):
    """Backlash in rad: by equation 21 (of which wear), with like parts (k,), of machines new and worn (k, n).

    ``whole`` is that of the first machine over a turn of the output; ``own_sd`` and ``linear_sd`` are the standard
    deviations by errors of single parts, exact and by equation 21; ``free`` the angles (k, n) where the first tooth
    touches, ``held`` the contact solution at these crank angles (k,).
    """

    crank: Array
    linear: float
    linear_wear: float
    alike: Array
    new: Array
    worn: Array
    whole: Array
    own_sd: float
    linear_sd: float
    free: Array
    held: Carried
    torque_share: float
    one_disc: float

    @property
    def worse(self) -> Array:
        """The share of the worse disc, (k, n)."""
        return np.asarray(self.held.shares.max(axis=0))

    def as_json(self) -> Mapping[str, Any]:
        """Return both backlashes, shares, and errors of transmission."""
        given = answered(self)
        angles = ("exact_new", "exact_backlash", "exact_difference", "exact_least", "exact_most", "error_free",
                  "error_loaded")  # fmt: skip
        return {
            "machines": int(self.new.shape[1]),
            "unit": "arcmin",
            **{name: float(getattr(given, name)) / ARCMIN for name in angles},
            "averaged_errors": float(given.averaged_errors),
            "worse_share": float(given.worse_share),
            "worst_share": float(given.worst_share),
        }

    def blocks(self) -> Sequence[Block]:
        """Return the table of the paper's way and the exact one."""
        new = self.linear - self.linear_wear
        lines = (
            ("new", new, float(self.new.mean())),
            ("after the working time", self.linear, float(self.worn.mean())),
            ("what the wear adds", self.linear_wear, float(self.worn.mean() - self.new.mean())),
        )
        rows = [(what, linear / ARCMIN, exact / ARCMIN, (exact - linear) / ARCMIN) for what, linear, exact in lines]
        note = (
            f"Exact: mean of {self.new.shape[1]} machines over a turn of the crank. Bearings and involute gears count "
            "alike in both. Equation 21 adds runout, places of pins and pitch as if they opened the play everywhere, "
            "and the deepest wear as if the whole flank had lost it."
        )
        heads = ("backlash", "equation 21", "exact", "difference")
        return [Table("Equation 21 and the exact play", heads, rows, ("", "arcmin", "arcmin", "arcmin"), note)]


def answered(played: Played) -> ExactAnswers:
    """The numbers of the study."""
    ripple, under = np.ptp(played.free, axis=0), np.ptp(played.held.angle, axis=0)
    variance = played.own_sd**2
    return ExactAnswers(
        exact_new=float(played.new.mean()),
        exact_backlash=float(played.worn.mean()),
        exact_difference=float(played.worn.mean()) - played.linear,
        exact_least=float(played.whole.min()),
        exact_most=float(played.whole.max()),
        averaged_errors=played.linear_sd**2 / variance if variance > 0.0 else np.nan,
        worse_share=float(played.worse.mean()),
        worst_share=float(played.worse.max()),
        force_of_both=float(played.held.force.max(axis=(0, 1)).mean()),
        error_free=float(ripple.mean()),
        error_loaded=float(under.mean()),
        crank_position=played.crank,
        backlash_of_like_parts=played.alike,
        backlash_of_a_machine=played.worn[:, 0],
    )
