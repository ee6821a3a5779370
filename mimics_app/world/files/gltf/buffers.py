"""Buffers and buffer views of a glTF file, with all bounds checked."""

from __future__ import annotations

import base64
import binascii

from mimics_app.world.files.gltf.gltf_document import MAX_TOTAL_BYTES, GltfSource
from mimics_app.world.files.reading.file_bytes import read_bytes

__all__ = ["GltfBuffers", "data_uri"]


class GltfBuffers:
    """Reader of buffers and buffer views; each buffer is read once, on demand."""

    def __init__(self, source: GltfSource) -> None:
        self._source = source
        self._buffers: dict[int, memoryview] = {}

    def view(self, index: object, pointer: str) -> tuple[memoryview, int]:
        """Return bytes and stride (0: packed) of a buffer view.

        Args:
            index: Index as given in the file.
            pointer: Pointer of the index.
        """
        source = self._source
        view = source.item("bufferViews", index, pointer)
        place = f"/bufferViews/{index}"
        buffer = self.whole(source.whole(view, "buffer", place), f"{place}/buffer")
        offset = source.whole(view, "byteOffset", place, 0)
        length = source.whole(view, "byteLength", place, None, 1)
        if offset + length > len(buffer):
            source.fail(place, f"needs {offset + length} bytes, its buffer has {len(buffer)}")
        stride = source.whole(view, "byteStride", place, 0)
        if stride and not 4 <= stride <= 252:
            source.fail(f"{place}/byteStride", f"{stride} is not between 4 and 252")
        return buffer[offset : offset + length], stride

    def whole(self, index: int, pointer: str) -> memoryview:
        """Return all bytes of a buffer.

        Args:
            index: Index as given in the file.
            pointer: Pointer of the index.
        """
        if index not in self._buffers:
            buffer = self._source.item("buffers", index, pointer)
            self._buffers[index] = memoryview(self._read(buffer, index))
        return self._buffers[index]

    def _read(self, buffer: dict[str, object], index: int) -> bytes:
        source, place = self._source, f"/buffers/{index}"
        length = source.whole(buffer, "byteLength", place, None, 1)
        source.take(length, f"{place}/byteLength")
        if "uri" not in buffer:
            if index != 0 or source.binary is None:
                source.fail(place, "has neither a uri nor a binary chunk")
            data = source.binary
        else:
            uri = source.text(buffer, "uri", place)
            if uri[:5].lower() == "data:":
                data = data_uri(source, uri, f"{place}/uri")
            else:
                path = source.external(uri, f"{place}/uri")
                data = read_bytes(path, str(path), MAX_TOTAL_BYTES)
        if length > len(data):
            source.fail(f"{place}/byteLength", f"{length} bytes are declared, {len(data)} are present")
        return data[:length]


def data_uri(source: GltfSource, uri: str, pointer: str) -> bytes:
    """Decode a base64 data URI."""
    head, comma, body = uri.partition(",")
    if not comma or not head.endswith(";base64"):
        source.fail(pointer, "is not a base64 data URI")
    try:
        return base64.b64decode(body, validate=True)
    except (binascii.Error, ValueError) as error:
        source.fail(pointer, f"is not base64: {error}")
