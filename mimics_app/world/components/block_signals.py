"""Names of signals: the outputs and inputs of blocks that a scene may connect (D2.1 4.2.8.2)."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from mimics_app.contracts.errors import nearest
from mimics_app.contracts.loop.haptic_objects import SignalSource, SignalTarget

__all__ = ["SignalFault", "SourceName", "TargetName", "parse_source", "parse_target"]

_PLAIN = {
    "p_rob": SignalSource.POSITION_ROBOT,
    "v_rob": SignalSource.VELOCITY_ROBOT,
    "F_meas": SignalSource.FORCE_MEASURED,
    "F_rob": SignalSource.FORCE_USER,
    "grasp": SignalSource.GRASP,
    "time": SignalSource.TIME,
}
_OF_OBJECT = {
    "p_obj": SignalSource.POSITION_OBJECT,
    "v_obj": SignalSource.VELOCITY_OBJECT,
    "omega_obj": SignalSource.OMEGA_OBJECT,
    "R_obj.x": SignalSource.AXIS_X_OBJECT,
    "R_obj.y": SignalSource.AXIS_Y_OBJECT,
    "R_obj.z": SignalSource.AXIS_Z_OBJECT,
    "F_rob": SignalSource.FORCE_OBJECT,
    "touched": SignalSource.TOUCHED,
    "collided": SignalSource.COLLIDED,
}
_TO_OBJECT = {"F_aux": SignalTarget.FORCE_AUX, "T_aux": SignalTarget.TORQUE_AUX}
_TO_EFFECT = {
    "position": SignalTarget.EFFECT_POSITION,
    "force": SignalTarget.EFFECT_FORCE,
    "stiffness": SignalTarget.EFFECT_STIFFNESS,
}


class SignalFault(Exception):
    """An unknown signal name: what is wrong, and what to do."""

    def __init__(self, what: str, fix: str) -> None:
        super().__init__(what)
        self.what = what
        self.fix = fix


@dataclass(frozen=True, slots=True)
class SourceName:
    """An output; `object` is the entity it belongs to, or "" for those of robot and clock."""

    signal: SignalSource
    object: str = ""


@dataclass(frozen=True, slots=True)
class TargetName:
    """An input of an entity."""

    signal: SignalTarget
    entity: str


def parse_source(text: str, objects: Collection[str]) -> SourceName:
    """Parse the name of an output, e.g. "p_rob" or "cup.v_obj".

    Args:
        text: Name as written in the scene.
        objects: Ids of entities with a haptic object.

    Raises:
        SignalFault: there is none.
    """
    if text in _PLAIN:
        return SourceName(_PLAIN[text])
    for ending, signal in _OF_OBJECT.items():
        name = text.removesuffix(f".{ending}")
        if name != text and name in objects:
            return SourceName(signal, name)
    owner, _, ending = text.rpartition(".R_obj.") if ".R_obj." in text else text.rpartition(".")
    if owner in objects:
        raise SignalFault(f'"{owner}" has no output "{ending}"', nearest(ending, _OF_OBJECT))
    if owner:
        raise SignalFault(f'no haptic object "{owner}"', _nearest_or_none(owner, objects))
    raise SignalFault(f'no output "{text}"', nearest(text, [*_PLAIN, *(f"OBJECT.{ending}" for ending in _OF_OBJECT)]))


def parse_target(text: str, objects: Collection[str], effects: Collection[str]) -> TargetName:
    """Parse the name of an input, e.g. "cup.F_aux" or "pull.stiffness".

    Args:
        text: Name as written in the scene.
        objects: Ids of entities with a haptic object.
        effects: Ids of entities with a haptic effect or a force field.

    Raises:
        SignalFault: there is none.
    """
    owner, _, ending = text.rpartition(".")
    if owner in objects and ending in _TO_OBJECT:
        return TargetName(_TO_OBJECT[ending], owner)
    if owner in effects and ending in _TO_EFFECT:
        return TargetName(_TO_EFFECT[ending], owner)
    known = [*(_TO_OBJECT if owner in objects else ()), *(_TO_EFFECT if owner in effects else ())]
    if known:
        raise SignalFault(f'"{owner}" has no input "{ending}"', nearest(ending, known))
    if not owner:
        raise SignalFault(f'no input "{text}"', "write OBJECT.F_aux, OBJECT.T_aux, EFFECT.position, .force, .stiffness")
    raise SignalFault(f'no haptic object or effect "{owner}"', _nearest_or_none(owner, [*objects, *effects]))


def _nearest_or_none(name: str, known: Collection[str]) -> str:
    return nearest(name, known) if known else "the scene has none"
