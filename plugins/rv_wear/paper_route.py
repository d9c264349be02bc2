"""A study of our own: the paper's route, Gaussian process first and everything else on it, beside full physics."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np

from rv_wear.calculation import backlash_of, rv_wear
from rv_wear.quantities import Reducer
from rv_wear.wear import oil_part
from truing import (
    Array,
    Bench,
    Block,
    Emulated,
    Float,
    Optimise,
    Optimum,
    Outcome,
    Table,
    TruingError,
    found,
    results,
)

LEARNT_FROM = ("output_torque", "output_speed", "working_time", "equidistant_modification", "shift_modification")
BOTH_WAYS = "the same machines, wear by the Gaussian process"


@results
class RouteAnswers:
    """Reliability and knee of the paper's route, and what they are by full physics."""

    learnt_reliability: Float = found("%", symbol="R_GP", note="share of machines within the permitted backlash",
                                      method=BOTH_WAYS)  # fmt: skip
    learnt_loss: Float = found("%", symbol="R_GP - R", note="what the Gaussian process adds to that of full physics",
                               method="difference of both counts")  # fmt: skip
    learnt_backlash_error: Float = found("arcmin", symbol="e_GP", note="largest error of the backlash of a machine",
                                         method="over these machines")  # fmt: skip
    learnt_knee_cost: Float = found("yuan", symbol="C_GP", note="cost at the knee of the learnt front",
                                    method="genetic algorithm on the Gaussian process")  # fmt: skip
    learnt_knee_wear: Float = found("um", symbol="h_GP", note="deepest wear there, as learnt",
                                    method="Gaussian process")  # fmt: skip
    learnt_knee_true: Float = found("um", symbol="h_GP,x", note="deepest wear there, by full physics",
                                    method="equations 13 to 16")  # fmt: skip
    learnt_front_error: Float = found("%", symbol="e_f", note="largest error of the wear on the learnt front",
                                      method="learnt over full physics")  # fmt: skip


@dataclass(frozen=True, eq=False)
class LearntReducer(Outcome):
    """The reducer with the wear of a surrogate: what an optimisation or a count asks instead of the model.

    A wear coefficient that is larger by a factor wears as if the working time were, and so do the shares of the flanks;
    everything but the wear is the model's own. Without film and ageing, which know the time otherwise.
    """

    emulated: Emulated
    reducer: Reducer

    @property
    def of(self) -> tuple[str, ...]:
        """The results it knows."""
        return ("max_wear", "backlash", "max_pressure")

    def as_json(self) -> Mapping[str, Any]:
        """Return nothing of its own."""
        return {}

    def predict(self, columns: Mapping[str, Any]) -> dict[str, Array]:
        """Return these results (n,) in SI from inputs (n,) or numbers in SI."""
        known = {name: value for name, value in columns.items() if hasattr(self.reducer, name)}
        reducer = replace(self.reducer, **known)
        faster = oil_part(reducer) * reducer.sliding_factor / (oil_part(self.reducer) * self.reducer.sliding_factor)
        share = reducer.reversing
        first, other = (1.0, 1.0) if share is None or np.isnan(share) else (1.0 - share / 2.0, share / 2.0)
        depths = [self._depth(reducer, faster * part) for part in (first, other)]
        deep = reducer.depth_factor * depths[0] + reducer.extra_wear
        felt = reducer.lost_motion_share * (1.0 + reducer.pin_wear_ratio)
        felt = felt * (reducer.depth_factor * (depths[0] + depths[1]) / 2.0 + reducer.extra_wear)
        new = rv_wear(replace(reducer, working_time=0.0 * np.asarray(reducer.working_time)))
        return {
            "max_wear": np.asarray(deep),
            "backlash": np.asarray(backlash_of(reducer, felt)["backlash"]),
            "max_pressure": np.asarray(new.max_pressure),
        }

    def extrapolated(self, columns: Mapping[str, Any]) -> Any:
        """Say per calculation (n,) whether it lies outside the box of the surrogate."""
        return self.emulated.extrapolated({name: columns[name] for name in LEARNT_FROM if name in columns})

    def _depth(self, reducer: Reducer, longer: Float) -> Array:
        """Deepest wear (n,) after so many times the working time; 0 for none."""
        columns = {name: getattr(reducer, name) for name in LEARNT_FROM}
        time = np.asarray(columns["working_time"] * longer)
        asked = {**columns, "working_time": np.maximum(time, 1.0)}
        return np.where(time > 0.0, self.emulated.predict(asked)["max_wear"], 0.0)


@dataclass(frozen=True, kw_only=True)
class PaperRoute:
    """Count ``draws`` machines and search with a genetic algorithm, both on the surrogate that ran before.

    Beside them stand the same machines and the same designs by full physics: what the surrogate loses.
    """

    draws: int = 10_000
    population: int = 60
    generations: int = 40
    widest: float = 2.0
    name: str = "paper_route"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if self.draws < 2:
            raise TruingError(f"study '{self.name}': draws = {self.draws}, but at least 2 machines are compared")

    def run(self, bench: Bench) -> "Route":
        """Go the paper's way, then look at what it found. Raises TruingError without a surrogate, or with a film."""
        emulated = next((each for each in bench.outcomes.values() if isinstance(each, Emulated)), None)
        if emulated is None or "max_wear" not in emulated.of:
            raise TruingError(f"study '{self.name}': no surrogate of max_wear ran before it; list 'surrogate' first")
        if np.any(np.asarray(bench.inputs.film_factor) > 0.0) or np.any(np.asarray(bench.inputs.ageing_rate) != 0.0):
            raise TruingError(
                f"study '{self.name}': with a film or ageing oil a larger wear coefficient is no longer time, and the "
                "surrogate knows no other; leave the study out, or film_factor and ageing_rate at 0"
            )
        learnt = LearntReducer(emulated, bench.inputs)
        columns = bench.drawn(self.draws)
        guessed = np.broadcast_to(learnt.predict(columns)["backlash"], (self.draws,))
        exact = np.asarray(bench.rows(columns, self.draws, "backlash")["backlash"])
        search = Optimise(
            chance="first_order", population=self.population, generations=self.generations, widest=self.widest,
            surrogate=True, verify=1, name=self.name,
        )  # fmt: skip
        optimum = search.run(replace(bench, outcomes={"learnt": learnt}))
        return Route(
            optimum=optimum,
            learnt=guessed,
            exact=exact,
            limit=float(bench.inputs.permitted_backlash),
            wear=np.array([point.objectives["max_wear"] for point in optimum.front]),
            true_wear=_true_wear(bench.inputs, optimum),
        )


def _true_wear(reducer: Reducer, optimum: Optimum) -> Array:
    """Deepest wear (n,) of the designs of the front by full physics."""
    if not optimum.front:
        return np.empty(0)
    chosen = ("equidistant_modification", "shift_modification")
    equidistant, shift = (np.array([point.inputs[name] for point in optimum.front]) for name in chosen)
    ground = replace(reducer, equidistant_modification=equidistant, shift_modification=shift)
    return np.asarray(rv_wear(ground).max_wear)


@dataclass(frozen=True, kw_only=True, eq=False)
class Route(Outcome):
    """The learnt optimum; backlash (n,) of the same machines both ways, rad; wear (m,) of the front both ways, m."""

    optimum: Optimum
    learnt: Array
    exact: Array
    limit: float
    wear: Array
    true_wear: Array

    def as_json(self) -> Mapping[str, Any]:
        """Return the share of machines both ways and the errors of the front."""
        return {
            "machines": len(self.exact),
            "reliability": {"learnt": self.share(self.learnt), "full_physics": self.share(self.exact)},
            "front": {
                "unit": "um",
                "learnt": (self.wear * 1e6).tolist(),
                "full_physics": (self.true_wear * 1e6).tolist(),
            },
        }

    def share(self, backlash: Array) -> float:
        """The share of machines within the limit."""
        return float(np.mean(backlash <= self.limit))

    def blocks(self) -> Sequence[Block]:
        """Return both ways side by side."""
        given = routed(self)
        wear = [float(depth) * 1e6 for depth in (given.learnt_knee_wear, given.learnt_knee_true)]
        rows: list[tuple[str | float, ...]] = [
            ("machines within the limit, %", 100 * self.share(self.learnt), 100 * self.share(self.exact)),
            ("deepest wear at the learnt knee, µm", wear[0], wear[1]),
        ]
        note = f"The same {len(self.exact)} machines, and the knee of a genetic algorithm that saw the surrogate only."
        return [Table("The paper's route and full physics", ("", "Gaussian process", "full physics"), rows, note=note)]

    def warnings(self) -> Sequence[str]:
        """Say where the search found nothing or left the box."""
        return self.optimum.warnings()


def routed(route: Route) -> RouteAnswers:
    """The numbers of the study; none of a knee where nothing reaches the limit."""
    knee = route.optimum.knee
    place = route.optimum.knee_place
    error = route.wear / route.true_wear - 1.0
    return RouteAnswers(
        learnt_reliability=route.share(route.learnt),
        learnt_loss=route.share(route.learnt) - route.share(route.exact),
        learnt_backlash_error=float(np.nanmax(np.abs(route.learnt - route.exact))),
        learnt_knee_cost=nan if knee is None else float(knee.objectives["tolerance_price"]),
        learnt_knee_wear=nan if place is None else float(route.wear[place]),
        learnt_knee_true=nan if place is None else float(route.true_wear[place]),
        learnt_front_error=float(np.abs(error).max()) if len(error) else nan,
    )
