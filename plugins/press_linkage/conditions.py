"""What else must be measured before the effects of the press can act: each condition once, shared by its effects."""

from truing import Condition

LINK_TEMPERATURE = Condition(
    "link_temperature", "degC", reference=20, note="temperature of the links", low=15, high=60
)  # fmt: skip
FORMING_FORCE = Condition(
    "forming_force", "kN", reference=0, low=-200, high=2000,
    note="force on the slider, central; positive pushes it up; where weight and counterbalance leave nothing of it, "
    "that counts as up",
)  # fmt: skip
TIME = Condition(
    "time", "h", reference=0, derived="since_start", low=0, high=10, note="time at work since the first row"
)  # fmt: skip
STROKES = Condition(
    "strokes", "", reference=0, derived="since_start", low=0, high=1e6, note="strokes made since the first row"
)  # fmt: skip
SPEED = Condition("speed", "rpm", reference=0, note="speed of the cranks", low=5, high=60)
DIRECTION = Condition(
    "direction", "", reference=0, low=-1, high=1,
    note="way of the slider: +1 towards its bottom dead centre, -1 away from it",
)  # fmt: skip
