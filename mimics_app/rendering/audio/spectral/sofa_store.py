"""Access to the variables of a SOFA file (HDF5), by their shapes first and never outside the file.

HDF5 can refer to other files (links, raw storage, virtual data sets), be compressed a thousandfold, and raise
anything where it is damaged.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError, first_line
from mimics_app.contracts.system.read_budget import over_budget
from mimics_app.contracts.system.regular_file import open_regular

if TYPE_CHECKING:
    import h5py

__all__ = ["SofaStore", "open_store"]

_LARGEST_FILE = 1 << 30
_LONGEST_TEXT = 1 << 16
_DEFLATE, _SHUFFLE, _CHECKSUM = 1, 2, 3
"""Numbers of the filters of SOFA files in the registry of HDF5; each is used once."""
_DEFLATE_MOST = 1032
"""Largest ratio of deflate."""
_EXPORT = "export it again"


class SofaStore:
    """Variables and attributes of an open file; every method raises SceneError where they cannot be used.

    Args:
        path: The file, for messages.
        file: The open file.
    """

    def __init__(self, path: Path, file: h5py.File) -> None:
        self._path, self._file = path, file

    def refused(self, what: str, fix: str = _EXPORT) -> SceneError:
        """Return the error that refuses the file."""
        return SceneError(Issue(str(self._path), "", what, fix))

    def has(self, name: str) -> bool:
        """Whether there is a variable; a link out of the file is refused."""
        import h5py

        link = self._file.get(name, getclass=True, getlink=True)
        if link not in (None, h5py.HardLink):
            raise self.refused(f"{name} is a link to another place or file", "copy it into the file")
        return link is not None

    def text(self, name: str, variable: str = "") -> str:
        """Return an attribute of a variable, or of the file; "" where there is none."""
        attributes = (self._file[variable] if variable else self._file).attrs
        if name not in attributes:
            return ""
        if attributes.get_id(name).get_storage_size() > _LONGEST_TEXT:
            raise self.refused(f"its attribute {name} is not a word")
        value = attributes[name]
        value = value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
        return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)

    def shape(self, name: str) -> tuple[int, ...]:
        """Return the shape of a variable of numbers, of which nothing is read."""
        return tuple(self._variable(name).shape)

    def numbers(self, name: str) -> F8:
        """Return a variable as float64."""
        variable = self._variable(name)
        _check_chunks(self, name, variable)
        return np.asarray(variable[()], np.float64)

    def _variable(self, name: str) -> h5py.Dataset:
        import h5py

        if not self.has(name):
            raise self.refused(f"has no {name}")
        variable = self._file[name]
        if not isinstance(variable, h5py.Dataset) or variable.shape is None or variable.dtype.kind not in "fiu":
            raise self.refused(f"{name} holds no real numbers")
        if variable.external or variable.is_virtual:
            raise self.refused(f"{name} lies in another file", "copy it into the file")
        if what := over_budget(8 * math.prod(variable.shape)):
            raise self.refused(f"{name}, of the shape {variable.shape}, {what}", "give a head of fewer directions")
        return variable


def _check_chunks(store: SofaStore, name: str, variable: h5py.Dataset) -> None:
    """Check that what a variable's chunks unpack to is their size."""
    if variable.chunks is None:
        return
    size = math.prod(variable.chunks) * variable.dtype.itemsize
    plan = variable.id.get_create_plist()
    filters = sorted(plan.get_filter(number)[0] for number in range(plan.get_nfilters()))
    if over_budget(size) or not {*filters} <= {_DEFLATE, _SHUFFLE, _CHECKSUM} or len({*filters}) < len(filters):
        raise store.refused(f"{name} is compressed in a way that is not read", "export it with gzip, or without")
    if _DEFLATE not in filters:
        return
    for number in range(variable.id.get_num_chunks()):
        chunk = variable.id.get_chunk_info(number)
        if over_budget(chunk.size * _DEFLATE_MOST) and chunk.filter_mask == 0:
            packed = variable.id.read_direct_chunk(chunk.chunk_offset)[1]
            if len(zlib.decompressobj().decompress(packed, size + 5)) > size + 4:  # a checksum has four bytes
                raise store.refused(f"{name} unpacks to more than it says", "measure or export it again")


@contextmanager
def open_store(path: Path) -> Iterator[SofaStore]:
    """Open a file; whatever its damage makes the library raise inside refuses it.

    Raises:
        SceneError: It is missing, too large, no HDF5, damaged, or refused inside.
    """
    import h5py

    try:
        with open_regular(path) as stream:
            if stream.seek(0, 2) > _LARGEST_FILE:
                raise SceneError(Issue(str(path), "", "is larger than 1 GB", "give a head of fewer directions"))
            with h5py.File(stream, "r") as file:
                yield SofaStore(path, file)
    except SceneError:
        raise
    except Exception as error:  # h5py raises errors of every kind where a file is damaged
        text = "cannot be read" if path.exists() else "does not exist"
        why = first_line(error).split("(")[0].strip()[:80] or "no reason given"
        fix = "take another, or copy it again"
        raise SceneError(Issue(str(path), "", f"{text}, or is not a SOFA file ({why})", fix)) from error
