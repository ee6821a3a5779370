"""Location of shaders, scenes and assets: inside an installed package, or at the root of a checkout."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.errors import MimicsError

__all__ = ["FOLDERS", "root"]

FOLDERS = ("assets", "scenes", "shaders")


def root() -> Path:
    """Return the folder with `assets`, `scenes` and `shaders`.

    A wheel has them in `mimics_app/data`; an editable install and a checkout have them beside the package.

    Raises:
        MimicsError: Neither folder is complete.
    """
    package = Path(__file__).resolve().parents[2]
    for candidate in (package / "data", package.parent):
        if all((candidate / name).is_dir() for name in FOLDERS):
            return candidate
    raise MimicsError(
        f"this installation has no {', '.join(FOLDERS)}: neither in {package / 'data'} nor in {package.parent}",
        "install the wheel again, or run from a complete checkout",
    )
