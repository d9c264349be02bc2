"""A preloaded screw joint: what torque gives, what embedding and load leave of it."""

from typing import Any

from screw_joint.frame import FRAME_SECTION, FRAME_SETTLING
from screw_joint.physics import CYCLES, GAUGE, bending, chance, gauge_drift, joint, settling
from screw_joint.quantities import Joint, Preload
from truing import (
    Effect,
    ErrorSource,
    Minimise,
    Model,
    Objective,
    Price,
    Published,
    Reliability,
    Require,
    Section,
    Sensitivity,
    Tolerance,
    Unknown,
    Vary,
    hookimpl,
    normal,
    plus_minus,
    zone,
)

TABLE = "VDI 2230-1, Table A1: M12, class 8.8, friction 0.12"

SCREW_JOINT = Model(
    name="screw_joint",
    title="A preloaded screw joint",
    function=joint,
    summary="Tightening by torque, loss of preload by embedding, clamping force that is left.",
    errors=[
        Tolerance("friction", normal(sd="10 %"), on=["thread_friction", "head_friction"], why="batches of lubricant"),
        Tolerance(
            "tightening_torque", plus_minus("8 %"), why="torque wrench",
            price=Price("3 + 20 / width", width="N*m", unit="EUR"),
        ),
        Tolerance("embedding", zone("-3 um", "3 um"), why="roughness of the faces"),
        Effect(
            "settling", on_inputs=settling, needs=[CYCLES], looks_like="an early loss of preload that comes to rest",
            unknowns=[Unknown("depth", 0, 20, "um"), Unknown("life", 1e2, 1e6, "1")],
        ),
        Effect(
            "bending", on_results=bending, looks_like="more alternating stress, in proportion",
            unknowns=[Unknown("share", 0, 2)],
        ),
        Effect(
            "gauge_drift", on_reading=gauge_drift, needs=[GAUGE], looks_like="follows the gauge's temperature",
            unknowns=[Unknown("slope", -200, 200, "N/K")],
        ),
    ],
    objectives=[
        Vary("tightening_torque", "60 N*m", "90 N*m"),
        Minimise("alternating_stress"),
        Require("equivalent_stress", at_most="proof_stress"),
        Require("clamp_left", at_least="needed_clamp", reliability=0.99),
    ],
    studies=[Sensitivity(of="clamp_left"), Reliability(draws=20_000, gives=chance)],
    sheet=[
        Section("Thread", "pitch_diameter", "core_diameter", "stress_area"),
        Section("Tightening", "preload", "thread_torque", "tension", "torsion", "equivalent_stress", "proof_stress"),
        Section("Joint", "screw_compliance", "plate_compliance", "load_factor", "preload_loss"),
        Section("In service", "clamp_left", "alternating_stress", "tight_share"),
    ],
    published=[
        Published(name="Preload", result="preload", value=43.0, printed="43.0", unit="kN", where=TABLE,
                  verdict="differs", why="1 % above the table; the reason is not known"),
        Published(name="Stress area of M12", result="stress_area", value=84.3, unit="mm^2", where="ISO 898-1, Table 4"),
    ],
    cites=["VDI 2230-1, Systematic calculation of highly stressed bolted joints.", "ISO 898-1."],
)  # fmt: skip


@hookimpl
def truing_models() -> list[Model[Joint, Preload]]:
    """Offer one calculation: screw_joint."""
    return [SCREW_JOINT]


@hookimpl
def truing_error_sources(model: Model[Any, Any]) -> list[ErrorSource[Any, Any]]:
    """The screws of a press's frame settle."""
    return [FRAME_SETTLING] if model.name == "press_linkage" else []


@hookimpl
def truing_objectives(model: Model[Any, Any]) -> list[Objective]:
    """Whoever screws a press together wants little tilt."""
    return [Minimise("slider_tilt")] if model.name == "press_linkage" else []


@hookimpl
def truing_reports(model: Model[Any, Any]) -> list[Section]:
    """Say so on the sheet of the press."""
    return [FRAME_SECTION] if model.name == "press_linkage" else []
