"""A glTF file taken apart into its JSON and its binary chunk, and careful access to the values in that JSON.

Nothing in a file is believed: each value is fetched through these functions, which name the place of what is wrong.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from mimics_app.contracts.errors import Issue, SceneError, short_text
from mimics_app.contracts.plural import counted, singular
from mimics_app.world.scene.json_text import parse_json
from mimics_app.world.scene.paths import PathFault, find_file
from mimics_app.world.scene.source import read_bytes

__all__ = ["MAX_ITEMS", "MAX_NOTES", "MAX_TOTAL_BYTES", "GltfError", "GltfSource", "open_gltf", "parse_gltf"]

MAX_TOTAL_BYTES = 256 * 1024 * 1024
"""Most bytes one model may take in memory: buffers, decoded accessors, pictures, and the arrays of every primitive.

An array that several primitives use counts once for each, as each of them is a mesh of its own in a world.
"""

MAX_ITEMS = 100_000
"""Most nodes, meshes, materials and so on of one file, of each; also most primitives of all its meshes together."""

_MORE_ITEMS = {"accessors": 4 * MAX_ITEMS, "bufferViews": 4 * MAX_ITEMS}
"""Lists of which a mesh takes several."""

MAX_NOTES = 100
"""Most notes that are kept one by one."""

_GREATEST = 1e30
"""Beyond it a number has no square in single precision or is no figure of any model."""

GltfError = SceneError
"""A glTF file is wrong; every issue names file, JSON pointer and reason."""

_MAGIC = b"glTF"
_JSON_CHUNK = 0x4E4F534A
_BINARY_CHUNK = 0x004E4942


@dataclass(eq=False)
class GltfSource:
    """One opened file.

    Attributes:
        path: Where it is.
        file: Its name for messages.
        root: Folder that every file it names must stay inside.
        json: The document.
        binary: The GLB's binary chunk, or None.
        issues: Faults found so far.
        notes: What was left out or repaired, for people; put in by `note`.
        files: Every file read.
        without_pictures: True notes a picture that cannot be had instead of refusing the file.
    """

    path: Path
    file: str
    root: Path
    json: dict[str, Any]
    binary: bytes | None
    issues: list[Issue] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    without_pictures: bool = False
    _taken: int = 0
    _too_much: Issue | None = None
    _noted: int = 0
    _known: set[Issue] = field(default_factory=set)
    _tables: dict[str, list[dict[str, Any]]] = field(default_factory=dict)

    def fail(self, pointer: str, what: str, fix: str = "") -> NoReturn:
        """Raise the fault at a pointer."""
        raise SceneError(Issue(self.file, pointer, what, fix))

    @contextmanager
    def collecting(self) -> Iterator[None]:
        """Keep a fault raised inside and go on after the block."""
        try:
            yield
        except SceneError as error:
            for issue in error.issues:
                self.report(issue)

    def report(self, issue: Issue) -> None:
        """Keep a fault, once."""
        if issue not in self._known:
            self._known.add(issue)
            self.issues.append(issue)

    def note(self, text: str) -> None:
        """Keep a note, once; of very many only their number."""
        text = short_text(text)
        if text in self.notes:
            return
        self._noted += 1
        del self.notes[MAX_NOTES:]
        self.notes.append(text if self._noted <= MAX_NOTES else f"and {self._noted - MAX_NOTES} more notes")

    def take(self, size: int, pointer: str) -> None:
        """Count bytes before they are allocated; fails when the file wants too many in all."""
        self._taken += size
        if self._taken > MAX_TOTAL_BYTES:
            what = f"the model needs more than {MAX_TOTAL_BYTES // 1024**2} MiB of memory"
            self._too_much = self._too_much or Issue(self.file, pointer, what)
            raise SceneError(self._too_much)  # the same for all that is read after it: it is one fault

    def external(self, uri: str, pointer: str) -> Path:
        """The file a URI names."""
        try:
            path = find_file(uri, self.path.parent, self.root)
        except PathFault as fault:
            self.fail(pointer, fault.what, fault.fix)
        self.files.append(path)
        return path

    def table(self, name: str) -> list[dict[str, Any]]:
        """A top-level list of objects, such as "meshes"; empty where absent. It is looked through once."""
        if name not in self._tables:
            self._tables[name] = self._checked_table(name)
        return self._tables[name]

    def _checked_table(self, name: str) -> list[dict[str, Any]]:
        value = self.json.get(name, [])
        if not isinstance(value, list):
            self.fail(f"/{name}", "must be a list")
        most = _MORE_ITEMS.get(name, MAX_ITEMS)
        if len(value) > most:
            self.fail(f"/{name}", f"{len(value)} {name} are more than {most}")
        for i, item in enumerate(value):
            if not isinstance(item, dict):
                self.fail(f"/{name}/{i}", "must be an object")
        return value

    def item(self, name: str, index: object, pointer: str) -> dict[str, Any]:
        """The object that an index at `pointer` refers to."""
        table = self.table(name)
        return table[self.index(index, len(table), name, pointer)]

    def index(self, value: object, count: int, name: str, pointer: str) -> int:
        """An index below `count`."""
        if not isinstance(value, int) or isinstance(value, bool):
            self.fail(pointer, f"{value!r:.40} is not an index into {name}")
        if not 0 <= value < count:
            self.fail(pointer, f"there is no {singular(name)} {value}; the file has {counted(count, name)}")
        return value

    def object(self, holder: dict[str, Any], key: str, pointer: str) -> dict[str, Any]:
        """An object-valued property, {} where absent."""
        value = holder.get(key, {})
        if not isinstance(value, dict):
            self.fail(f"{pointer}/{key}", "must be an object")
        return value

    def list(self, holder: dict[str, Any], key: str, pointer: str) -> list[Any]:
        """A list-valued property, [] where absent."""
        value = holder.get(key, [])
        if not isinstance(value, list):
            self.fail(f"{pointer}/{key}", "must be a list")
        return value

    def text(self, holder: dict[str, Any], key: str, pointer: str, default: str = "") -> str:
        """A text-valued property."""
        value = holder.get(key, default)
        if not isinstance(value, str):
            self.fail(f"{pointer}/{key}", "must be a text")
        return value

    def whole(self, holder: dict[str, Any], key: str, pointer: str, default: int | None = None, least: int = 0) -> int:
        """A whole number of at least `least`; required where there is no default."""
        value = holder.get(key, default)
        if value is None:
            self.fail(pointer, f'the key "{key}" is missing')
        if not isinstance(value, int) or isinstance(value, bool) or value < least:
            self.fail(f"{pointer}/{key}", f"{value!r:.40} is not a whole number of {least} or more")
        return value

    def number(self, holder: dict[str, Any], key: str, pointer: str, default: float, least: float = -math.inf) -> float:
        """A finite number of at least `least`, below 1e30; the default, where absent, may be what it will."""
        if key not in holder:
            return default
        value = holder[key]
        if not isinstance(value, int | float) or isinstance(value, bool) or not value >= least:
            self.fail(f"{pointer}/{key}", f"{value!r:.40} is not a number" + (f" >= {least:g}" if least > -1e9 else ""))
        if not abs(value) < _GREATEST:
            self.fail(f"{pointer}/{key}", _fault_of_number(value))
        return float(value)

    def vector(self, holder: dict[str, Any], key: str, pointer: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """A list of as many finite numbers as the default has."""
        value = holder.get(key)
        if value is None:
            return default
        if not isinstance(value, list) or len(value) != len(default):
            self.fail(f"{pointer}/{key}", f"must be a list of {len(default)} numbers")
        for i, item in enumerate(value):
            if not isinstance(item, int | float) or isinstance(item, bool) or not abs(item) < _GREATEST:
                self.fail(f"{pointer}/{key}/{i}", _fault_of_number(item))
        return tuple(float(item) for item in value)


def _fault_of_number(value: object) -> str:
    """Why a value is no number that a model can have."""
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < math.inf:
        return f"{value!r:.40} is too large; it must be below {_GREATEST:g}"
    return f"{value!r:.40} is not a finite number"


def open_gltf(path: Path, root: Path, file: str) -> GltfSource:
    """Read a .glb or .gltf file, JSON only; nothing it names is opened.

    Args:
        path: The file.
        root: Folder that every file it names must stay inside.
        file: Name for messages.

    Raises:
        GltfError: it cannot be read, is damaged, or is another version.
    """
    return parse_gltf(read_bytes(path, file, MAX_TOTAL_BYTES), path, root, file)


def parse_gltf(data: bytes, path: Path, root: Path, file: str) -> GltfSource:
    """The same of a file's content.

    Args:
        data: What the file holds.
        path: Where it is or would be.
        root: Folder that every file it names must stay inside.
        file: Name for messages.

    Raises:
        GltfError: it is damaged, or is another version.
    """
    if path.suffix.lower() == ".glb" and data[:4] != _MAGIC and data.lstrip()[:1] != b"{":
        raise SceneError(Issue(file, "", "is no GLB: it does not begin with glTF", "export it again as binary glTF"))
    text, binary = _chunks(data, file) if data[:4] == _MAGIC else (data, None)
    document, issues = parse_json(text, file)
    if issues:  # values that no reader of this file could hold
        raise SceneError(issues)
    if not isinstance(document, dict):
        raise SceneError(Issue(file, "", "must be an object"))
    source = GltfSource(path, file, root, document, binary, files=[path.resolve()])
    _check_version(source)
    return source


def _chunks(data: bytes, file: str) -> tuple[bytes, bytes | None]:
    """JSON and binary chunk of a GLB."""

    def fail(what: str) -> NoReturn:
        raise SceneError(Issue(file, "", what))

    if len(data) < 20:
        fail(f"is cut off: {len(data)} bytes are too few for a GLB")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        fail(f"is GLB version {version}; only version 2 is read")
    if length > len(data):
        fail(f"is cut off: its header says {length} bytes, it has {len(data)}")
    chunks: list[tuple[int, bytes]] = []
    offset = 12
    while offset + 8 <= length:
        size, kind = struct.unpack_from("<II", data, offset)
        if offset + 8 + size > length:
            fail(f"chunk {len(chunks)} claims {size} bytes, {length - offset - 8} are left")
        chunks.append((kind, data[offset + 8 : offset + 8 + size]))
        offset += 8 + size
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        fail("its first chunk is not JSON")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BINARY_CHUNK else None
    return chunks[0][1], binary


def _check_version(source: GltfSource) -> None:
    asset = source.json.get("asset")
    if not isinstance(asset, dict):
        source.fail("/asset", "is missing: this is no glTF file")
    for key in ("version", "minVersion"):
        version = asset.get(key, "2.0")
        if not isinstance(version, str) or version.partition(".")[0] != "2":
            source.fail(f"/asset/{key}", f"{version!r:.40} is not read; only glTF 2")
