"""A harmonic drive's record, or that of a surface, as files, and what Truing says to it."""

from math import isfinite

from hidden_effects.harmonic_cases import UNIT, Case, Wish
from hidden_effects.harmonic_surface import STRUCTURE, SurfaceCase
from hidden_effects.plugin_asking import Answer, Rig

INPUTS = """plugin = "harmonic_fractal"

[inputs]
fractal_dimension = "2.5"
fractal_roughness = "1e-9 m"
convention = "areal"
reference_torque = "20 mN*m"
drive_compliance = "36 urad/(N*m)"
{tooth}
[studies.diagnose]
box = {{ torque = "-40..40 N*m" }}
"""
PAST = {"torque": "N*m", "reversal_torque": "N*m", "peak_torque": "N*m", "direction": "1"}
LOGS = {"time": "h", "wave_angle": "deg", "temperature": "degC", "cycles": "1", "speed": "r/min"}
FLANK = Rig(
    plugin="harmonic_fractal",
    inputs='plugin = "harmonic_fractal"\n',
    written={"lag": "um", "sigma_structure_function": "um^2"},
    measured={STRUCTURE: "um^2"},
)


def diagnosed(case: Case | SurfaceCase) -> Answer:
    """Ask for a diagnosis of the record and predict the rows that were held out."""
    return (drive(case.wish) if isinstance(case, Case) else FLANK).diagnosed(case)


def drive(wish: Wish) -> Rig:
    """The rig of a drive that writes down what was wished for beside the torque and its past."""
    written = PAST | {name: LOGS[name] for name in wish.logs}
    tooth = f'tooth_stiffness = "{wish.tooth:g} N/m"\n' if isfinite(wish.tooth) else ""
    return Rig(plugin="harmonic_fractal", inputs=INPUTS.format(tooth=tooth), written=written, measured=UNIT)
