"""haptic_statics.npz: data that the loop receives once, for a replay: triangles, paths, names of force fields."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.recording.run_folder import FILES, write_atomically

__all__ = ["Statics", "read_statics", "write_statics"]

_FIELDS = "force_fields"
_WITHOUT = "the run cannot be replayed without it"
_BROKEN = (
    ValueError,
    KeyError,
    TypeError,  # an array where an archive should be
    AttributeError,
    EOFError,
    RuntimeError,  # an encrypted archive, an unknown compression
    MemoryError,  # a header that states more than the file holds
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
    OSError,
)
"""Errors of numpy and zipfile on damaged archives."""


@dataclass(frozen=True, slots=True)
class Statics:
    """Content of haptic_statics.npz.

    Attributes:
        arrays: The loop's tables by name.
        fields: Names of the force fields by EFFECT.field.
    """

    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    fields: Sequence[str] = ()


def write_statics(folder: Path, statics: Statics) -> None:
    """Write the file; nothing where a scene has none of it.

    Raises:
        OSError: The disk is full or failed.
    """
    if not statics.arrays and not statics.fields:
        return
    data = io.BytesIO()
    arrays: dict[str, Any] = {**statics.arrays, _FIELDS: np.array(list(statics.fields), np.str_)}
    np.savez_compressed(data, **arrays)
    write_atomically(folder / FILES["statics"], data.getvalue())


def read_statics(folder: Path) -> Statics | None:
    """Read haptic_statics.npz; None without the file.

    Raises:
        PartialDataError: The file is damaged.
    """
    path = folder / FILES["statics"]
    try:
        data = io.BytesIO(read_regular(path))
    except FileNotFoundError:
        return None
    except OSError as error:
        raise PartialDataError(f"{path} cannot be read: {error.strerror}", _WITHOUT) from error
    try:
        with np.load(data, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        fields = [str(name) for name in arrays.pop(_FIELDS)]
    except _BROKEN as error:
        raise PartialDataError(f"{path} cannot be read: {error!r}", _WITHOUT) from error
    return Statics(arrays, fields)
