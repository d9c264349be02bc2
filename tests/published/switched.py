"""One effect of a calculation switched on, without an inputs file: unknowns, conditions and results in SI."""

from typing import Any


def shown(model: Any, name: str = "", inputs: Any = None, **values: Any) -> dict[str, Any]:
    """The results by name, with this effect on or with none."""
    stated = model.inputs() if inputs is None else inputs
    if not name:
        found = model.function(stated)
    elif (effect := model.effects[name]).place == "inputs":
        found = model.function(effect.function(stated, **values))
    else:
        found = effect.function(stated, model.function(stated), **values)
    return dict(model.read_results(found))


def change(model: Any, result: str, name: str, inputs: Any = None, **values: Any) -> Any:
    """What one effect adds to a result."""
    return shown(model, name, inputs, **values)[result] - shown(model, "", inputs)[result]
