"""The press linkage as truing knows it: function, error sources, goals, studies and sheet."""

from pathlib import Path

from press_linkage.answers import Readings, chances, cycle, influence, synthesis
from press_linkage.effects import EFFECTS
from press_linkage.errors import exact_derivatives, press_linkage, source
from press_linkage.over_the_stroke import OverTheStroke
from press_linkage.published import FINDINGS, PUBLISHED
from press_linkage.sheet import SECTIONS
from truing import (
    Allocation,
    Model,
    Price,
    Reliability,
    Require,
    Sensitivity,
    Sweep,
    Tolerance,
    by_choice,
    grade,
    off,
    plus_minus,
)

LITERATURE = [
    "The paper: Qian Huanan, Tao Jing, Yu Suiran (騫華楠, 陶璟, 于隨然), error analysis and accuracy synthesis of a "
    "parallel-driven multi-link servo press, School of Mechanical Engineering, Shanghai Jiao Tong University.",
    "K. W. Chase, S. P. Magleby, J. Gao, Tolerance analysis of 2-D and 3-D mechanical assemblies with small kinematic "
    "adjustments, ADCATS Report 97-5, Brigham Young University, 1997.",
    "K. W. Chase, A. R. Parkinson, A survey of research in the application of tolerance analysis to the design of "
    "mechanical assemblies, Research in Engineering Design 3, 1991.",
    "ISO 286-1:2010, ISO code system for tolerances on linear sizes.",
]
SIDES = (1, 2)
LINKS = {
    "crank_radius": "a",
    "rod_length": "k_R",
    "knee_drive_length": "l_g",
    "upper_knee_length": "l_m",
    "lower_knee_length": "l_h",
}
COST = Price("1 / width", width="mm", unit="1/mm")


def on_both(kind: str) -> list[str]:
    """The inputs of both sides that carry errors of this kind."""
    return [source(kind, side) for side in SIDES]


def link(kind: str, symbol: str) -> Tolerance:
    """A link length of both sides, made to an ISO 286 grade of its nominal size."""
    return Tolerance(
        kind, grade("IT7", size=kind), on=on_both(kind), price=COST, source=f"Table 3, {symbol}",
        why="length of the finished link between its bores",
    )  # fmt: skip


def joint(
    kind: str, half: str, coordinate: str, *, radius: str = "", printed: str = "", chosen: bool = True
) -> Tolerance:
    """A joint that is mounted beside its place: along its radius or, with *radius*, across it.

    What the printed reliabilities do not contain is off in the reading ``printed``, where the reading can be *chosen*.
    """
    spread = plus_minus(half, at_radius=radius)
    other = plus_minus(printed) if printed else off()
    kept = not chosen or (radius == "" and not printed)
    return Tolerance(
        kind,
        spread if kept else by_choice("reading", complete=spread, printed=other),
        on=on_both(kind),
        source=f"Table 3, {coordinate}",
        why="place of the mounted joint" + (", across its radius" if radius else ", along its radius"),
    )


def parts(*, chosen: bool = True) -> list[Tolerance]:
    """The tolerances of the 29 sources: links, joints and crank angle, by the reading where it can be *chosen*."""
    return [
        *(link(kind, symbol) for kind, symbol in LINKS.items()),
        Tolerance(
            "platform_arm", grade("IT7", size="platform_arm"), on=["platform_arm_deviation"], price=COST,
            source="Table 3, k", why="length of the finished arm",
        ),
        joint("slider_half_width", "0.05 mm", "y_H", chosen=chosen),
        joint("slider_joint_angle", "0.05 mm", "z_H", radius="slider_half_width", chosen=chosen),
        joint("crank_pivot_radius", "0.1 mm", "y_A", printed="0.05 mm", chosen=chosen),
        joint("crank_pivot_angle", "0.1 mm", "z_A", radius="crank_pivot_radius", chosen=chosen),
        joint("platform_half_width", "0.05 mm", "y_E", chosen=chosen),
        joint("platform_joint_angle", "0.05 mm", "z_E", radius="platform_half_width", chosen=chosen),
        joint("ground_pivot_radius", "0.05 mm", "y_M and z_M", chosen=chosen),
        joint("ground_pivot_angle", "0.05 mm", "y_M and z_M", radius="ground_pivot_radius", chosen=chosen),
        Tolerance(
            "crank_angle", off(), on=on_both("crank_angle"),
            why="angle of the servo crank; the paper gives none, and at the dead centre it does not matter",
        ),
    ]  # fmt: skip


PRESS_LINKAGE = Model(
    name="press_linkage",
    title="Parallel-driven multi-link servo press: slider accuracy",
    function=press_linkage,
    derivatives=exact_derivatives,
    errors=[*parts(), *EFFECTS],
    objectives=[
        Require("slider_position", within="position_limit", reliability="position_goal"),
        Require("slider_tilt", within="permitted_tilt", reliability="tilt_goal"),
    ],
    studies=[
        Sweep(over="crank_angle", at="-180..180 deg", points=361, gives=cycle),
        Sensitivity(of=("slider_position", "slider_tilt"), gives=influence),
        Reliability(gives=chances),
        Allocation(rule="balanced", of="slider_position", finest="IT5", gives=synthesis),
        Readings(finest="IT5"),
        OverTheStroke(),
    ],
    sheet=SECTIONS,
    published=PUBLISHED,
    findings=FINDINGS,
    cites=LITERATURE,
    example=Path(__file__).with_name("example.toml"),
    summary="Where is the slider of a servo press with 29 small errors, how reliably does it stay within its limits, "
    "and which tolerance is worth tightening?",
)
