"""Where a scene file is: the file itself, or the installation's one of that name. It imports no stage.

A command asks here before it imports compiled code and graphics: a name that leads nowhere is refused at once.
"""

from __future__ import annotations

import os
from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.resources import root

__all__ = ["find_scene"]


def find_scene(path: Path) -> Path:
    """The scene file itself, or the installation's one of that name (scenes/wavy_tunnel.json, wavy_tunnel).

    Raises:
        SceneError: neither is there, or what is there is no file that could be read.
    """
    if os.path.isfile(path):  # False, too, where no file could have this name
        return path
    shipped = root() / "scenes" / f"{path.stem}.json"
    if os.path.isfile(shipped) and path.parent.name in ("", "scenes"):
        return shipped
    if os.path.exists(path):
        what = "is a folder" if os.path.isdir(path) else "is not a regular file"
        raise SceneError(Issue(str(path), "", what, "name a scene file"))
    raise SceneError(Issue(str(path), "", "there is no such scene", f"shipped: {', '.join(_shipped())}"))


def _shipped() -> list[str]:
    return sorted(f"scenes/{file.name}" for file in (root() / "scenes").glob("*.json"))
