"""The calculation as truing knows it: function, error sources, goals, studies and sheet."""

from pathlib import Path

from harmonic_fractal import figures
from harmonic_fractal.calculation import harmonic_fractal
from harmonic_fractal.effects import EFFECTS
from harmonic_fractal.pressed import PressedFlanks
from harmonic_fractal.published import FINDINGS, PUBLISHED
from harmonic_fractal.uncertainty import SOURCES, TOLERANCES, SurfaceValidity, Uncertainty, slopes
from truing import Maximise, Model, Optimise, Reliability, Require, Section, Sensitivity, Sweep, Vary

LITERATURE = [
    "The patent: modelling method for the single-tooth contact stiffness and mesh clearance of a harmonic gear "
    "(一种谐波齿轮单齿接触刚度和啮合间隙建模方法), China, published 2022.",
    "Majumdar, A., Tien, C. L., Fractal characterization and simulation of rough surfaces, Wear 136 (1990), p. 313: "
    "Weierstrass-Mandelbrot profiles and their structure function.",
    "Yan, W., Komvopoulos, K., Contact analysis of elastic-plastic fractal surfaces, Journal of Applied Physics 84 "
    "(1998), p. 3617: areal surfaces, interference, critical area.",
    "Wang, S., Komvopoulos, K., A fractal theory of the interfacial temperature distribution in the slow sliding "
    "regime, Journal of Tribology 116 (1994), pp. 812 and 824: number and areas of contacts.",
    "Jiang, S., Zheng, Y., Zhu, H., A contact stiffness model of machined plane joint based on fractal theory, Journal "
    "of Tribology 132 (2010), 011401.",
    "Chang, W. R., Etsion, I., Bogy, D. B., An elastic-plastic model for the contact of rough surfaces, Journal of "
    "Tribology 109 (1987), p. 257: first yield.",
    "Morag, Y., Etsion, I., Resolving the contradiction of asperities plastic to elastic mode transition in current "
    "contact models of fractal rough surfaces, Wear 262 (2007), p. 624.",
    "Persson, B. N. J., Relation between interfacial separation and load: a general theory of contact mechanics, "
    "Physical Review Letters 99 (2007), 125502.",
    "Polonsky, I. A., Keer, L. M., A numerical method for solving rough contact problems based on the multi-level "
    "multi-summation and conjugate gradient techniques, Wear 231 (1999), p. 206.",
    "Malinverno, A., A simple method to estimate the fractal dimension of a self-affine series, Geophysical Research "
    "Letters 17 (1990), p. 1953: the roughness-length method.",
    "Yang, D. C. H., Sun, Z. S., A rotary model for spur gear dynamics, Journal of Mechanisms, Transmissions and "
    "Automation in Design 107 (1985), p. 529: line contact.",
    "Harmonic Drive LLC, Cup Type Component Sets and Housed Units, CSF and CSG series; Harmonic Drive AG, CHA "
    "actuators, manual 1018854: torsional stiffness.",
]

# The sheet, in the order an engineer reads it
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
        "shear_modulus", "cup_moment", "cup_stiffness", "series_compliance", "ball_torsion", "wave_torsion",
        "wave_compliance",
        "torsional_stiffness", "torsion", "rough_torsion", "catalogue_torsion", "catalogue_stiffness",
        "catalogue_ratio", "rough_share",
        text="Torsion is the integral of compliance over torque, from the reference torque on. Beside it stands what "
        "the maker's catalogue says of a drive of this size.",
        blocks=figures.torsion,
    ),
]  # fmt: skip

HARMONIC_FRACTAL = Model(
    name="harmonic_fractal",
    title="Harmonic drive: contact stiffness and clearance of rough flanks",
    function=harmonic_fractal,
    errors=[*TOLERANCES, *EFFECTS],
    objectives=[
        Require("surface_accepted", at_least="yes"),
        Require("stiffness", at_least="required_stiffness", reliability="required_reliability"),
        Vary("fractal_dimension", "2.2", "2.7"),
        Vary("fractal_roughness", "1e-12 m", "1e-10 m"),
        Maximise("stiffness"),
        Maximise("rough_height"),
    ],
    studies=[
        SurfaceValidity(),
        Sensitivity(of=("stiffness", "torsion"), at_inputs=SOURCES, gives=slopes),
        Uncertainty(),
        PressedFlanks(),
        Reliability(draws=20_000),
        Sweep(over="torque", at="0..50 N*m", points=51),
        Optimise(population=40, generations=50, chance="first_order", verify=20_000),
    ],
    sheet=SECTIONS,
    published=PUBLISHED,
    findings=FINDINGS,
    cites=LITERATURE,
    example=Path(__file__).with_name("example.toml"),
    summary="How stiff are the rough flanks of a pair of teeth, and how much of the drive's torsion is theirs?",
)
