"""`mimics desktop`: an entry in the desktop's menu of applications, by the Desktop Entry Specification 1.0."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import OutputError, UsageError

__all__ = ["add_arguments", "entry_of", "run"]

_ENTRY = Path("applications", "mimics.desktop")
_ICON = Path("icons", "hicolor", "256x256", "apps", "mimics.png")
_FOLDER = "~/mimics"

_ESCAPED = str.maketrans({sign: "\\" + sign for sign in '"`$\\'})
"""Inside the quotes of an argument of Exec these signs need a backslash."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = "For this user only; the entry starts the launcher by the program that wrote it."
    parser.add_argument("--remove", action="store_true", help="remove the entry and its icon")
    parser.add_argument(
        "--folder",
        type=Path,
        default=Path(_FOLDER),
        metavar="DIR",
        help=f"folder in which the launcher starts; sessions are kept in its folder runs (default {_FOLDER})",
    )


def run(args: argparse.Namespace) -> int:
    """Write the entry and the icon, or remove them.

    Raises:
        UsageError: This system's menu does not read such entries.
        OutputError: A file or a folder cannot be written or removed.
    """
    if sys.platform in ("win32", "darwin"):
        raise UsageError("desktop entries are read by Linux and BSD desktops only", 'start "mimics" from a terminal')
    entry, icon = _data_folder() / _ENTRY, _data_folder() / _ICON
    try:
        if args.remove:
            entry.unlink(missing_ok=True)
            icon.unlink(missing_ok=True)
            answer(args, {"removed": [str(entry), str(icon)]}, [f"removed {entry} and {icon}"])
            return 0
        folder = args.folder.expanduser().absolute()
        _write(entry, icon, folder)
    except (OSError, RuntimeError) as error:  # RuntimeError: an account without a home folder
        raise OutputError(f"the desktop entry cannot be changed: {error}", "check the folder's permissions") from error
    shown = {"entry": str(entry), "icon": str(icon), "folder": str(folder)}
    answer(args, shown, [f"written: {entry}", f"sessions started from the menu are kept in {folder / 'runs'}"])
    return 0


def entry_of(command: list[str], folder: Path) -> str:
    """Return the text of the entry.

    Args:
        command: Program and its arguments, unquoted.
        folder: Folder in which it starts.
    """
    started = " ".join(_quoted(word) for word in command)
    values = {
        "Type": "Application",
        "Version": "1.0",
        "Name": "mimics",
        "GenericName": "Virtual-reality rehabilitation",
        "Comment": "Tasks that are seen, heard and felt, adapted to the person",
        "Exec": _value(started),
        "Path": _value(str(folder)),
        "Icon": "mimics",
        "Terminal": "false",
        "Categories": "Science;MedicalSoftware;",
        "StartupWMClass": "mimics",
    }
    return "[Desktop Entry]\n" + "".join(f"{key}={value}\n" for key, value in values.items())


def _quoted(word: str) -> str:
    return '"' + word.translate(_ESCAPED).replace("%", "%%") + '"'


def _value(text: str) -> str:
    """A value of type string: a backslash stands for itself only when it is doubled."""
    return text.replace("\\", "\\\\").replace("\n", "\\n")


def _command() -> list[str]:
    script = Path(sys.executable).with_name("mimics")
    return [str(script)] if script.exists() else [sys.executable, "-m", "mimics_app"]


def _data_folder() -> Path:
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")


def _write(entry: Path, icon: Path, folder: Path) -> None:
    from mimics_app.contracts.system.resources import root
    from mimics_app.recording.run_folder import write_atomically

    folder.mkdir(parents=True, exist_ok=True)
    for file, content in (
        (icon, (root() / "assets" / "icon" / "mimics.png").read_bytes()),
        (entry, entry_of(_command(), folder).encode()),
    ):
        file.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(file, content)
