"""Parameters of a controller, from values by name to the vector that its function gets."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import Vec
from mimics_app.contracts.errors import UsageError, counted, nearest
from mimics_app.contracts.loop.controller_port import ControllerParameter, ControllerPlugin, places_of
from mimics_app.contracts.loop.controller_slots import CONTROLLER_PARAMETERS

__all__ = ["Changed", "Values", "changed_components", "parameter_vector"]

Values = Mapping[str, float | Sequence[float]]
"""Values of parameters by name."""


def parameter_vector(controller: ControllerPlugin, values: Values) -> Vec:
    """Return the parameters of a controller, shape [CONTROLLER_PARAMETERS].

    Args:
        controller: The controller.
        values: Values by name; those missing have their default.

    Raises:
        UsageError: No such parameter, too many components, or a value outside its range.
    """
    known = [each.name for each in controller.parameters]
    for name in values:
        if name not in known:
            raise UsageError(f'the controller "{controller.name}" has no parameter "{name}"', nearest(name, known))
    parts = [_components(controller.name, each, values.get(each.name, each.default)) for each in controller.parameters]
    vector = np.zeros(CONTROLLER_PARAMETERS)
    if parts:
        used = np.concatenate(parts)
        vector[: used.size] = used
    return vector


class Changed(NamedTuple):
    """A parameter's new value.

    Attributes:
        components: Indices of its components in the vector.
        value: Value of each, within the limits that the parameter declares.
        remark: Words to a person: that the value is limited; "" otherwise.
    """

    components: range
    value: float
    remark: str = ""


def changed_components(controller: ControllerPlugin, name: str, value: float) -> Changed:
    """Return what one value of a parameter changes while a session runs, the nearest one that its limits allow.

    Raises:
        UsageError: The controller has no such parameter, or the value is not a number.
    """
    known = {each.name: each for each in controller.parameters}
    if name not in known:
        raise UsageError(f'the controller "{controller.name}" has no parameter "{name}"', nearest(name, known))
    if not math.isfinite(value):
        raise UsageError(f'parameter "{name}" must be finite, not {value}')
    parameter, first = known[name], places_of(controller.parameters)[list(known).index(name)]
    allowed = min(parameter.most, max(parameter.least, value))
    remark = "" if allowed == value else f"{name} is limited to {allowed:g} {parameter.unit}".rstrip()
    return Changed(range(first, first + parameter.size), allowed, remark)


def _components(controller: str, parameter: ControllerParameter, value: float | Sequence[float]) -> Vec:
    """Return the components of one parameter, continued with the last number."""
    given = np.atleast_1d(np.asarray(value, np.float64))
    where = f'parameter "{parameter.name}" of the controller "{controller}"'
    if not 0 < given.size <= parameter.size:
        raise UsageError(f"{where} takes {counted(parameter.size, 'numbers')}, not {given.size}")
    if not np.all((given >= parameter.least) & (given <= parameter.most)):
        span = f"within {parameter.least:g} and {parameter.most:g} {parameter.unit}".rstrip()
        raise UsageError(f"{where} = {value} is refused", f"choose a value {span}")
    return np.concatenate([given, np.full(parameter.size - given.size, given[-1])])
