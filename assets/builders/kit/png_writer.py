"""PNG files with a palette, of equal bytes on every machine."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

__all__ = ["write_indexed_png"]

_BLOCK = 65535
"""Largest size of a stored block of deflate (RFC 1951, 3.2.4) [byte]."""


def write_indexed_png(indices: NDArray[np.uint8], palette: NDArray[np.uint8]) -> bytes:
    """Return a PNG file of palette entries, stored and not compressed: compressors differ by version.

    Args:
        indices: Palette entry of each pixel, row 0 at the top, uint8 [height, width].
        palette: sRGB colours, uint8 [n, 3], or with opacity [n, 4]; n <= 256.

    Raises:
        ValueError: an index beyond the palette, or a palette of another shape.
    """
    height, width = indices.shape
    if palette.ndim != 2 or palette.shape[1] not in (3, 4) or not 1 <= len(palette) <= 256:
        raise ValueError(f"a palette of shape {list(palette.shape)}")
    if indices.size and int(indices.max()) >= len(palette):
        raise ValueError(f"index {int(indices.max())} points past the {len(palette)} colours")
    rows = np.zeros((height, width + 1), np.uint8)  # filter 0 before each row
    rows[:, 1:] = indices
    chunks = [_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))]
    chunks.append(_chunk(b"PLTE", palette[:, :3].astype(np.uint8).tobytes()))
    if palette.shape[1] == 4:
        chunks.append(_chunk(b"tRNS", palette[:, 3].astype(np.uint8).tobytes()))
    chunks += [_chunk(b"IDAT", _stored(rows.tobytes())), _chunk(b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _stored(data: bytes) -> bytes:
    """Return a zlib stream of stored blocks (RFC 1950, 1951)."""
    blocks = [data[first : first + _BLOCK] for first in range(0, len(data), _BLOCK)] or [b""]
    parts = [b"\x78\x01"]
    for number, block in enumerate(blocks):
        last = number == len(blocks) - 1
        parts.append(struct.pack("<BHH", last, len(block), len(block) ^ 0xFFFF) + block)
    return b"".join(parts) + struct.pack(">I", zlib.adler32(data))
