"""Writing an entity's translation back into its scene file without changing any other character."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.world.files.reading.json_spans import Span, find_span, members
from mimics_app.world.files.reading.json_text import parse_json
from mimics_app.world.files.scene.scene import Scene

__all__ = ["edit_translation", "is_written_in_file", "write_translation"]


_DIGITS = 4
"""Decimals of a metre in the file."""

_NUMBER = re.compile(r"-?\d[\d.eE+-]*")


def is_written_in_file(scene: Scene, name: str) -> bool:
    """True when an entity is written in a scene file itself, not inside a prefab or a model."""
    return "/" not in name and any(entity.id == name and not entity.in_model for entity in scene.entities)


def write_translation(scene: Scene, name: str, translation: Vec3) -> Path:
    """Write an entity's translation into its scene file, which may have been edited since it was read.

    The file is replaced atomically, so that no reader sees half of it.

    Args:
        scene: As it was loaded.
        name: Id of an entity that `is_written_in_file`.
        translation: Relative to its parent [m]; rounded to a tenth of a millimetre.

    Returns:
        The file.

    Raises:
        SceneError: the file is missing or no longer a scene, or the entity is gone from it.
    """
    layer = scene.origins.locate(scene.entity(name).pointer)
    path = Path(layer.file)
    try:
        data = read_regular(path)
        document, issues = parse_json(data, layer.file)
        text = data.decode("utf-8-sig")
    except OSError as error:
        raise SceneError(Issue(layer.file, "", f"cannot be read: {error.strerror}")) from None
    if issues or not isinstance(document, dict):
        raise SceneError(issues or [Issue(layer.file, "", "is not a scene any more")])
    mark = b"\xef\xbb\xbf" if data.startswith(b"\xef\xbb\xbf") else b""
    _replace(path, mark + edit_translation(text, name, translation, layer.file).encode())
    return path


def edit_translation(text: str, name: str, translation: Vec3, file: str = "") -> str:
    """Return the text of a scene file with an entity's translation changed.

    Equal numbers keep their spelling. A missing transform is added behind the id.

    Args:
        text: The whole file.
        name: Id of the entity.
        translation: Relative to its parent [m].
        file: Name in messages.

    Raises:
        SceneError: no entity in it has that id.
    """
    place = _entity(text, name)
    if place is None:
        raise SceneError(Issue(file, "/entities", f'no entity "{name}" is here any more', "load the scene again"))
    numbers = [round(float(value), _DIGITS) + 0.0 for value in translation]
    steps = ["entities", place]
    there = find_span(text, [*steps, "transform", "translation"])
    if there is not None:
        return _exchange(text, there, numbers)
    member = f'"translation": {numbers}'
    transform = find_span(text, [*steps, "transform"])
    if transform is not None:
        first = next(members(text, transform[0]), None)
        if first is None:
            return _put(text, transform, "{" + member + "}")
        return text[: first[1]] + member + "," + _gap(text, first[1]) + text[first[1] :]
    entity = find_span(text, steps)
    assert entity is not None
    begin, (_, end) = next((at, span) for key, at, span in members(text, entity[0]) if key == "id")
    return text[:end] + "," + _gap(text, begin) + f'"transform": {{{member}}}' + text[end:]


def _entity(text: str, name: str) -> str | None:
    """Return the number of an entity in its list, as a step of a pointer."""
    entities = find_span(text, ["entities"])
    for number, _, (start, _) in members(text, entities[0]) if entities else ():
        if any(key == "id" and _unquoted(text, span) == name for key, _, span in members(text, start)):
            return number
    return None


def _unquoted(text: str, span: Span) -> str:
    return str(parse_json(text[slice(*span)].encode(), "")[0])


def _exchange(text: str, span: Span, numbers: Sequence[float]) -> str:
    """Replace the numbers of a list one by one, or the whole value where it is not a list of as many numbers."""
    found = list(members(text, span[0]))
    if len(found) != len(numbers) or not all(_NUMBER.fullmatch(text[slice(*value)]) for _, _, value in found):
        return _put(text, span, str(numbers))
    for (_, _, number), value in reversed(list(zip(found, numbers, strict=True))):
        if float(text[slice(*number)]) != value:
            text = _put(text, number, repr(value))
    return text


def _gap(text: str, first: int) -> str:
    """Return the white space between members of an object, one of whose keys begins at `first`."""
    space = text[:first][len(text[:first].rstrip(" \t\r\n")) :]
    return space if "\n" in space else " "


def _put(text: str, span: Span, new: str) -> str:
    return text[: span[0]] + new + text[span[1] :]


def _replace(path: Path, data: bytes) -> None:
    target = path.resolve()
    try:
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(data)
                stream.flush()
                os.fsync(stream.fileno())
            os.chmod(temporary, target.stat().st_mode & 0o7777)
            os.replace(temporary, target)
        except OSError:
            Path(temporary).unlink(missing_ok=True)
            raise
    except OSError as error:
        raise SceneError(Issue(str(path), "", f"cannot be written: {error.strerror}")) from None
