"""Force fields by name: built-in ones, those a scenario brings, and plug-ins of the group mimics_app.force_fields.

A field is a compiled function of the signature `contracts.loop_ports.FIELD`; here are the ones of motor-learning
studies. Each says what its parameters are.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import Issue, nearest
from mimics_app.contracts.kernel import typed_kernel
from mimics_app.contracts.loop_ports import FIELD, FIELD_PARAMETERS
from mimics_app.rendering.haptic.cord_field import cord
from mimics_app.world.components.objects import ForceField
from mimics_app.world.components.registry import register_check
from mimics_app.world.scene.scene import Scene

__all__ = ["ENTRY_POINT_GROUP", "Field", "add_field", "check_field", "curl", "field_names", "find_field"]
__all__ += ["saddle", "well"]

Vec = NDArray[np.float64]
Field = Callable[[Vec, Vec, Vec, float, Vec], None]

ENTRY_POINT_GROUP = "mimics_app.force_fields"


@typed_kernel(FIELD)
def curl(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """Force across the velocity, as of a spinning wheel: F = c a x v (Shadmehr & Mussa-Ivaldi 1994). No power.

    Parameters: c [N s/m], then the axis a (0 0 0: world z, out of the frontal plane).
    """
    c = parameters[0]
    ax, ay, az = parameters[1], parameters[2], parameters[3]
    length = np.sqrt(ax * ax + ay * ay + az * az)
    if length == 0.0:
        az = 1.0
        length = 1.0
    c /= length
    out[0] = c * (ay * v[2] - az * v[1])
    out[1] = c * (az * v[0] - ax * v[2])
    out[2] = c * (ax * v[1] - ay * v[0])


@typed_kernel(FIELD)
def saddle(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """Linear in the place, of another stiffness along each axis: F = K p (Burdet et al. 2001: divergent where K > 0).

    Parameters: K along world x, y, z [N/m].
    """
    for i in range(3):
        out[i] = parameters[i] * p[i]


@typed_kernel(FIELD)
def well(parameters: Vec, p: Vec, v: Vec, t: float, out: Vec) -> None:
    """A smooth well: F = -(f r/w) exp((1 - r^2/w^2) / 2), greatest force f at distance w, none far away.

    Parameters: f [N], w [m]; w 0: none.
    """
    f, w = parameters[0], parameters[1]
    share = 0.0
    if w > 0.0:
        square = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / (w * w)
        share = -f / w * np.exp(0.5 * (1.0 - square))
    for i in range(3):
        out[i] = share * p[i]


_FIELDS: dict[str, Any] = {"cord": cord, "curl": curl, "saddle": saddle, "well": well}


def add_field(name: str, field: Any) -> None:
    """Let scenes use a field of a scenario: a function compiled with `typed_kernel(FIELD)`.

    Raises:
        ValueError: another one has that name.
    """
    if _FIELDS.setdefault(name, field) is not field:
        raise ValueError(f'force field "{name}" is there twice')


def field_names() -> list[str]:
    """Names of all fields that can be asked for."""
    return sorted({*_FIELDS, *(point.name for point in entry_points(group=ENTRY_POINT_GROUP))})


def find_field(name: str) -> Any:
    """The compiled function of that name.

    Raises:
        KeyError: there is none; the message names the nearest.
        ValueError: its plug-in cannot be imported, it is no compiled field, or a trial call raised.
    """
    if name not in _FIELDS:
        points = {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
        if name not in points:
            raise KeyError(f'no force field "{name}"; {nearest(name, field_names())}')
        _FIELDS[name] = _tried(_loaded(points[name]))
    return _FIELDS[name]


def check_field(field: ForceField, pointer: str, scene: Scene) -> list[Issue]:
    """Faults of the function a scene names: find it, compile it, and call it once."""
    try:
        find_field(field.function)
    except (KeyError, ValueError) as error:
        what, _, fix = str(error.args[0]).partition("; ")
        return [scene.issue(f"{pointer}/function", what, fix)]
    return []


def _loaded(point: Any) -> Any:
    try:
        return point.load()
    except Exception as error:
        raise ValueError(f'the plug-in of "{point.name}" cannot be loaded: {type(error).__name__}: {error}') from error


def _tried(field: Any) -> Any:
    """A field that has the signature and does not raise where nothing is special."""
    compiled = getattr(field, "nopython_signatures", [])
    if FIELD not in compiled:
        raise ValueError("it is not compiled for the loop; decorate it with typed_kernel(FIELD)")
    try:
        field(np.zeros(FIELD_PARAMETERS), np.full(3, 0.01), np.full(3, 0.1), 0.0, np.zeros(3))
    except Exception as error:  # noqa: BLE001  anything it raises would end the loop
        raise ValueError(
            f"it raises {type(error).__name__}, which would end the loop; return a force instead"
        ) from None
    return field


register_check("force_field", check_field)
