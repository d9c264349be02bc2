"""A made flank as truing knows it: function, study and sheet."""

from pathlib import Path

from harmonic_fractal.made_calculation import made_flank
from harmonic_fractal.made_file import FlankFile
from harmonic_fractal.made_sections import SECTIONS
from truing import Model

LITERATURE = [
    "Majumdar, A., Tien, C. L., Fractal characterization and simulation of rough surfaces, Wear 136 (1990), p. 313.",
    "Yan, W., Komvopoulos, K., Contact analysis of elastic-plastic fractal surfaces, Journal of Applied Physics 84 "
    "(1998), p. 3617.",
    "Davies, R. B., Harte, D. S., Tests for Hurst effect, Biometrika 74 (1987), p. 95.",
    "Stein, M. L., Fast and exact simulation of fractional Brownian surfaces, Journal of Computational and Graphical "
    "Statistics 11 (2002), p. 587.",
    "ISO 16610-21, Geometrical product specifications: filtration, linear profile filters: Gaussian filters.",
]

MADE_FLANK = Model(
    name="made_flank",
    title="Made flank: a rough surface of known truth",
    function=made_flank,
    studies=[FlankFile()],
    sheet=SECTIONS,
    cites=LITERATURE,
    example=Path(__file__).with_name("made_flank.toml"),
    summary="What does a flank of a given fractal dimension and roughness look like, and does an estimator find them "
    "again through noise, filter, holes and spikes? The flank is written as a file.",
)
