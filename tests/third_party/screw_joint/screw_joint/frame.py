"""What this guest adds to the press: the frame's own screws settle, and the press rises on them."""

from dataclasses import replace
from typing import Any

from truing import Condition, Effect, Float, Section, Unknown

HOURS = Condition("hours_since_assembly", "h", reference=0, note="since the frame was screwed together")


def frame_settling(press: Any, *, lift: Float, hours_since_assembly: Float) -> Any:
    """The ground pivots move inward in proportion to the time since assembly; ``lift`` is the move in 1000 h."""
    move = lift * hours_since_assembly / 3.6e6
    return replace(
        press,
        side_1=replace(press.side_1, ground_pivot_radius_deviation=press.side_1.ground_pivot_radius_deviation - move),
        side_2=replace(press.side_2, ground_pivot_radius_deviation=press.side_2.ground_pivot_radius_deviation - move),
    )


FRAME_SETTLING: Effect[Any, Any] = Effect(
    "frame_settling",
    on_inputs=frame_settling,
    needs=[HOURS],
    unknowns=[Unknown("lift", 0, 200, "um", note="in the first 1000 hours")],
    looks_like="the slider rises slowly with the hours since assembly, alike at every crank angle",
    why="the screwed joints of the frame embed",
)
FRAME_SECTION = Section(
    "Screwed joints of the frame",
    text="The frame of the press is screwed together; its joints settle (screw_joint, effect frame_settling).",
)
