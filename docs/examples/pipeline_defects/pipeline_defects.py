"""How deep is a defect of a pipeline by ultrasound in the field? As deep as in the laboratory, if the gauge is true."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Section,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    results,
)


@inputs
class Defect:
    """A defect as measured in the laboratory, and what the gauge in the field may make of it (neutral as declared)."""

    lab_size: Float = given(40.0, "mil", symbol="d", note="depth of the defect, from the laboratory", above=0)
    compression: Float = given(0.0, "", symbol="q", note="1 minus the power with which the reading follows the depth")
    set_size: Float = given(20.0, "mil", symbol="d_s", note="depth at which the gauge was set", above=0)
    beam: Float = given(0.0, "1/mil", symbol="k", note="one over the depth that fills the beam")
    smallest: Float = given(0.0, "mil", symbol="d_0", note="depth that a sound wall shows")
    gauge_factor: Float = given(1.0, "", symbol="g", note="what the gauge shows of what it sees", above=0)


@results
class Reading:
    """What the gauge shows."""

    field_size: Float = found(
        "mil", symbol="d_f", note="depth of the defect, from the field",
        formula="gauge_factor * hypot(set_size * (lab_size / (1 + beam * lab_size) / set_size)**(1 - compression), "
        "smallest)",
    )  # fmt: skip


def pipeline_defects(defect: Defect) -> Reading:
    """Field equals laboratory: compression, beam and smallest depth are 0 until an effect says otherwise."""
    seen = defect.lab_size / (1 + defect.beam * defect.lab_size)
    echo = defect.set_size * (seen / defect.set_size) ** (1 - defect.compression)
    return Reading(field_size=defect.gauge_factor * np.hypot(echo, defect.smallest))


BATCH = Condition(
    "batch_number", "", reference=1, role="goes_on", note="the batch in which a defect was sized, in their order"
)


def compressed_echo(defect: Defect, *, compression: Float, set_size: Float) -> Defect:
    """The reading follows a power of the depth, and was set right at one depth."""
    size = np.where(np.equal(compression, 0), defect.set_size, set_size)
    return replace(defect, compression=defect.compression + compression, set_size=size)


def narrow_beam(defect: Defect, *, beam: Float) -> Defect:
    """A large defect fills the beam: what is larger is hardly seen any larger."""
    return replace(defect, beam=defect.beam + beam)


def rough_wall(defect: Defect, *, smallest: Float) -> Defect:
    """A rough wall without a defect shows a depth of its own, which adds to small defects as squares do."""
    return replace(defect, smallest=defect.smallest + smallest)


def worn_probe(defect: Defect, *, per_batch: Float, batch_number: Float) -> Defect:
    """The probe wears: from batch to batch it shows a little less, or more."""
    return replace(defect, gauge_factor=defect.gauge_factor * np.exp(per_batch * (batch_number - BATCH.zero)))


def effect(
    function: Callable[..., Defect], *unknowns: Unknown, looks_like: str, needs: tuple[Condition, ...] = ()
) -> Effect[Defect, Reading]:
    """Declare an effect on the inputs under the name of its function."""
    return Effect(
        function.__name__, on_inputs=function, unknowns=list(unknowns), looks_like=looks_like, needs=needs,
        why=str(function.__doc__).splitlines()[0].rstrip("."),
    )  # fmt: skip


PIPELINE_DEFECTS = Model(
    name="pipeline_defects",
    title="Depth of defects of a pipeline",
    function=pipeline_defects,
    cites=[
        "NIST/SEMATECH e-Handbook of Statistical Methods, section 4.6.2, Alaska Pipeline; data: H. Berger, NIST",
    ],
    errors=[
        effect(
            compressed_echo,
            Unknown("compression", -0.5, 0.5),
            Unknown("set_size", 2, 100, "mil", note="where field and laboratory agree"),
            looks_like="a straight line in a plot of the logarithms, with another slope than 1",
        ),
        effect(
            narrow_beam, Unknown("beam", 0, 0.05, "1/mil"), looks_like="true for small defects, too little for large"
        ),
        effect(rough_wall, Unknown("smallest", 0, 20, "mil"), looks_like="small defects are too deep, large ones true"),
        effect(worn_probe, Unknown("per_batch", -0.2, 0.2), needs=(BATCH,), looks_like="follows the batches"),
    ],
    sheet=[Section("Reading", "field_size")],
)


@hookimpl
def truing_models() -> list[Model[Defect, Reading]]:
    """Offer one calculation: pipeline_defects."""
    return [PIPELINE_DEFECTS]
