"""Limits of a scene under the operator's ceiling of this machine.

The ceiling is applied once, before the first parameter block is sent: no scene, task, policy or plug-in raises it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from mimics_app.app.touch.ceilings import CEILINGS, asked_of, notes_on
from mimics_app.rendering.haptic.scene_block import apply_safety, safety_of
from mimics_app.world.components.robot import Safety

__all__ = ["Held", "hold_limits"]

_OF_BLOCK = ("max_velocity", "max_acceleration")
"""Those of `admittance`."""


@dataclass(frozen=True, slots=True)
class Held:
    """Limits of a scene on this machine.

    Attributes:
        values: Fields of SCENE that the ceiling changes.
        names: Limits that the ceiling changes, by their name in a scene.
        notes: One line for each limit beyond its usual value.
    """

    values: Mapping[str, object]
    names: frozenset[str]
    notes: tuple[str, ...]


def hold_limits(block: NDArray[Any], ceiling: Mapping[str, float]) -> Held:
    """Return what the ceiling makes of the limits of a scene.

    Args:
        block: SCENE record as the scene asks for it, shape [1].
        ceiling: Value of each limit, see `read_ceiling`.
    """
    asked = asked_of(safety_of(block)) | {name: float(block[0][name]) for name in _OF_BLOCK}
    held = {name: CEILINGS[name].held(asked[name], ceiling[name]) for name in CEILINGS}
    changed = block.copy()
    apply_safety(changed, _safety_with(held))
    for name in _OF_BLOCK:
        changed[0][name] = held[name]
    beyond = frozenset(name for name in CEILINGS if held[name] != asked[name])
    values = {name: changed[0][name] for name in block.dtype.names or () if (changed[0][name] != block[0][name]).any()}
    return Held(values if beyond else {}, beyond, tuple(notes_on(asked, held)))


def _safety_with(values: Mapping[str, float]) -> Safety:
    """Return a component from numbers."""
    own: dict[str, Any] = {name: values[name] for name in Safety.__struct_fields__}
    own["passivity"] = own["passivity"] > 0.0
    own["stiffness_cap"] = "cap" if own["stiffness_cap"] > 0.0 else "warn"
    own["missed_stop"] = int(own["missed_stop"])
    return Safety(**own)
