"""JSON and binary chunk of a glTF file, with validated access to the values of the JSON.

Every value is read through these functions, which report the place of a fault.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from mimics_app.contracts.errors import Issue, SceneError, counted, short_text, singular
from mimics_app.contracts.system.read_budget import READ_BUDGET
from mimics_app.contracts.system.regular_file import Stamp, stamp_of
from mimics_app.world.files.reading.file_bytes import read_bytes
from mimics_app.world.files.reading.json_text import parse_json
from mimics_app.world.files.reading.paths import PathFault, find_file

__all__ = [
    "GLTF_SUFFIXES",
    "MAX_ITEMS",
    "MAX_NOTES",
    "MAX_TOTAL_BYTES",
    "GltfError",
    "GltfSource",
    "open_gltf",
    "parse_gltf",
]

T = TypeVar("T")

MAX_TOTAL_BYTES = READ_BUDGET
"""Maximum memory of one model [bytes]: buffers, decoded accessors, images, and the arrays of every primitive.

An array that several primitives use counts once for each, as each of them is a mesh of its own in a world.
"""

GLTF_SUFFIXES = (".glb", ".gltf", ".vrm")
"""Endings of glTF files; those of VRM are binary glTF with a table of bones."""

MAX_ITEMS = 100_000
"""Maximum number of nodes, of meshes, of materials and so on, and of primitives of all meshes together."""

_OTHER_ITEMS = {"accessors": 4 * MAX_ITEMS, "bufferViews": 4 * MAX_ITEMS, "animations": MAX_ITEMS // 10}
"""Maximum length of lists that a mesh refers to several times, and of those whose items take longer to read."""

MAX_NOTES = 100
"""Maximum number of notes kept one by one."""

_MAX_NUMBER = 1e30
"""Bound of numbers in the JSON, far beyond those of any model."""

GltfError = SceneError
"""Faults of a glTF file; every issue has file, JSON pointer and reason."""

_MAGIC = b"glTF"
_JSON_CHUNK = 0x4E4F534A
_BINARY_CHUNK = 0x004E4942


@dataclass(eq=False)
class GltfSource:
    """One opened file.

    Attributes:
        path: The file.
        file: Name in messages.
        root: Folder that all files it names must be inside.
        json: The document.
        binary: The GLB's binary chunk, or None.
        issues: Faults found so far.
        notes: Notes on content that was left out or repaired, added by `note`.
        files: Every file read.
        stamps: State of each file beside it before it was read first, see `stamp_of`.
        without_pictures: True notes a missing or broken image instead of refusing the file.
    """

    path: Path
    file: str
    root: Path
    json: dict[str, Any]
    binary: bytes | None
    issues: list[Issue] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)
    stamps: dict[Path, Stamp | None] = field(default_factory=dict)
    without_pictures: bool = False
    _taken: int = 0
    _too_much: Issue | None = None
    _noted: int = 0
    _known: set[Issue] = field(default_factory=set)
    _tables: dict[str, list[dict[str, Any]]] = field(default_factory=dict)

    def fail(self, pointer: str, what: str, fix: str = "") -> NoReturn:
        """Raise a fault at a pointer."""
        raise SceneError(Issue(self.file, pointer, what, fix))

    @contextmanager
    def collecting(self) -> Iterator[None]:
        """Keep a fault raised inside and continue after the block."""
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
        """Count bytes before they are allocated; fail when the file needs too many in all."""
        self._taken += size
        if self._taken > MAX_TOTAL_BYTES:
            what = f"the model needs more than {MAX_TOTAL_BYTES // 1024**2} MiB of memory"
            self._too_much = self._too_much or Issue(self.file, pointer, what)
            raise SceneError(self._too_much)  # one fault, also for all that is read later

    def external(self, uri: str, pointer: str) -> Path:
        """Return the file of a URI."""
        try:
            path = find_file(uri, self.path.parent, self.root)
        except PathFault as fault:
            self.fail(pointer, fault.what, fault.fix)
        self.files.append(path)
        if path not in self.stamps:
            self.stamps[path] = stamp_of(path)
        return path

    def table(self, name: str) -> list[dict[str, Any]]:
        """Return a top-level list of objects, such as "meshes"; empty where absent. It is checked once."""
        if name not in self._tables:
            self._tables[name] = self._checked_table(name)
        return self._tables[name]

    def _checked_table(self, name: str) -> list[dict[str, Any]]:
        value = self.json.get(name, [])
        if not isinstance(value, list):
            self.fail(f"/{name}", "must be a list")
        limit = _OTHER_ITEMS.get(name, MAX_ITEMS)
        if len(value) > limit:
            self.fail(f"/{name}", f"{len(value)} {name} are more than {limit}")
        for i, item in enumerate(value):
            self.entry(item, f"/{name}/{i}")
        return value

    def read_each(
        self, items: list[Any], pointer: str, read: Callable[[dict[str, Any], str], T], faulty: Callable[[], T]
    ) -> list[T]:
        """Read the items of a list, each from its object and pointer; a fault is collected and `faulty` called instead.

        Args:
            items: Items of the list, which must be objects.
            pointer: Pointer of the list.
            read: Reads one item.
            faulty: Returns what stands for an item with a fault.
        """
        results = []
        for i, item in enumerate(items):
            place = f"{pointer}/{i}"
            with self.collecting():
                results.append(read(self.entry(item, place), place))
            if len(results) == i:
                results.append(faulty())
        return results

    def entry(self, value: object, pointer: str) -> dict[str, Any]:
        """Return a value that must be an object."""
        if not isinstance(value, dict):
            self.fail(pointer, "must be an object")
        return value

    def item(self, name: str, index: object, pointer: str) -> dict[str, Any]:
        """Return the object that an index at `pointer` refers to."""
        table = self.table(name)
        return table[self.index(index, len(table), name, pointer)]

    def index(self, value: object, count: int, name: str, pointer: str) -> int:
        """Return an index after checking that it is below `count`."""
        if not isinstance(value, int) or isinstance(value, bool):
            self.fail(pointer, f"{value!r:.40} is not an index into {name}")
        if not 0 <= value < count:
            self.fail(pointer, f"there is no {singular(name)} {value}; the file has {counted(count, name)}")
        return value

    def object(self, holder: dict[str, Any], key: str, pointer: str) -> dict[str, Any]:
        """Return an object-valued property, {} where absent."""
        return self.entry(holder.get(key, {}), f"{pointer}/{key}")

    def extension(self, holder: dict[str, Any], name: str, pointer: str) -> dict[str, Any]:
        """Return an extension of an object, {} where absent."""
        return self.object(self.object(holder, "extensions", pointer), name, f"{pointer}/extensions")

    def list(self, holder: dict[str, Any], key: str, pointer: str) -> list[Any]:
        """Return a list-valued property, [] where absent."""
        value = holder.get(key, [])
        if not isinstance(value, list):
            self.fail(f"{pointer}/{key}", "must be a list")
        return value

    def text(self, holder: dict[str, Any], key: str, pointer: str, default: str = "") -> str:
        """Return a string-valued property."""
        value = holder.get(key, default)
        if not isinstance(value, str):
            self.fail(f"{pointer}/{key}", "must be a text")
        return value

    def choice(
        self, holder: dict[str, Any], key: str, pointer: str, choices: Collection[str], default: str = ""
    ) -> str:
        """Return a string-valued property that must be one of some."""
        value = self.text(holder, key, pointer, default)
        if value not in choices:
            self.fail(f"{pointer}/{key}", f'"{value:.40}" is not one of {", ".join(choices)}')
        return value

    def whole(self, holder: dict[str, Any], key: str, pointer: str, default: int | None = None, least: int = 0) -> int:
        """Return an integer of at least `least`; required where there is no default."""
        value = holder.get(key, default)
        if value is None:
            self.fail(pointer, f'the key "{key}" is missing')
        if not isinstance(value, int) or isinstance(value, bool) or value < least:
            self.fail(f"{pointer}/{key}", f"{value!r:.40} is not a whole number of {least} or more")
        return value

    def number(self, holder: dict[str, Any], key: str, pointer: str, default: float, least: float = -math.inf) -> float:
        """Return a finite number of at least `least`, below 1e30; the default is not checked."""
        if key not in holder:
            return default
        value = holder[key]
        if not isinstance(value, int | float) or isinstance(value, bool) or not value >= least:
            self.fail(f"{pointer}/{key}", f"{value!r:.40} is not a number" + (f" >= {least:g}" if least > -1e9 else ""))
        if not abs(value) < _MAX_NUMBER:
            self.fail(f"{pointer}/{key}", _fault_of_number(value))
        return float(value)

    def vector(self, holder: dict[str, Any], key: str, pointer: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return a list of as many finite numbers as the default has."""
        value = holder.get(key)
        if value is None:
            return default
        if not isinstance(value, list) or len(value) != len(default):
            self.fail(f"{pointer}/{key}", f"must be a list of {len(default)} numbers")
        for i, item in enumerate(value):
            if not isinstance(item, int | float) or isinstance(item, bool) or not abs(item) < _MAX_NUMBER:
                self.fail(f"{pointer}/{key}/{i}", _fault_of_number(item))
        return tuple(float(item) for item in value)


def _fault_of_number(value: object) -> str:
    """Return why a value is not a permitted number."""
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < math.inf:
        return f"{value!r:.40} is too large; it must be below {_MAX_NUMBER:g}"
    return f"{value!r:.40} is not a finite number"


def open_gltf(path: Path, root: Path, file: str) -> GltfSource:
    """Read a .glb or .gltf file, JSON only; nothing it names is opened.

    Args:
        path: The file.
        root: Folder that all files it names must be inside.
        file: Name for messages.

    Raises:
        GltfError: it cannot be read, is damaged, or is another version.
    """
    return parse_gltf(read_bytes(path, file, MAX_TOTAL_BYTES), path, root, file)


def parse_gltf(data: bytes, path: Path, root: Path, file: str) -> GltfSource:
    """Parse the content of a .glb or .gltf file.

    Args:
        data: Content of the file.
        path: Path of the file, which need not exist.
        root: Folder that all files it names must be inside.
        file: Name for messages.

    Raises:
        GltfError: it is damaged, or is another version.
    """
    if path.suffix.lower() in (".glb", ".vrm") and data[:4] != _MAGIC and data.lstrip()[:1] != b"{":
        raise SceneError(Issue(file, "", "is not a GLB: it does not begin with glTF", "export it again as binary glTF"))
    text, binary = _chunks(data, file) if data[:4] == _MAGIC else (data, None)
    document, issues = parse_json(text, file)
    if issues:  # values that cannot be represented
        raise SceneError(issues)
    if not isinstance(document, dict):
        raise SceneError(Issue(file, "", "must be an object"))
    source = GltfSource(path, file, root, document, binary, files=[path.resolve()])
    _check_version(source)
    return source


def _chunks(data: bytes, file: str) -> tuple[bytes, bytes | None]:
    """Return the JSON and binary chunk of a GLB."""

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
            fail(f"chunk {len(chunks)} declares {size} bytes, {length - offset - 8} are left")
        chunks.append((kind, data[offset + 8 : offset + 8 + size]))
        offset += 8 + size
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        fail("its first chunk is not JSON")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BINARY_CHUNK else None
    return chunks[0][1], binary


def _check_version(source: GltfSource) -> None:
    asset = source.json.get("asset")
    if not isinstance(asset, dict):
        source.fail("/asset", "is missing: this is not a glTF file")
    for key in ("version", "minVersion"):
        version = asset.get(key, "2.0")
        if not isinstance(version, str) or version.partition(".")[0] != "2":
            source.fail(f"/asset/{key}", f"{version!r:.40} is not read; only glTF 2")
