"""The sheet, in the order an engineer reads it."""

from harmonic_fractal import figures
from truing import Section

SECTIONS = [
    Section(
        "The flanks as measured",
        "surface_accepted", "spacing",
        text="Form is removed, holes and spikes are left out, and each line is levelled. The structure function of a "
        "self-affine surface is a power of the lag; only where it is one over a decade of lags do D and G mean "
        "anything.",
        blocks=figures.flanks,
    ),
    Section(
        "D and G of both flanks",
        "dimension", "profile_dimension", "roughness", "lag", "structure_function",
        text="Two rough flanks are taken as one against a smooth one. G is a number in metres that changes by factors "
        "with its convention; inside this calculation it is the areal one.",
        blocks=figures.interface,
    ),
    Section(
        "Stiffness of one pair",
        "equivalent_modulus", "critical_pressure", "domain_factor", "critical_area", "resolved_share",
        "plastic_limit", "area_ratio", "elastic_sum", "largest_area", "plastic_share", "contact_area", "real_area",
        "flank_share", "tip_factor", "stiffness", "load_exponent",
        text="Under load many small contacts form. Each has the interference and the tip radius of a wave of its own "
        "size; those below the critical area are plastic and give no stiffness. The load sets the largest contact, "
        "and all of them together the stiffness.",
        blocks=figures.stiffness,
    ),
    Section(
        "What the stiffness hangs on",
        "slope_dimension", "slope_roughness", "slope_hardness", "slope_load",
        text="Larger D at the same G means finer roughness and a stiffer pair; larger G a softer one.",
    ),
    Section(
        "Clearance of one pair",
        "largest_radius", "clearance_radius", "clearance_multiple", "clearance", "rough_height",
        "mating_rough_height", "open_clearance", "reference_load", "approach", "closing_clearance", "free_play",
        text="Equation 7 gives a length that grows with the load: the amplitude of the largest contact, half its "
        "interference. It is no gap that closes. What closes is the distance of the mean planes, from the height of "
        "the unloaded flanks less the approach under load; and even that is the clearance of roughness only. The "
        "mesh clearance of a drive comes from tooth form, assembly and wear.",
    ),
    Section(
        "Mesh",
        "effective_radius", "pairs_factor", "largest_share", "largest_pair_force", "plastic_torque", "line_stiffness",
        "normal_stiffness", "mesh_stiffness", "mesh_torsion",
        text="Engaged pairs stand in two opposite arcs and share the torque; their stiffnesses add up. Bending of the "
        "teeth is in series with each contact where tooth_stiffness is stated.",
    ),
    Section(
        "Torsion of the drive",
        "shear_modulus", "cup_moment", "cup_stiffness", "series_compliance", "torsional_stiffness", "torsion",
        "rough_torsion", "catalogue_torsion", "catalogue_stiffness", "rough_share",
        text="Torsion is the integral of compliance over torque, from the reference torque on. Beside it stands what "
        "the maker's catalogue says of a drive of this size.",
        blocks=figures.torsion,
    ),
]  # fmt: skip
