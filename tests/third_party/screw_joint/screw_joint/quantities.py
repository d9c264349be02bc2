"""What a screw joint is told and what it answers."""

from typing import Literal

from truing import Float, found, given, inputs, results


@inputs
class Joint:
    """One screw that presses plates together, tightened by torque."""

    thread_diameter: Float = given(12.0, "mm", symbol="d", note="nominal diameter of the thread", above=0)
    pitch: Float = given(1.75, "mm", symbol="P", note="of the thread", above=0)
    head_friction_diameter: Float = given(
        15.05, "mm", symbol="D_Km", note="mean diameter of friction under the head", source="VDI 2230-1, M12", above=0
    )
    strength_class: Literal["8.8", "10.9", "12.9"] = given("8.8", note="of the screw, ISO 898-1")
    tightening_torque: Float = given(84.0, "N*m", symbol="M_A", note="at the wrench", above=0)
    thread_friction: Float = given(0.12, "", symbol="mu_G", note="coefficient in the thread", above=0, below=1)
    head_friction: Float = given(0.12, "", symbol="mu_K", note="coefficient under the head", above=0, below=1)
    clamping_length: Float = given(60.0, "mm", symbol="l_K", note="of the plates together", above=0)
    plate_area: Float = given(330.0, "mm^2", symbol="A_ers", note="substitutional area of the plates", above=0)
    screw_modulus: Float = given(205.0, "GPa", symbol="E_S", note="of the screw", above=0)
    plate_modulus: Float = given(205.0, "GPa", symbol="E_P", note="of the plates", above=0)
    embedding: Float = given(11.0, "um", symbol="f_Z", note="flattening of all surfaces", at_least=0)
    extra_settling: Float = given(0.0, "um", symbol="f_x", note="loss of length that the design does not know")
    axial_force: Float = given(12.0, "kN", symbol="F_A", note="working force, largest", at_least=0)
    needed_clamp: Float = given(10.0, "kN", symbol="F_Kerf", note="clamping force that must be left", at_least=0)


@results
class Preload:
    """What is left of the preload, and how hard the screw works."""

    pitch_diameter: Float = found("mm", symbol="d_2", formula="thread_diameter - 0.649519 * pitch")
    core_diameter: Float = found("mm", symbol="d_3", formula="thread_diameter - 1.226869 * pitch")
    stress_area: Float = found("mm^2", symbol="A_S", formula="pi / 4 * ((pitch_diameter + core_diameter) / 2)**2")
    preload: Float = found(
        "kN", symbol="F_M", note="after tightening",
        formula="tightening_torque / (pitch / (2 * pi) + 0.577 * pitch_diameter * thread_friction"
        " + head_friction_diameter / 2 * head_friction)",
    )  # fmt: skip
    thread_torque: Float = found(
        "N*m", symbol="M_G", formula="preload * (pitch / (2 * pi) + 0.577 * pitch_diameter * thread_friction)"
    )
    tension: Float = found("MPa", symbol="sigma_M", formula="preload / stress_area")
    torsion: Float = found(
        "MPa", symbol="tau_M", formula="16 * thread_torque / (pi * ((pitch_diameter + core_diameter) / 2)**3)"
    )
    equivalent_stress: Float = found("MPa", symbol="sigma_red", formula="sqrt(tension**2 + 3 * torsion**2)")
    proof_stress: Float = found("MPa", symbol="R_p02", note="least 0.2 % proof stress of the class", source="ISO 898-1")
    screw_compliance: Float = found(
        "um/kN", symbol="delta_S", formula="clamping_length / (screw_modulus * stress_area)"
    )
    plate_compliance: Float = found("um/kN", symbol="delta_P", formula="clamping_length / (plate_modulus * plate_area)")
    load_factor: Float = found("", symbol="Phi", formula="plate_compliance / (screw_compliance + plate_compliance)")
    preload_loss: Float = found(
        "kN", symbol="F_Z", formula="(embedding + extra_settling) / (screw_compliance + plate_compliance)"
    )
    clamp_left: Float = found(
        "kN", symbol="F_KR", note="under the working force",
        formula="preload - preload_loss - (1 - load_factor) * axial_force",
    )  # fmt: skip
    alternating_stress: Float = found("MPa", symbol="sigma_a", formula="load_factor * axial_force / (2 * stress_area)")


@results
class Chance:
    """What the study of reliability adds."""

    tight_share: Float = found("%", symbol="R", note="share of joints that keep their clamping force")
