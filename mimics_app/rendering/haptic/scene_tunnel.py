"""Rows of a scene's tunnels for the loop, with their checks at load."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mimics_app.contracts.arrays import Records
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.loop.haptic_objects import TUNNEL, Projection
from mimics_app.contracts.system.regular_file import read_or_nothing
from mimics_app.rendering.haptic.devices.scene_contacts import contact_number
from mimics_app.rendering.haptic.tunnel_geometry import TunnelCurve
from mimics_app.rendering.haptic.tunnel_source import tunnel_from_component
from mimics_app.world.components.registry import register_check
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.components.systems import HapticSettings
from mimics_app.world.files.scene.robot_checks import check_tunnel_component
from mimics_app.world.files.scene.scene import Scene

__all__ = ["PROJECTIONS", "built_tunnel", "planned_projection", "tunnel_of_scene", "tunnel_rows"]


PROJECTIONS: Mapping[str, Projection] = {each.name.lower().replace("_", " "): each for each in Projection}
"""Projection methods by the value of `systems.haptic.projection`."""


_FORCES = ("radius_scale", "stiffness", "damping", "drag", "drag_growth", "centring", "advance")
"""Fields with the same name in the component and in the row."""


def tunnel_of_scene(scene: Scene, entity: str | None = None) -> tuple[TunnelCurve, float | None]:
    """Return the curve of a tunnel and its residual from the recorded path [m], None without a fit.

    Args:
        scene: A scene with tunnels.
        entity: Entity of the tunnel; None, or an entity without a tunnel: the first one.

    Raises:
        SceneError: The scene has no tunnel, or the tunnel cannot be built.
    """
    _, tunnel, pointer = next((one for one in scene.components(Tunnel) if one[0] == entity), scene.one(Tunnel))
    return built_tunnel(tunnel, pointer, scene)


def tunnel_rows(scene: Scene) -> tuple[Records, tuple[str, ...]]:
    """Return the TUNNEL records of the scene's tunnels, shape [n], and the entity of each.

    Raises:
        SceneError: A tunnel cannot be built.
    """
    found = scene.components(Tunnel)
    rows = np.zeros(len(found), TUNNEL)
    for row, (_, tunnel, pointer) in zip(rows, found, strict=True):
        built_tunnel(tunnel, pointer, scene)[0].fill(row)
        for name in _FORCES:
            row[name] = getattr(tunnel, name)
        row["frenet"] = int(tunnel.frame == "frenet")
        row["contact"] = contact_number(scene, tunnel.contact)
        row["projection"] = PROJECTIONS[planned_projection(scene)]
    return rows, tuple(entity for entity, _, _ in found)


def planned_projection(scene: Scene) -> str:
    """Return the projection of the scene, else the planned one; unplanned, Newton's method with a warm start."""
    settings = scene.system(HapticSettings)
    if settings is not None and settings.projection != "auto":
        return settings.projection
    return str(scene.methods.get("tunnel projection", {}).get("projection", "newton warm"))


def built_tunnel(tunnel: Tunnel, pointer: str, scene: Scene) -> tuple[TunnelCurve, float | None]:
    """Return the curve of one tunnel, cached per scene, and its residual from the recorded path [m] or None.

    Raises:
        SceneError: The tunnel cannot be built.
    """
    folder = scene.origins.locate(pointer).folder
    # An unreadable path file is reported by the fit.
    fitted = None if tunnel.path_file is None else read_or_nothing(folder / tunnel.path_file)
    source = (tunnel.control_points, fitted, tunnel.basis_functions, tunnel.radius, tunnel.radius_scale)
    key = ("tunnel", scene.owner(pointer).id, pointer.rpartition("/")[2])
    return scene.derive(key, lambda: tunnel_from_component(tunnel, folder, str(scene.path), pointer), source)


def _check_tunnel(tunnel: Tunnel, pointer: str, scene: Scene) -> list[Issue]:
    """Return the faults of building a tunnel (hairpins, coincident points, a path file that cannot be fitted).

    A component with faults of its own, reported elsewhere, is not built.
    """
    if check_tunnel_component(tunnel, pointer, scene):
        return []
    try:
        built_tunnel(tunnel, pointer, scene)
    except SceneError as error:
        return [_placed(issue, scene) for issue in error.issues]
    return []


def _placed(issue: Issue, scene: Scene) -> Issue:
    """Return an issue of the component with its place in the source; one of a path file unchanged."""
    return scene.issue(issue.pointer, issue.what, issue.fix) if issue.file == str(scene.path) else issue


register_check("tunnel", _check_tunnel)
