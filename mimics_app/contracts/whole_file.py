"""Writing of files that are complete or absent."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["whole_file"]


@contextmanager
def whole_file(file: Path) -> Iterator[None]:
    """Remove a file that cannot be written to its end, as on a full disk, and name it in the error.

    Raises:
        OSError: As raised inside; where the system gives its number, `filename` is set.
    """
    try:
        yield
    except OSError as error:
        if error.filename is None:  # the system names a file that it cannot open, not one that it cannot fill
            if error.errno:
                error.filename = str(file)
            if file.is_file():  # a device such as /dev/full stays
                file.unlink()
        raise
