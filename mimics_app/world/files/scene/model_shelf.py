"""Decoded models of scenes: one that is in use, and whose files are as they were, is not decoded again."""

from __future__ import annotations

import hashlib
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from weakref import ref

from mimics_app.contracts.system.regular_file import open_regular, stamp_of
from mimics_app.world.files.gltf.file import GltfDocument, load_gltf

__all__ = ["MODELS", "ModelShelf", "digest_of"]

_PART = 1 << 20
"""Bytes of a file that are hashed at once: a recording need not fit into memory."""


_MOST_KEPT = 40
"""Number of models kept: those of any three shipped scenes."""


def digest_of(files: Sequence[Path]) -> str:
    """Return the SHA-256 over the bytes of files, in hexadecimal.

    Raises:
        OSError: One cannot be read.
    """
    digest = hashlib.sha256()
    for file in files:
        with open_regular(file) as stream:
            while part := stream.read(_PART):
                digest.update(part)
    return digest.hexdigest()


class ModelShelf:
    """Models by file, for scenes to share: nothing changes a decoded model, and `MeshBuffer` copies a mesh."""

    def __init__(self) -> None:
        self._decoded: dict[tuple[Path, Path], tuple[ref[GltfDocument], str]] = {}
        self._kept = deque[GltfDocument](maxlen=0)

    def keep(self) -> None:
        """Keep the models decoded last when no scene has them, for a process that loads many scenes."""
        self._kept = deque(self._kept, maxlen=_MOST_KEPT)

    def read(self, path: Path, root: Path) -> tuple[GltfDocument, str]:
        """Return the model of a file, with the digest of the bytes of all its files.

        Args:
            path: The file.
            root: Folder that all files it names must be inside.

        Raises:
            SceneError: It is missing or broken.
            OSError: A file was removed while it was read.
        """
        known, digest = self._known(path, root)
        if known is None:
            before = stamp_of(path)
            known = load_gltf(path, root)
            digest = digest_of(known.files)
            stamps = {path: before, **known.stamps}
            if all(stamp_of(file) == stamp for file, stamp in stamps.items()):  # else nobody may have decoded its bytes
                self._decoded[path, root] = ref(known), digest
                self._kept.append(known)
        return known, digest

    def _known(self, path: Path, root: Path) -> tuple[GltfDocument | None, str]:
        """Return a model that is still there, if all of its files are as they were."""
        there, digest = self._decoded.get((path, root), (None, ""))
        model = None if there is None else there()
        try:
            return (model, digest) if model is not None and digest_of(model.files) == digest else (None, "")
        except OSError:
            return None, ""


MODELS = ModelShelf()
"""Those of this process."""
