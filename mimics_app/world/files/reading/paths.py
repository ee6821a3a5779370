"""Resolution of file names in scene and glTF files, confined to one folder."""

from __future__ import annotations

import re
from pathlib import Path
from urllib.parse import unquote

from mimics_app.contracts.errors import MimicsError, nearest
from mimics_app.contracts.system import resources

__all__ = ["SHIPPED", "PathFault", "find_file", "find_root"]

SHIPPED = "mimics:"
"""Prefix of URIs of the installation's files, e.g. "mimics:assets/sounds/goal.wav"."""

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


class PathFault(Exception):
    """A URI without a permitted file: what is wrong, and what to do."""

    def __init__(self, what: str, fix: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.fix = fix


def find_root(scene: Path) -> Path:
    """Return the folder that all files of a scene must be inside.

    It is the nearest folder above that holds both `scenes` and `assets`, else the scene's own folder.
    """
    folder = scene.resolve().parent
    for candidate in (folder, *folder.parents):
        if (candidate / "scenes").is_dir() and (candidate / "assets").is_dir():
            return candidate
    return folder


def find_file(uri: str, folder: Path, root: Path) -> Path:
    """Return the file of a URI.

    Args:
        uri: Relative, percent-encoded where needed, with forward slashes; or one of the installation (`SHIPPED`).
        folder: Folder the URI is relative to.
        root: Folder that it must be inside, links followed.

    Raises:
        PathFault: another scheme, an absolute path, a path out of the root, or no such file.
    """
    if uri.startswith(SHIPPED):
        try:
            folder = root = resources.root()
        except MimicsError as error:
            raise PathFault(error.what, error.fix) from None
        uri = uri[len(SHIPPED) :]
    inside = root.resolve()
    try:
        path = (folder / _relative(uri)).resolve()
        is_file = path.is_file()
    except (OSError, RuntimeError) as error:  # a name too long, a loop of links
        raise PathFault(f'"{uri}" cannot be a file: {getattr(error, "strerror", None) or error}') from None
    if not path.is_relative_to(inside):
        raise PathFault(f'"{uri}" leads out of the folder {inside.name or inside}', "keep files inside it")
    if not is_file:
        raise PathFault(f'no file "{uri}"', _similar(path))
    return path


def _relative(uri: str) -> str:
    if not uri:
        raise PathFault("an empty file name")
    if _SCHEME.match(uri):
        raise PathFault(f'"{uri[:60]}" is not a relative path; nothing is fetched', "name a file of the scene's folder")
    text = unquote(uri, errors="replace")
    if "\0" in text or "\ufffd" in text:
        raise PathFault(f'"{uri}" is not a file name')
    if text.startswith("/") or "\\" in text:
        raise PathFault(f'"{uri}" is an absolute path or has backslashes', "write it relative, with /")
    return text


def _similar(path: Path) -> str:
    if not path.parent.is_dir():
        return f'there is no folder "{path.parent.name}"'
    try:
        names = sorted(entry.name for entry in path.parent.iterdir() if entry.is_file())
    except OSError:  # a folder that may not be listed
        return ""
    hint = nearest(path.name, names)
    return hint if hint.startswith("did") else ""
