"""What the haptic stage checks of a scene beyond types: the tunnel must be one that can be travelled."""

from __future__ import annotations

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.rendering.haptic.tunnel_source import tunnel_from_component
from mimics_app.world.components_haptic import Tunnel
from mimics_app.world.registry import register_check
from mimics_app.world.scene import Scene

__all__ = ["check_tunnel"]


def check_tunnel(tunnel: Tunnel, pointer: str, scene: Scene) -> list[Issue]:
    """Faults of a tunnel: build it and see (hairpins, coincident points, a path file that cannot be fitted)."""
    try:
        tunnel_from_component(tunnel, scene.root, scene.file, pointer)
    except SceneError as error:
        return [_placed(issue, pointer, scene) for issue in error.issues]
    return []


def _placed(issue: Issue, pointer: str, scene: Scene) -> Issue:
    """An issue of the component at its place in the files the scene was read from; one of a path file as it is."""
    if issue.file == scene.file and issue.pointer.startswith(pointer):
        return scene.issue(issue.pointer, issue.what, issue.fix)
    return issue


register_check("tunnel", check_tunnel)
