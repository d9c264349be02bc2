"""What the roller screw calculation is told: every quantity with unit, symbol, bounds and source.

The roller (external end gear) and the ring (internal gear) are named; no index is used, because those of the paper
contradict one another. A shift of the ring is positive outward.
"""

from typing import Literal

from truing import Float, given, inputs

PAPER = "the paper"
SET = "Table 1 of the paper is lost; one self-consistent set"
STUB = "Table 1 of the paper is lost; the tip of the roller must not exceed the crest of its thread"
CALIBRATED_SHIFTS = "Table 1 of the paper is lost; chosen so that both printed shifts mesh without backlash"
CALIBRATED_LOAD = "chosen so that the largest difference of the root stresses is the printed 33.2 MPa"
LOST_LIMIT = "the limit in equation 8 is lost; 1.2 is the common alternative"
LARGEST = 10000.0  # mm: a size above it was meant in another unit


def size(value: float, symbol: str, note: str, source: str = SET) -> float:
    """Declare a length, above zero."""
    declared: float = given(value, "mm", symbol=symbol, note=note, source=source, above=0, below=LARGEST)
    return declared


@inputs
class Pair:
    """Roller and ring, the load of their mesh, and what is asked of the pair."""

    # The screw
    screw_diameter: Float = size(30.0, "d_s", "pitch diameter of the thread of the screw")
    roller_diameter: Float = size(10.0, "d_r", "pitch diameter of the thread of a roller")
    lead: Float = size(10.0, "l", "lead of the screw; acts with effects only")
    rollers: int = given(10, symbol="n_r", note="rollers that share the load", source=SET, at_least=1, at_most=100)
    # The pair
    pressure_angle: Float = given(20.0, "deg", symbol="alpha", note="of the rack", source=PAPER, above=10, below=30)
    roller_teeth: Float = given(20.0, "", symbol="z_E", note="teeth of the roller", source=SET, at_least=8,
                                at_most=1000, whole=True)  # fmt: skip
    ring_teeth: Float = given(100.0, "", symbol="z_I", note="teeth of the ring", source=SET, at_least=16, at_most=5000,
                              whole=True)  # fmt: skip
    module: Float = size(0.5, "m", "module")
    addendum: Float = given(0.8, "", symbol="h_a*", note="addendum, in modules", source=STUB, above=0, at_most=2)
    clearance: Float = given(0.3, "", symbol="c*", note="tip clearance, in modules", source=STUB, at_least=0, at_most=1)
    roller_fillet: Float = given(0.30, "", symbol="rho_E*", note="fillet radius of the rack of the roller, in modules",
                                 source=SET, at_least=0, at_most=1)  # fmt: skip
    ring_fillet: Float = given(0.15, "", symbol="rho_I*", note="fillet radius of the substitute rack of the ring",
                               source="GB/T 3480-1997", at_least=0, at_most=1)  # fmt: skip
    cutter_teeth: Float = given(None, "", symbol="z_0", note="teeth of the shaper cutter that makes the ring; without "
                                "them the ring is a substitute rack", at_least=8, at_most=1000, whole=True)  # fmt: skip
    cutter_shift: Float = given(0.0, "", symbol="x_0", note="profile shift of the cutter: worn ones have less",
                                at_least=-1, at_most=1)  # fmt: skip
    cutter_addendum: Float = given(None, "", symbol="h_a0*", note="addendum of the cutter, in modules; else that of "
                                   "the ring and its clearance", above=0, at_most=3)  # fmt: skip
    cutter_fillet: Float = given(0.15, "", symbol="rho_a0*", note="radius at the tip of the cutter, in modules",
                                 source="as that of the substitute rack", above=0, at_most=1)  # fmt: skip
    centre_distance: Float = size(19.80778, "a_w", "working centre distance, fixed by the threads", CALIBRATED_SHIFTS)
    face_width: Float = size(4.0, "b", "face width")
    roller_shift: Float = given(
        0.21, "", symbol="x_E", note="profile shift of the roller, in modules: the design variable; that of the ring "
        "follows", source="the printed optimum, with 1 read as the roller", at_least=-2, at_most=3,
    )  # fmt: skip
    # The load
    axial_load: Float = given(10.0, "kN", symbol="F_a", note="on the screw; a negative one loads the other flanks",
                              source="a load of this size of screw")  # fmt: skip
    tangential_share: Float = given(5.1943e-3, "", symbol="kappa_t", note="tangential load of a mesh over the axial "
                                    "load", source=CALIBRATED_LOAD, at_least=0, at_most=1)  # fmt: skip
    mesh_stiffness: Float = given(14.0, "N/(mm*um)", symbol="c_gamma", note="mesh stiffness per face width; acts with "
                                  "effects only", source="ISO 6336-1: about 14 for steel", above=0)  # fmt: skip
    # What is asked, and how it is weighed
    least_contact_ratio: Float = given(1.4, "", symbol="epsilon_min", note="least contact ratio", source=LOST_LIMIT,
                                       at_least=1, at_most=3)  # fmt: skip
    interference_margin: Float = given(0.05, "rad", symbol="G_min", note="least margin against interference of the "
                                       "tips", source="equation 9", at_least=0, at_most=3)  # fmt: skip
    least_clearance: Float = given(0.1, "", symbol="c_min*", note="least clearance between tip and root, in modules",
                                   source="equations 10 and 11", at_least=0, at_most=1)  # fmt: skip
    least_tip_land: Float = given(0.25, "", symbol="s_a,min*", note="least tip land of the roller, in modules",
                                  source="common rule", at_least=0, at_most=1)  # fmt: skip
    most_sliding_difference: Float = given(3.08, "", symbol="f_3,max", note="largest difference of specific sliding",
                                           source="printed upper limit, taken as bound of the search",
                                           above=0)  # fmt: skip
    sliding_reading: Literal["path", "roots"] = given(
        "path",
        note="third objective: of the largest sliding of each gear on the path of contact, or of that at the roots, "
        "which folds where the path begins near the pitch point",
    )
    weights: Literal["own_ranges", "printed_ranges", "printed"] = given(
        "own_ranges",
        note="weights of the objectives: by the paper's rule from the ranges found here, by its rule "
        "from the ranges that it prints, or as it prints them",
    )
    # Neutral inputs: effects reach the calculation through them
    face_load_factor: Float = given(1.0, "", symbol="K_Hbeta", note="neutral 1: uneven load along the face", above=0)
    dynamic_factor: Float = given(1.0, "", symbol="K_V", note="neutral 1: load in motion over load at rest", above=0)
    sharing_factor: Float = given(1.0, "", symbol="K_gamma", note="neutral 1: load of this roller over the mean",
                                  above=0)  # fmt: skip
    carrying_share: Float = given(1.0, "", symbol="f_b", note="neutral 1: share of the face width that carries",
                                  above=0, at_most=1)  # fmt: skip
    rim_factor: Float = given(1.0, "", symbol="Y_B", note="neutral 1: raises the root stress of the ring", above=0)
    centre_distance_deviation: Float = given(
        0.0, "um", symbol="Delta a", note="neutral 0: centres farther apart than without backlash; "
        "above 0 the teeth of an internal pair jam, below 0 they have backlash", at_least=-1000, at_most=1000,
    )  # fmt: skip
