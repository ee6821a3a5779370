"""Accessors of a glTF file as arrays: strides, normalised integers, sparse values; bounds before allocation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F4, Records
from mimics_app.world.files.gltf.buffers import GltfBuffers
from mimics_app.world.files.gltf.gltf_document import GltfSource

__all__ = ["GltfAccessors"]

_MAX_ELEMENTS = 50_000_000
"""Maximum number of components in one accessor."""

_TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_INDEX_TYPES = (np.uint8, np.uint16, np.uint32)
_FLOAT = 5126


class GltfAccessors:
    """Reader of accessors by index; each is decoded once, and its memory is counted with every use."""

    def __init__(self, source: GltfSource, buffers: GltfBuffers) -> None:
        self._source = source
        self._buffers = buffers
        self._decoded: dict[int, Records] = {}
        self._converted: dict[tuple[int, type], Records] = {}

    def floats(self, index: object, pointer: str, *shapes: str) -> NDArray[np.float32]:
        """Read an accessor as float32 [n, components], normalised integers converted to 0..1 or -1..1.

        Args:
            index: Index as given in the file.
            pointer: Pointer of the index.
            shapes: Permitted types, e.g. "VEC3".
        """
        place = self._require(index, pointer, shapes)
        values = self._read(place, pointer)
        if values.dtype == np.float32:
            return values
        return self._as(np.float32, place, lambda: self._normalised(values, self._source.table("accessors")[place]))

    def integers(self, index: object, pointer: str) -> NDArray[np.uint32]:
        """Read a SCALAR accessor of unsigned integers as uint32 [n]."""
        place = self._require(index, pointer, ("SCALAR",))
        values = self._read(place, pointer)
        if values.dtype.type not in _INDEX_TYPES:
            self._source.fail(f"/accessors/{place}/componentType", "indices must be unsigned integers")
        if values.dtype == np.uint32:
            return values.reshape(-1)
        return self._as(np.uint32, place, lambda: values.reshape(-1).astype(np.uint32))

    def whole_numbers(self, index: object, pointer: str, *shapes: str) -> NDArray[np.uint16]:
        """Read an accessor of unsigned bytes or shorts as uint16 [n, components]."""
        place = self._require(index, pointer, shapes)
        values = self._read(place, pointer)
        if values.dtype.type not in _INDEX_TYPES[:2]:
            self._source.fail(f"/accessors/{place}/componentType", "must be unsigned bytes or shorts")
        if values.dtype == np.uint16:
            return values
        return self._as(np.uint16, place, lambda: values.astype(np.uint16))

    def shares(self, index: object, pointer: str, *shapes: str) -> NDArray[np.float32]:
        """Read an accessor of numbers from 0 to 1, float or normalised integers, as float32 [n, components]."""
        place = self._require(index, pointer, shapes)
        accessor = self._source.table("accessors")[place]
        if accessor.get("componentType") != _FLOAT and accessor.get("normalized") is not True:
            self._source.fail(f"/accessors/{place}/normalized", "integer weights must be normalised")
        return self.floats(index, pointer, *shapes)

    def stored(self, index: object, pointer: str) -> Records:
        """Read an accessor of any type as stored, sparse values applied, [n, components]."""
        return self._read(self._require(index, pointer, tuple(_SIZES)), pointer)

    def of_vertices(self, holder: dict[str, Any], name: str, place: str, vertices: int, *shapes: str) -> F4 | None:
        """Read a member of attributes or of a morph target as `floats`, one element a vertex; None where absent."""
        if name not in holder:
            return None
        values = self.floats(holder[name], f"{place}/{name}", *shapes)
        self.check_count(len(values), vertices, f"{place}/{name}")
        return values

    def check_count(self, found: int, vertices: int, pointer: str) -> None:
        """Report an attribute that has not one element for each vertex."""
        if found != vertices:
            self._source.fail(pointer, f"has {found} elements, POSITION has {vertices}")

    def count(self, index: object, pointer: str) -> int:
        """Return the number of elements of an accessor without decoding it."""
        accessor = self._source.item("accessors", index, pointer)
        return self._source.whole(accessor, "count", f"/accessors/{index}", None, 1)

    def _require(self, index: object, pointer: str, shapes: tuple[str, ...]) -> int:
        table = self._source.table("accessors")
        place = self._source.index(index, len(table), "accessors", pointer)
        shape = table[place].get("type")
        if shape not in shapes:
            self._source.fail(f"/accessors/{place}/type", f"{shape!r:.40} instead of {' or '.join(shapes)}")
        return place

    def _read(self, index: int, pointer: str) -> Records:
        if index in self._decoded:
            self._source.take(self._decoded[index].nbytes, pointer)  # each further mesh has a copy of its own
        else:
            self._decoded[index] = self._decode(self._source.table("accessors")[index], f"/accessors/{index}")
        return self._decoded[index]

    def _as(self, kind: type, index: int, convert: Callable[[], Records]) -> Records:
        """Return an accessor in another type, converted once."""
        if (index, kind) not in self._converted:
            self._source.take(self._decoded[index].size * np.dtype(kind).itemsize, f"/accessors/{index}/count")
            self._converted[index, kind] = convert()
        return self._converted[index, kind]

    def _decode(self, accessor: dict[str, Any], place: str) -> Records:
        source = self._source
        kind = _TYPES.get(source.whole(accessor, "componentType", place))
        if kind is None:
            source.fail(f"{place}/componentType", f"{accessor['componentType']} is not a component type")
        dtype, width = np.dtype(kind), _SIZES[accessor["type"]]
        count = source.whole(accessor, "count", place, None, 1)
        if count * width > _MAX_ELEMENTS:
            source.fail(f"{place}/count", f"{count} elements of {width} are more than {_MAX_ELEMENTS} numbers")
        if accessor["type"].startswith("MAT") and kind is not np.float32:
            source.fail(f"{place}/componentType", "matrices must be float")
        if "bufferView" in accessor:
            values = self._strided(accessor, place, dtype, width, count)
        else:
            source.take(count * width * dtype.itemsize, f"{place}/count")
            values = np.zeros((count, width), dtype)
        if "sparse" in accessor:
            self._apply_sparse(source.object(accessor, "sparse", place), f"{place}/sparse", values)
        if kind is np.float32 and not np.isfinite(values).all():
            first = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
            source.fail(place, f"element {first} is not finite")
        return values

    def _strided(self, accessor: dict[str, Any], place: str, dtype: np.dtype[Any], width: int, count: int) -> Records:
        source = self._source
        data, stride = self._buffers.view(accessor["bufferView"], f"{place}/bufferView")
        offset = source.whole(accessor, "byteOffset", place, 0)
        size = dtype.itemsize * width
        step = stride or size
        if step < size:
            source.fail(place, f"elements of {size} bytes overlap: the stride is {step}")
        needed = offset + step * (count - 1) + size
        if needed > len(data):
            source.fail(place, f"needs {needed} bytes, its buffer view has {len(data)}")
        source.take(size * count, f"{place}/count")
        return np.ndarray((count, width), dtype.newbyteorder("<"), data, offset, (step, dtype.itemsize)).astype(dtype)

    def _apply_sparse(self, sparse: dict[str, Any], place: str, values: Records) -> None:
        source = self._source
        count = source.whole(sparse, "count", place, None, 1)
        if count > len(values):
            source.fail(f"{place}/count", f"{count} replacements of {len(values)} elements")
        where = source.object(sparse, "indices", place)
        kind = _TYPES.get(source.whole(where, "componentType", f"{place}/indices"))
        if kind not in _INDEX_TYPES:
            source.fail(f"{place}/indices/componentType", "indices must be unsigned integers")
        indices = self._packed(where, f"{place}/indices", np.dtype(kind), count, 1)[:, 0].astype(np.int64)
        if int(indices.max()) >= len(values) or (np.diff(indices) <= 0).any():
            source.fail(f"{place}/indices", f"must rise and stay below {len(values)}")
        put = source.object(sparse, "values", place)
        values[indices] = self._packed(put, f"{place}/values", values.dtype, count, values.shape[1])

    def _packed(self, holder: dict[str, Any], place: str, dtype: np.dtype[Any], count: int, width: int) -> Records:
        if "bufferView" not in holder:
            self._source.fail(place, 'the key "bufferView" is missing')
        data, _ = self._buffers.view(holder["bufferView"], f"{place}/bufferView")
        offset = self._source.whole(holder, "byteOffset", place, 0)
        size = dtype.itemsize * width * count
        if offset + size > len(data):
            self._source.fail(place, f"needs {offset + size} bytes, its buffer view has {len(data)}")
        return np.frombuffer(data, dtype.newbyteorder("<"), count * width, offset).reshape(count, width).astype(dtype)

    def _normalised(self, values: Records, accessor: dict[str, Any]) -> NDArray[np.float32]:
        scaled = np.empty(values.shape, np.float32)
        largest = np.iinfo(values.dtype).max if accessor.get("normalized") is True else 1
        np.divide(values, float(largest), out=scaled, dtype=np.float64, casting="same_kind")  # block by block
        return scaled if largest == 1 else np.maximum(scaled, -1.0, out=scaled)
