"""Settings files of a user, kept from one start to the next in the system's folder for them."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system.alone import alone_in
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.run_folder import write_atomically

__all__ = ["LAUNCHER", "change_config", "config_file", "config_folder", "read_config", "read_strictly", "write_config"]

LAUNCHER = "launcher"
"""Name of the file with the last choice in the launcher."""

_MOST_BYTES = 1 << 20


def config_folder() -> Path:
    """Return the folder of this program's settings; it may not exist yet."""
    if sys.platform == "win32":
        return Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming") / "mimics"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "mimics"
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "mimics"


def read_config(name: str) -> dict[str, object]:
    """Return the contents of a file; {} where it is missing or cannot be read."""
    try:
        content = json.loads(read_regular(config_folder() / f"{name}.json", _MOST_BYTES))
    except (OSError, ValueError, RuntimeError):  # RuntimeError: nested too deeply, or an account without a home folder
        return {}
    return content if isinstance(content, dict) else {}


def config_file(name: str) -> Path:
    """Return the path of a settings file; it may not exist."""
    return config_folder() / f"{name}.json"


def read_strictly(name: str) -> dict[str, object]:
    """Return the contents of a file that must not be ignored where it is damaged; {} where it is missing.

    Raises:
        UsageError: It exists and cannot be read, or holds no JSON object.
    """
    try:
        file = config_file(name)
        content = json.loads(read_regular(file, _MOST_BYTES)) if file.exists() else {}
    except RuntimeError:  # an account without a home folder
        return {}
    except (OSError, ValueError) as error:
        raise UsageError(f"{file}: cannot be read: {error}", "correct it or remove it") from error
    if not isinstance(content, dict):
        raise UsageError(f"{file}: holds no object", "correct it or remove it")
    return content


def write_config(name: str, content: Mapping[str, object]) -> None:
    """Write the contents of a file; nothing happens where the folder cannot be written."""
    _write(name, lambda: content)


def change_config(name: str, change: Callable[[Mapping[str, object]], Mapping[str, object]]) -> None:
    """Replace the contents of a file by what a function returns for them, while no other process writes it.

    Raises:
        UsageError: See `read_strictly`.
    """
    _write(name, lambda: change(read_strictly(name)))


def _write(name: str, content: Callable[[], Mapping[str, object]]) -> None:
    try:
        folder = config_folder()
        folder.mkdir(parents=True, exist_ok=True)
        with alone_in(folder):
            write_atomically(folder / f"{name}.json", json.dumps(content(), indent=1).encode())
    except (OSError, RuntimeError):
        return
