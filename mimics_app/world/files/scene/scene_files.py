"""Reading of the files of a scene: the main file and all it includes, decoded and checked for shape."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.components.registry import section_of
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.reading.json_text import find_controls, parse_json
from mimics_app.world.files.reading.paths import SHIPPED, PathFault, find_file
from mimics_app.world.files.reading.provenance import Layer
from mimics_app.world.files.reading.struct_reader import is_comment, read_struct
from mimics_app.world.files.scene.spec import FORMAT, MAX_ENTITIES, VERSION, SceneSpec

__all__ = ["MIGRATIONS", "SceneSource", "migrate", "read_sources"]


@dataclass(frozen=True, eq=False)
class SceneSource:
    """One decoded file.

    Attributes:
        path: The file.
        layer: Its whole document, in the newest version.
        whole: False for a scene file whose includes are incomplete, so that references may be unresolved.
    """

    path: Path
    layer: Layer
    whole: bool = True

    @property
    def document(self) -> dict[str, Any]:
        """The file's top-level object."""
        document: dict[str, Any] = self.layer.value
        return document


def read_sources(
    path: Path, root: Path, issues: list[Issue], unsaved: Mapping[Path, bytes] | None = None
) -> list[SceneSource]:
    """Read the scene file and, after it, all it includes, each file once.

    Args:
        path: The scene file.
        root: Folder that all files must be inside.
        issues: Receives faults of shape, and of files that cannot be included.
        unsaved: Bytes that count instead of those on the disk, by resolved file.

    Raises:
        SceneError: the scene file itself cannot be read or is not a scene.
    """
    reader = _Reader(root, issues, unsaved or {})
    reader.read(path, str(path))
    reader.follow_includes(reader.sources[0], (path.resolve(),))
    reader.sources[0] = replace(reader.sources[0], whole=not reader.misses)
    return reader.sources


class _Reader:
    def __init__(self, root: Path, issues: list[Issue], unsaved: Mapping[Path, bytes]) -> None:
        self._root = root
        self._issues = issues
        self._unsaved = unsaved
        self._seen: set[Path] = set()
        self.sources: list[SceneSource] = []
        self.misses = False

    def read(self, path: Path, file: str) -> SceneSource:
        """Decode one file and check its shape."""
        self._seen.add(path.resolve())
        text = self._unsaved.get(path.resolve()) or read_bytes(path, file)
        document, issues = parse_json(text, file)
        self._issues += issues + find_controls(document, text, file)
        if not isinstance(document, dict) or document.get("format") != FORMAT:
            what = f'is not a scene: it must be an object with "format": "{FORMAT}"'
            raise SceneError([*issues, Issue(file, "/format", what)])
        newest = migrate(document)
        if newest is None:
            what = f"version {document.get('version')!r:.40} cannot be read; this application reads up to {VERSION}"
            raise SceneError([*issues, Issue(file, "/version", what, "install a newer mimics_app")])
        entities = newest.get("entities")
        if isinstance(entities, list) and len(entities) > MAX_ENTITIES:
            what = f"{len(entities)} entities are more than {MAX_ENTITIES}"
            raise SceneError(Issue(file, "/entities", what, "merge equal ones into one model"))
        source = SceneSource(path, Layer(file, path.resolve().parent, "", newest))
        self._check_shape(source)
        self.sources.append(source)
        return source

    def follow_includes(self, source: SceneSource, above: tuple[Path, ...]) -> None:
        """Read the includes of a file, each file once."""
        uris = source.document.get("include", [])
        for i, uri in enumerate(uris if isinstance(uris, list) else []):
            if not isinstance(uri, str):
                continue
            try:
                path = find_file(uri, source.layer.folder, self._root)
            except PathFault as fault:
                self._issues.append(Issue(source.layer.file, f"/include/{i}", fault.what, fault.fix))
                self.misses = True
                continue
            if path in above:
                chain = " -> ".join(place.name for place in (*above[above.index(path) :], path))
                self._issues.append(Issue(source.layer.file, f"/include/{i}", f"includes itself: {chain}"))
            elif path not in self._seen:
                self._include(path, _display(source.layer.file, uri, path), above)

    def _include(self, path: Path, file: str, above: tuple[Path, ...]) -> None:
        try:
            self.follow_includes(self.read(path, file), (*above, path))
        except SceneError as error:
            self._issues += [issue for issue in error.issues if issue not in self._issues]
            self.misses = True

    def _check_shape(self, source: SceneSource) -> None:
        file = source.layer.file

        def report(pointer: str, what: str, fix: str) -> None:
            self._issues.append(Issue(file, pointer, what, fix))

        shape = SceneSpec.__struct_fields__
        own = {
            key: value
            for key, value in source.document.items()
            if key in shape or not (section_of(key) or is_comment(key))
        }
        read_struct(SceneSpec, own, report)


def _display(including: str, uri: str, path: Path) -> str:
    if uri.startswith(SHIPPED):
        return str(path)
    return os.path.normpath(os.path.join(os.path.dirname(including), uri))


MIGRATIONS: dict[int, Callable[[dict[str, Any]], dict[str, Any]]] = {}
"""Migrations from version n to n + 1, by n. Each returns a new document and leaves the old one unchanged."""


def migrate(document: dict[str, Any]) -> dict[str, Any] | None:
    """Return the document in the newest version, or None for a version that is too new, too old or not a number."""
    version = document.get("version")
    if not isinstance(version, int) or isinstance(version, bool) or version > VERSION:
        return None
    for step in range(version, VERSION):
        if step not in MIGRATIONS:
            return None
        document = MIGRATIONS[step](document) | {"version": step + 1}
    return document
