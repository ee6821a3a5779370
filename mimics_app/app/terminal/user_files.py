"""Small files that a person's account keeps from one start to the next, in the system's place for them."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path

__all__ = ["config_folder", "read_config", "write_config"]


def config_folder() -> Path:
    """The folder of this program's settings; it may not be there yet."""
    if sys.platform == "win32":
        return Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming") / "mimics"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "mimics"
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "mimics"


def read_config(name: str) -> dict[str, object]:
    """What a file holds; {} where there is none, or none that can be read: it is nothing but a convenience."""
    try:
        content = json.loads((config_folder() / f"{name}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RuntimeError):  # the last: nested too deeply, or an account without a home
        return {}
    return content if isinstance(content, dict) else {}


def write_config(name: str, content: Mapping[str, object]) -> None:
    """Keep it; a folder that cannot be written keeps nothing."""
    try:
        folder = config_folder()
        folder.mkdir(parents=True, exist_ok=True)
        part = folder / f".{name}.part"
        part.write_text(json.dumps(content, indent=1), encoding="utf-8")
        part.replace(folder / f"{name}.json")
    except (OSError, RuntimeError):
        return
