"""Edits of the texts of a scene's files: a bounded history, and saving that overwrites nobody's changes."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.world.files.reading.json_text import parse_json
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SceneTexts", "is_written_in_file"]

MOST_STEPS = 500
"""Steps of the history; older ones are forgotten."""

_MARK = b"\xef\xbb\xbf"
"""Byte order mark."""


def is_written_in_file(scene: Scene, name: str) -> bool:
    """True when an entity is written in a scene file itself, not inside a prefab or a model."""
    return "/" not in name and any(entity.id == name and not entity.in_model for entity in scene.entities)


class _Patch(NamedTuple):
    """Replacement of a part of a file's text."""

    path: Path
    start: int
    removed: str
    added: str

    def reversed(self) -> _Patch:
        return _Patch(self.path, self.start, self.added, self.removed)


class _Step(NamedTuple):
    what: str
    patches: tuple[_Patch, ...]
    runs: bool


@dataclass(eq=False)
class _File:
    """One file: its text, and the bytes that it had when it was last read or saved (None: it was not there)."""

    mark: bytes
    text: str
    known: bytes | None
    document: dict[str, Any] = field(default_factory=dict)

    @property
    def data(self) -> bytes:
        return self.mark + self.text.encode()


class SceneTexts:
    """Texts of the files of a scene with the edits that are not saved yet.

    Args:
        files: The files, the scene's own first.

    Raises:
        SceneError: One cannot be read or is no JSON object.
    """

    def __init__(self, files: Sequence[Path]) -> None:
        self._files = {path: _read(path) for path in files}
        self._done: list[_Step] = []
        self._undone: list[_Step] = []

    @property
    def files(self) -> list[Path]:
        """The files, the scene's own first."""
        return list(self._files)

    def text(self, path: Path) -> str:
        """Return the present text of a file."""
        return self._files[path].text

    def document(self, path: Path) -> dict[str, Any]:
        """Return the present content of a file; it must not be changed."""
        return self._files[path].document

    @property
    def unsaved(self) -> dict[Path, bytes]:
        """Present bytes of the files with edits that are not saved."""
        return {path: file.data for path, file in self._files.items() if file.data != file.known}

    @property
    def steps(self) -> list[str]:
        """What was done and can be undone, oldest first."""
        return [step.what for step in self._done]

    @property
    def can_redo(self) -> bool:
        """Whether a step was undone that can be done again."""
        return bool(self._undone)

    def change(self, what: str, texts: Mapping[Path, str], *, merge: bool = False) -> bool:
        """Make one step of the history.

        Args:
            what: The step in words.
            texts: New texts of files.
            merge: Whether a value runs: with the last step, where that has the same words and ran too, it is one step.

        Returns:
            Whether anything changed.
        """
        patches = [_patch(path, self._files[path].text, text) for path, text in texts.items()]
        patches = [patch for patch in patches if patch.removed != patch.added]
        if not patches:
            return False
        self._apply(patches)
        self._undone.clear()
        if merge and self._done and (self._done[-1].what, self._done[-1].runs) == (what, True):
            patches = [*self._done.pop().patches, *patches]
        self._done = [*self._done[1 - MOST_STEPS :], _Step(what, tuple(patches), merge)]
        return True

    def undo(self) -> str:
        """Undo the last step; return its words, "" where there is none."""
        if not self._done:
            return ""
        step = self._done.pop()
        self._apply([patch.reversed() for patch in reversed(step.patches)])
        self._undone.append(step)
        return step.what

    def redo(self) -> str:
        """Do the step that was undone last again; return its words, "" where there is none."""
        if not self._undone:
            return ""
        step = self._undone.pop()
        self._apply(step.patches)
        self._done.append(step)
        return step.what

    def changed_on_disk(self) -> list[Path]:
        """Return the files that somebody else has changed since they were read or saved here."""
        return [path for path, file in self._files.items() if _bytes_of(path) != file.known]

    def read_again(self) -> None:
        """Take the files that were changed on the disk, without their edits; the history ends with them.

        Raises:
            SceneError: One cannot be read or is no JSON object; nothing was taken.
        """
        read = {path: _read(path) for path in self.changed_on_disk()}
        if read:
            self._done.clear()
            self._undone.clear()
        self._files |= read

    def follow(self, files: Sequence[Path]) -> None:
        """Have the files that the scene includes now; new ones are read, and the edits of the others stay.

        A file with edits that are not saved stays until they are; where one goes, the history ends.

        Raises:
            SceneError: A new one cannot be read or is no JSON object.
        """
        held = {path: self._files[path] for path in self.unsaved if path not in files}
        present = {path: self._files.get(path) or _read(path) for path in files} | held
        if self._files.keys() - present.keys():
            self._done.clear()
            self._undone.clear()
        self._files = present

    def save(self) -> list[Path]:
        """Write the edits to their files, each replaced atomically; return those files.

        Raises:
            SceneError: A file has changed on the disk, or cannot be written; the others are saved.
        """
        changed, written, issues = set(self.changed_on_disk()), [], []
        for path, data in self.unsaved.items():
            if path in changed:
                what = "was changed on the disk meanwhile, so it is not overwritten"
                issues.append(Issue(str(path), "", what, "Ctrl + R takes it, Ctrl + Shift + S saves yours elsewhere"))
                continue
            try:
                _replace(path, data)
            except SceneError as error:
                issues += error.issues
                continue
            self._files[path].known = data
            written.append(path)
        if issues:
            raise SceneError(issues)
        return written

    def save_as(self, path: Path) -> None:
        """Write the scene's own file under a new name, which is the scene's from now on; history and edits stay.

        Raises:
            SceneError: It exists, or cannot be written.
        """
        (own, file), *others = self._files.items()
        if path.exists():
            raise SceneError(Issue(str(path), "", "exists already", "give another name"))
        _replace(path, file.data)
        file.known = file.data
        self._files = {path: file, **dict(others)}
        for steps in (self._done, self._undone):
            steps[:] = [
                step._replace(patches=tuple(_moved(each, own, path) for each in step.patches)) for step in steps
            ]

    def _apply(self, patches: Sequence[_Patch]) -> None:
        for path, start, removed, added in patches:
            file = self._files[path]
            file.text = file.text[:start] + added + file.text[start + len(removed) :]
            file.document = json.loads(file.text)


def _moved(patch: _Patch, old: Path, new: Path) -> _Patch:
    return patch._replace(path=new) if patch.path == old else patch


def _patch(path: Path, before: str, after: str) -> _Patch:
    """Return the shortest replacement that makes one text of another."""
    start = _common(before, after)
    same = _common(before[start:][::-1], after[start:][::-1])
    return _Patch(path, start, before[start : len(before) - same], after[start : len(after) - same])


def _common(one: str, other: str) -> int:
    """Return the length of the beginning that two texts share."""
    low, high = 0, min(len(one), len(other))
    while low < high:
        half = (low + high + 1) // 2
        low, high = (half, high) if one[low:half] == other[low:half] else (low, half - 1)
    return low


def _bytes_of(path: Path) -> bytes | None:
    try:
        return read_regular(path)
    except OSError:
        return None


def _read(path: Path) -> _File:
    data = _bytes_of(path)
    if data is None:
        raise SceneError(Issue(str(path), "", "cannot be read"))
    document, issues = parse_json(data, str(path))
    if issues or not isinstance(document, dict):
        raise SceneError(issues or [Issue(str(path), "", "is not a scene")])
    mark = _MARK if data.startswith(_MARK) else b""
    return _File(mark, data[len(mark) :].decode(), data, document)


def _replace(path: Path, data: bytes) -> None:
    target = path.resolve()
    try:
        if target.exists() and not target.stat().st_mode & 0o222:  # its folder would let it be replaced nevertheless
            raise SceneError(Issue(str(path), "", "is read-only", "Ctrl + Shift + S saves it under another name"))
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            os.chmod(temporary, target.stat().st_mode & 0o7777 if target.exists() else 0o644)
            os.replace(temporary, target)
        except OSError:
            Path(temporary).unlink(missing_ok=True)
            raise
    except OSError as error:
        raise SceneError(Issue(str(path), "", f"cannot be written: {error.strerror}")) from None
