"""The tunnel of a scene: built from its component, and refused at load where it cannot be travelled."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.haptic import Projection
from mimics_app.contracts.regular_file import read_regular
from mimics_app.rendering.haptic.tunnel import TunnelCurve
from mimics_app.rendering.haptic.tunnel_source import tunnel_from_component
from mimics_app.world.components.registry import register_check
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.components.robot_checks import check_tunnel_component
from mimics_app.world.scene.scene import Scene

__all__ = ["PROJECTIONS", "built_tunnel", "check_tunnel", "tunnel_of_scene"]

PROJECTIONS: Mapping[str, Projection] = {
    "newton warm": Projection.NEWTON_WARM,
    "newton one step": Projection.NEWTON_ONE_STEP,
    "golden section": Projection.GOLDEN_SECTION,
    "brute force": Projection.BRUTE_FORCE,
}
"""What runs, by the word of `systems.haptic.projection`."""


def tunnel_of_scene(scene: Scene) -> tuple[TunnelCurve, float | None]:
    """The curve of the scene's tunnel, and the residual of the recorded path it was fitted to [m] or None.

    Raises:
        SceneError: the scene has no tunnel, or one that cannot be built.
    """
    _, tunnel, pointer = scene.one(Tunnel)
    return built_tunnel(tunnel, pointer, scene)


def built_tunnel(tunnel: Tunnel, pointer: str, scene: Scene) -> tuple[TunnelCurve, float | None]:
    """The curve of one tunnel, built once for a scene, and the residual of the recorded path [m] or None.

    Raises:
        SceneError: it cannot be built.
    """
    folder = scene.origins.locate(pointer).folder
    fitted = None if tunnel.path_file is None else _content(folder / tunnel.path_file)
    source = (tunnel.control_points, fitted, tunnel.basis_functions, tunnel.radius, tunnel.radius_scale)
    key = ("tunnel", scene.owner(pointer).id, pointer.rpartition("/")[2])
    return scene.derive(key, lambda: tunnel_from_component(tunnel, folder, str(scene.path), pointer), source)


def _content(file: Path) -> bytes:
    """What a recorded path says; nothing where it cannot be read, which is told where it is fitted."""
    try:
        return read_regular(file)
    except OSError:
        return b""


def check_tunnel(tunnel: Tunnel, pointer: str, scene: Scene) -> list[Issue]:
    """Faults of a tunnel: build it and see (hairpins, coincident points, a path file that cannot be fitted).

    One whose component is wrong already is not built: its faults were told.
    """
    if check_tunnel_component(tunnel, pointer, scene):
        return []
    try:
        built_tunnel(tunnel, pointer, scene)
    except SceneError as error:
        return [_placed(issue, scene) for issue in error.issues]
    return []


def _placed(issue: Issue, scene: Scene) -> Issue:
    """An issue of the component where it was written; one of a path file as it is."""
    return scene.issue(issue.pointer, issue.what, issue.fix) if issue.file == str(scene.path) else issue


register_check("tunnel", check_tunnel)
