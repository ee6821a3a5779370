"""Checks of haptic objects, walls, effects and wires beyond their types: sizes, references, physical plausibility."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.components import haptic_effects as effects
from mimics_app.world.components.block_signals import SignalFault, parse_source, parse_target
from mimics_app.world.components.curves import check_curve
from mimics_app.world.components.haptic_shapes import (
    BoxSolid,
    CylinderSolid,
    MeshSolid,
    Solid,
    TouchSurface,
    surface_of,
)
from mimics_app.world.components.objects import (
    SIDES,
    Connections,
    ForceField,
    HapticEffect,
    HapticObject,
    HapticPath,
    HapticWalls,
    InteractionPoints,
)
from mimics_app.world.components.registry import register_check
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.files.scene.object_bodies import ObjectFault, mass_properties_of, shapes_of
from mimics_app.world.files.scene.placing import pose_of, stands_somewhere

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_path"]

_MIN_WIDTH = 1e-4
"""Minimum width of a shape that can be touched [m]."""

Layer = tuple[TouchSurface, str]
"""Surface properties, and the pointer of the struct that gives them."""

_MAX_GAIN = 1e6
_MAX_DISTANCE = 1e3
"""Maximum distance of an object from the world's origin [m]."""


def _check_object(spec: HapticObject, pointer: str, scene: Scene) -> list[Issue]:
    issues = _check_place(pointer, scene)
    if spec.mass is not None and spec.density is not None:
        issues.append(scene.issue(f"{pointer}/density", "both mass and density are given", "leave one of the two out"))
    if spec.enable_translation is False and any(spec.initial_velocity):
        issues.append(
            scene.issue(
                f"{pointer}/initial_velocity", "its translation is disabled", "enable_translation, or leave out"
            )
        )
    if spec.enable_rotation is False and any(spec.initial_angular_velocity):
        where = f"{pointer}/initial_angular_velocity"
        issues.append(scene.issue(where, "its rotation is disabled", "enable_rotation, or leave it out"))
    if spec.inertia is not None and 2.0 * max(spec.inertia) > sum(spec.inertia) * (1.0 + 1e-9):
        what = "no body has this inertia: one axis is above the sum of the other two"
        issues.append(scene.issue(f"{pointer}/inertia", what))
    if spec.crush_force > 0.0 and not spec.grip:
        issues.append(scene.issue(f"{pointer}/crush_force", "the object cannot be gripped", 'set "grip": true'))
    for i, shape in enumerate(spec.shapes):
        issues += _check_shape(shape, f"{pointer}/shapes/{i}", scene)
    own: Layer = (spec, pointer)
    special: list[Layer] = [(shape, f"{pointer}/shapes/{i}") for i, shape in enumerate(spec.shapes)]
    issues += _check_surfaces([[layer, own] for layer in special] or [[own]], scene)
    return issues or _check_body(spec, pointer, scene)


def _check_place(pointer: str, scene: Scene) -> list[Issue]:
    """Faults of an entity's pose; a missing one is reported with its transform or parent."""
    name = scene.owner(pointer).id
    if not stands_somewhere(scene, name):
        return []
    try:
        place, _ = pose_of(scene, name)
    except SceneError as error:
        return error.issues
    if np.abs(place).max() > _MAX_DISTANCE:
        return [scene.issue(f"{scene.entity(name).pointer}/transform/translation", "is more than 1 km from the origin")]
    return []


def _check_body(spec: HapticObject, pointer: str, scene: Scene) -> list[Issue]:
    """Faults of the object as a whole: its shapes and mass."""
    try:
        shapes = shapes_of(scene, scene.owner(pointer).id, spec)
        smallest = min(map(_width, shapes))
        if smallest < _MIN_WIDTH:
            return [scene.issue(pointer, _too_thin(smallest))]
        mass_properties_of(scene, spec, shapes)
    except ObjectFault as fault:
        return [scene.issue(f"{pointer}{fault.place}", fault.what, fault.fix)]
    return []


def _check_shape(shape: Solid, pointer: str, scene: Scene) -> list[Issue]:
    issues = scene.check_rotation(f"{pointer}/rotation", shape.rotation)
    if isinstance(shape, MeshSolid):
        issues += scene.check_model_reference(f"{pointer}/source", shape.source)
    smallest = _width(shape)
    if smallest < _MIN_WIDTH:
        issues.append(scene.issue(pointer, _too_thin(smallest)))
    if isinstance(shape, BoxSolid | CylinderSolid) and shape.rounding >= 0.5 * smallest:
        what = f"{shape.rounding:g} m leaves nothing of an edge of {smallest:g} m"
        issues.append(scene.issue(f"{pointer}/rounding", what, f"stay below {0.5 * smallest:g} m"))
    return issues


def _too_thin(smallest: float) -> str:
    return f"the shape is {smallest:g} m thin: a device passes through it within a tick"


def _width(shape: Solid) -> float:
    """Return the smallest width of a shape [m]; inf for a mesh."""
    if isinstance(shape, BoxSolid):
        return min(shape.size)
    if isinstance(shape, CylinderSolid):
        return min(2.0 * shape.radius, shape.length)
    return math.inf if isinstance(shape, MeshSolid) else 2.0 * shape.radius


def _check_surfaces(surfaces: Sequence[Sequence[Layer]], scene: Scene) -> list[Issue]:
    """Faults of surfaces, each given as layers, most specific first; equal faults are reported once."""
    issues: list[Issue] = []
    for layers in surfaces:
        issues += [issue for issue in _check_surface(layers, scene) if issue not in issues]
    return issues


def _check_surface(layers: Sequence[Layer], scene: Scene) -> list[Issue]:
    surface = surface_of(*(layer for layer, _ in layers))
    issues = []

    def report(field: str, what: str, fix: str = "") -> None:
        place = next(pointer for layer, pointer in layers if getattr(layer, field) is not None)
        issues.append(scene.issue(f"{place}/{field}", what, fix))

    static, dynamic = surface.friction_static or 0.0, surface.friction_dynamic or 0.0
    if static < dynamic:
        what = f"{static:g} is below friction_dynamic, {dynamic:g}: it would slide more easily at rest"
        report("friction_static", what)
    height, length = surface.texture_height or 0.0, surface.texture_length or 0.0
    if length < math.pi * height:
        what = f"ripples {height:g} m high and {length:g} m long are steeper than 45 degrees"
        report("texture_height", what, f"stay below texture_length / pi = {length / math.pi:.3g} m")
    return issues


def _check_walls(walls: HapticWalls, pointer: str, scene: Scene) -> list[Issue]:
    issues = _check_place(pointer, scene)
    sides = [(getattr(walls, side), f"{pointer}/{side}") for side in SIDES]
    issues += _check_surfaces([[side, (walls, pointer)] for side in sides], scene)
    for side in SIDES:
        wall = getattr(walls, side)
        issues += scene.check_rotation(f"{pointer}/{side}/rotation", wall.rotation)
        if wall.enabled and walls.size is None and wall.position is None:
            what = f'the wall "{side}" has no place'
            issues.append(scene.issue(pointer, what, f'give the walls a "size", {side} a position, or disable it'))
    return issues


def _check_effect(effect: HapticEffect, pointer: str, scene: Scene) -> list[Issue]:
    act, place = effect.effect, f"{pointer}/effect"
    issues = _check_acting(effect, pointer, scene)
    if isinstance(act, effects.PathSpring | effects.Guidance):
        paths = [entity for entity, _, _ in [*scene.components(HapticPath), *scene.components(Tunnel)]]
        if act.path not in paths:
            issues += scene.check_entity_with(HapticPath, f"{place}/path", act.path)
        if effect.object is not None and effect.acts_on == "user":
            issues.append(
                scene.issue(f"{pointer}/object", "a path is fixed to the world", 'leave it out, or "acts_on": "object"')
            )
    if isinstance(act, effects.ConstantForce) and not any(act.force):
        issues.append(scene.issue(f"{place}/force", "the force is zero", "disable the effect instead"))
    if isinstance(act, effects.Vibration) and not any(act.direction):
        issues.append(scene.issue(f"{place}/direction", "is zero", "give a vector of any other length"))
    if isinstance(act, effects.Workspace) and (act.radius is None) == (act.size is None):
        issues.append(scene.issue(place, "needs either a radius or a size", "give exactly one of the two"))
    return issues


def _check_acting(acting: HapticEffect | ForceField, pointer: str, scene: Scene) -> list[Issue]:
    if acting.object is not None:
        return scene.check_entity_with(HapticObject, f"{pointer}/object", acting.object)
    if acting.acts_on == "object":
        return [scene.issue(f"{pointer}/acts_on", "no object is named", 'give an "object"')]
    return []


def check_path(path: HapticPath, pointer: str, scene: Scene) -> list[Issue]:
    """Faults of the component itself; the haptic stage checks that a curve fits its points."""
    material = scene.check_material(f"{pointer}/material", path.material)
    return check_curve(path, pointer, scene) + material


def _check_points(points: InteractionPoints, pointer: str, scene: Scene) -> list[Issue]:
    shown = {f"{pointer}/points/{i}/entity": point.entity for i, point in enumerate(points.points)}
    return scene.check_names(shown, "no entity", scene.by_id)


def _check_connections(connections: Connections, pointer: str, scene: Scene) -> list[Issue]:
    objects = [*(entity for entity, _, _ in scene.components(HapticObject)), *scene.broken]
    kinds = (HapticEffect, ForceField)
    acting = [*(entity for kind in kinds for entity, _, _ in scene.components(kind)), *scene.broken]
    issues = []
    for i, wire in enumerate(connections.wires):
        if np.abs(wire.gain).max() > _MAX_GAIN:
            issues.append(scene.issue(f"{pointer}/wires/{i}/gain", f"is beyond {_MAX_GAIN:g}"))
        ends: list[tuple[str, Callable[[], object]]] = [
            ("from", lambda text=wire.source: parse_source(text, objects)),  # type: ignore[misc]
            ("to", lambda text=wire.target: parse_target(text, objects, acting)),  # type: ignore[misc]
        ]
        for name, parse in ends:
            try:
                parse()
            except SignalFault as fault:
                issues.append(scene.issue(f"{pointer}/wires/{i}/{name}", fault.what, fault.fix))
    return issues


register_check("haptic_object", _check_object)
register_check("haptic_walls", _check_walls)
register_check("haptic_effect", _check_effect)
register_check("force_field", _check_acting)
register_check("haptic_path", check_path)
register_check("interaction_points", _check_points)
register_check("connections", _check_connections)
