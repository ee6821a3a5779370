"""Search for a scene file by path or by the name of a shipped scene.

It imports no stage: commands search before they import compiled code and graphics, so that a wrong name fails at once.
"""

from __future__ import annotations

import os
from difflib import get_close_matches
from pathlib import Path

from mimics_app.app.scenes.shipped import find_shipped, shipped_scenes
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.resources import root

__all__ = ["find_file", "find_scene"]


def find_scene(path: Path) -> Path:
    """Return the path itself, or the shipped scene that it names (scenes/wavy_tunnel.json, free_objects).

    Raises:
        SceneError: Neither exists, or the path is no regular file.
    """
    if os.path.isfile(path):  # False, without an error, for names that no file can have
        return path
    shipped = _shipped(path)
    if shipped is not None:
        return shipped
    if os.path.exists(path):
        what = "is a folder" if os.path.isdir(path) else "is not a regular file"
        raise SceneError(Issue(str(path), "", what, "name a scene file"))
    names = [scene.name for scene in shipped_scenes()]
    close = get_close_matches(path.stem, names, n=1)
    hint = f'did you mean "{close[0]}"? ' if close else ""
    raise SceneError(Issue(str(path), "", "scene not found", f"{hint}mimics scenes lists those that are shipped"))


def find_file(path: Path) -> Path:
    """Return the path itself, or what it names of the installation, such as assets/models/market/apple.glb.

    The path is returned where there is neither.
    """
    own = root() / path
    shipped = not os.path.exists(path) and not path.is_absolute() and path.parts[:1] == ("assets",)
    return own if shipped and os.path.exists(own) else path


def _shipped(path: Path) -> Path | None:
    """Return the shipped scene named by `path`, or by its place below `scenes`; None where there is none."""
    scene = find_shipped(path.stem) if path.suffix in ("", ".json") else None
    if scene is None:
        return None
    below = scene.file.parent.relative_to(root()).parts
    asked = path.parent.parts
    return scene.file if asked == below[len(below) - len(asked) :] else None
