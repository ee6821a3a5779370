"""SceneWatcher: detects saves of files by polling."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

__all__ = ["SceneWatcher"]


class SceneWatcher:
    """Detector of saves of some files. Costs one `stat` per file; poll it a few times a second."""

    def __init__(self, paths: Iterable[Path]) -> None:
        self._paths = list(paths)
        self._seen = [_stamp(path) for path in self._paths]

    def changed(self) -> bool:
        """True once after each save (changed time or size), removal or return of a file."""
        now = [_stamp(path) for path in self._paths]
        changed = now != self._seen
        self._seen = now
        return changed

    def watch(self, paths: Iterable[Path]) -> None:
        """Watch these files instead; those watched already keep their state."""
        known = dict(zip(self._paths, self._seen, strict=True))
        self._paths = list(paths)
        self._seen = [known.get(path, _stamp(path)) for path in self._paths]


def _stamp(path: Path) -> tuple[int, int] | None:
    try:
        stat = path.stat()
    except OSError:
        return None
    return stat.st_mtime_ns, stat.st_size
