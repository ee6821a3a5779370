"""Scenes as the application reads them: one validator with every stage's own checks, for `check` and `run` alike."""

from __future__ import annotations

from pathlib import Path

import mimics_app.rendering.haptic.scene_tunnel
import mimics_app.tasks.scene_section  # noqa: F401  both register their checks
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.resources import root
from mimics_app.world.scene import Scene
from mimics_app.world.scene_file import load_scene

__all__ = ["find_scene", "load_checked_scene"]


def load_checked_scene(path: Path) -> Scene:
    """Read a scene and everything it names.

    Raises:
        SceneError: every fault found, each with file and JSON pointer.
    """
    return load_scene(find_scene(path))


def find_scene(path: Path) -> Path:
    """The scene file itself, or the installation's one of that name (scenes/wavy_tunnel.json, wavy_tunnel).

    Raises:
        UsageError: neither is there.
    """
    if path.is_file():
        return path
    shipped = root() / "scenes" / path.with_suffix(".json").name
    if shipped.is_file() and path.parent.name in ("", "scenes"):
        return shipped
    raise UsageError(f'there is no scene "{path}"', f"shipped: {', '.join(_shipped())}")


def _shipped() -> list[str]:
    return sorted(f"scenes/{file.name}" for file in (root() / "scenes").glob("*.json"))
