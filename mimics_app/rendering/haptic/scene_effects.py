"""Rows of a scene's effects and force fields, with their paths and field names."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.loop.haptic_objects import EFFECT, STATIC, TUNNEL, EffectKind
from mimics_app.contracts.loop.loop_ports import MAX_FIELDS
from mimics_app.rendering.haptic.devices.scene_contacts import contact_number
from mimics_app.rendering.haptic.scene_tunnel import built_tunnel
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve
from mimics_app.world.components import haptic_effects as effects
from mimics_app.world.components.objects import ForceField, HapticEffect, HapticPath
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.files.scene.object_bodies import rotation_of
from mimics_app.world.files.scene.object_checks import check_path
from mimics_app.world.files.scene.placing import pose_of
from mimics_app.world.files.scene.scene import Scene

__all__ = ["EffectRows", "check_field_count", "check_haptic_path", "curve_of_path"]


_KINDS = {
    effects.Spring: EffectKind.SPRING,
    effects.PathSpring: EffectKind.PATH_SPRING,
    effects.Viscosity: EffectKind.VISCOSITY,
    effects.ConstantForce: EffectKind.CONSTANT,
    effects.Magnet: EffectKind.MAGNET,
    effects.Vibration: EffectKind.VIBRATION,
    effects.StickSlip: EffectKind.STICK_SLIP,
    effects.Workspace: EffectKind.WORKSPACE,
    effects.Guidance: EffectKind.GUIDANCE,
}
_SAME_NAME = ("stiffness", "damping", "frequency", "slip")
_OTHER_NAME = {
    "within": "radius",
    "radius": "radius",
    "largest_force": "force",
    "amplitude": "force",
    "dead_band": "slip",
}
"""Row field of each component field with another name; `force` of some kinds is set in `_effect_row`."""


class EffectRows:
    """Rows of the effects and force fields of a scene.

    Args:
        scene: A checked scene.
        bodies: Entity of each row of bodies.

    Attributes:
        rows: EFFECT records, shape [1] each.
        entities: Entity of each row.
        paths: TUNNEL records, shape [1] each, by EFFECT.path.
        fields: Names of force fields by EFFECT.field.

    Raises:
        SceneError: A path cannot be built.
    """

    def __init__(self, scene: Scene, bodies: Sequence[str]) -> None:
        self._scene = scene
        self._bodies = bodies
        self._path_names: list[str] = []
        self.rows: list[Records] = []
        self.entities: list[str] = []
        self.paths: list[Records] = []
        self.fields: list[str] = []
        for entity, effect, _ in scene.components(HapticEffect):
            self._add(entity, effect, self._effect_row(effect.effect))
        for entity, field, _ in scene.components(ForceField):
            self._add(entity, field, self._field_row(field))

    def _add(self, entity: str, acting: HapticEffect | ForceField, row: Records) -> None:
        row["enabled"] = acting.enabled
        row["body"] = STATIC if acting.object is None else self._bodies.index(acting.object)
        row["on_body"] = acting.acts_on == "object"
        row["contact"] = contact_number(self._scene, acting.contact)
        place, _ = pose_of(self._scene, entity)
        if acting.object is not None and acting.acts_on == "user":
            origin, turn = pose_of(self._scene, acting.object)
            place = rotation_of(tuple(turn)).T @ (place - origin)
        row["position"] = place
        self.rows.append(row)
        self.entities.append(entity)

    def _effect_row(self, effect: effects.Effect) -> Records:
        row = np.zeros(1, EFFECT)
        row["kind"] = _KINDS[type(effect)]
        for name in effect.__struct_fields__:
            value = getattr(effect, name)
            if name in _SAME_NAME:
                row[name] = value
            elif name in _OTHER_NAME and value is not None:
                row[_OTHER_NAME[name]] = value
        match effect:
            case effects.ConstantForce():
                row["force"] = np.linalg.norm(effect.force)
                row["direction"] = np.array(effect.force) / np.linalg.norm(effect.force)
            case effects.Vibration():
                row["direction"] = np.array(effect.direction) / np.linalg.norm(effect.direction)
            case effects.Magnet() | effects.Guidance():
                row["force"] = effect.force
            case effects.Workspace(size=size) if size is not None:
                row["direction"] = 0.5 * np.array(size)
        row["path"] = self._path(effect.path) if isinstance(effect, effects.PathSpring | effects.Guidance) else -1
        return row

    def _field_row(self, field: ForceField) -> Records:
        row = np.zeros(1, EFFECT)
        if field.function not in self.fields:
            self.fields.append(field.function)
        row["kind"], row["path"], row["field"] = EffectKind.FIELD, -1, self.fields.index(field.function)
        row["parameters"][0, : len(field.parameters)] = field.parameters
        row["radius"], row["force"] = field.within, field.largest_force
        return row

    def _path(self, name: str) -> int:
        """Return the row of the path of an entity, built on first use."""
        if name not in self._path_names:
            record = np.zeros(1, TUNNEL)
            curve_of_path(self._scene, name).fill(record[0])
            self._path_names.append(name)
            self.paths.append(record)
        return self._path_names.index(name)


def curve_of_path(scene: Scene, name: str) -> TunnelCurve:
    """Return the curve of an entity's `haptic_path`, or of its `tunnel`.

    Raises:
        SceneError: The curve cannot be built.
    """
    for entity, path, pointer in scene.components(HapticPath):
        if entity == name:
            return _curve(path, pointer, scene)
    pointer, tunnel = next((where, found) for entity, found, where in scene.components(Tunnel) if entity == name)
    return built_tunnel(tunnel, pointer, scene)[0]


def check_haptic_path(path: HapticPath, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of building a path; a component with faults of its own is not built."""
    if check_path(path, pointer, scene):
        return []
    try:
        _curve(path, pointer, scene)
    except SceneError as error:
        own = str(scene.path)
        return [scene.issue(one.pointer, one.what, one.fix) if one.file == own else one for one in error.issues]
    return []


def check_field_count(field: ForceField, pointer: str, scene: Scene) -> list[Issue]:
    """Return the fault of a force field beyond MAX_FIELDS."""
    names = list(dict.fromkeys(one.function for _, one, _ in scene.components(ForceField)))
    if len(names) <= MAX_FIELDS or field.function in names[:MAX_FIELDS]:
        return []
    what = f"force field number {names.index(field.function) + 1}; at most {MAX_FIELDS} are supported"
    return [scene.issue(f"{pointer}/function", what)]


def _curve(path: HapticPath, pointer: str, scene: Scene) -> TunnelCurve:
    """Return the bisector of a tunnel of zero radius through the same points."""
    tunnel = Tunnel(
        control_points=path.control_points,
        path_file=path.path_file,
        basis_functions=path.basis_functions,
        radius=0.0,
    )
    return built_tunnel(tunnel, pointer, scene)[0]
