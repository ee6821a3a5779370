"""Bytes of a file that a scene names, or the fault of that file."""

from __future__ import annotations

from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import read_regular

__all__ = ["read_bytes"]

_MAX_BYTES = 64 * 1024 * 1024
"""Maximum size of a scene file [bytes]; one of 10,000 entities has about 2 million."""


def read_bytes(path: Path, file: str, limit: int = _MAX_BYTES) -> bytes:
    """Read the bytes of a file.

    Raises:
        SceneError: it cannot be read or is longer than `limit`.
    """
    try:
        data = read_regular(path, limit + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        what = (
            "no such file"
            if isinstance(error, FileNotFoundError)
            else f"cannot be read: {getattr(error, 'strerror', error)}"
        )
        raise SceneError(Issue(file, "", what)) from None
    if len(data) > limit:
        raise SceneError(Issue(file, "", f"is larger than {limit // 1024**2} MiB"))
    return data
