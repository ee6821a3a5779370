"""A scene that is being edited: its texts, its faults, and its world, which follows each edit."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from mimics_app.app.scenes.loading import review_scene
from mimics_app.app.viewer.inspected import Cell, Row, inspected_rows, numbers_of, object_of
from mimics_app.app.viewer.resting import rest
from mimics_app.app.viewer.shown import Shown
from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.errors import Issue, MimicsError, SceneError
from mimics_app.world.files.reading.json_edit import insert_item, remove_value, set_value, source_of
from mimics_app.world.files.reading.json_spans import find_span
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.reading.provenance import merged
from mimics_app.world.files.scene.reload import apply_scene
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.files.scene.scene_texts import SceneTexts
from mimics_app.world.files.scene.world_construction import place as place_node

__all__ = ["EditedScene", "ListedEntity", "Place", "pointer_of"]

_DIGITS = 4
"""Decimals of a metre that a drag writes."""
_ENTITY = re.compile(r"/entities/([0-9]{1,9})(?:/|$)")
_HEAD = ("id", "parent", "prefab")
"""Keys of an entity in front of its transform."""


class Place(NamedTuple):
    """Where an entity is written: the file, and its number in the list there."""

    file: Path
    number: int

    @property
    def steps(self) -> list[str]:
        """Steps of its pointer."""
        return ["entities", str(self.number)]


class ListedEntity(NamedTuple):
    """An entity as a row of the list."""

    id: str
    depth: int
    place: Place


class EditedScene:
    """A scene with its unsaved edits. Whoever changes it calls `apply` afterwards.

    Args:
        shown: The scene in the viewer; its scene and world follow the edits.

    Attributes:
        texts: Texts of the scene's files, with the history.
        faults: What `mimics check` would report on the present texts.
        stale: Whether the texts were not read and checked yet.
    """

    def __init__(self, shown: Shown) -> None:
        self._shown = shown
        self.texts = SceneTexts(self.scene.sources)
        self.faults: list[Issue] = []
        self.stale = False
        self._dragged: set[str] = set()

    @property
    def scene(self) -> Scene:
        """The last scene without a fault of its files, which the world shows."""
        assert self._shown.scene is not None
        return self._shown.scene

    @property
    def entities(self) -> list[ListedEntity]:
        """The entities that the files have, each below the one that it moves with."""
        listed: list[tuple[str, str, Place]] = []
        for file in self.texts.files:
            entities = self.texts.document(file).get("entities")
            for number, each in enumerate(entities if isinstance(entities, list) else []):
                if isinstance(each, dict):
                    listed.append((str(each.get("id", "")), str(each.get("parent") or ""), Place(file, number)))
        known = {name for name, _, _ in listed}
        below: dict[str, list[tuple[str, Place]]] = {}
        for name, parent, place in listed:
            below.setdefault(parent if parent in known else "", []).append((name, place))
        rows: list[ListedEntity] = []
        waiting = [(name, place, 0) for name, place in reversed(below.pop("", []))]
        while waiting:
            name, place, depth = waiting.pop()
            rows.append(ListedEntity(name, depth, place))
            waiting += [(child, where, depth + 1) for child, where in reversed(below.pop(name, []))]
        circular = [(name, place) for each in below.values() for name, place in each]
        return rows + [ListedEntity(name, 0, place) for name, place in circular]

    def find(self, name: str) -> Place | None:
        """Return where an entity is written, None where none of the files has it."""
        return next((row.place for row in self.entities if row.id == name), None)

    def plain(self, place: Place) -> dict[str, Any]:
        """Return an entity as its file has it; it must not be changed."""
        entity: dict[str, Any] = self.texts.document(place.file)["entities"][place.number]
        return entity

    def prefabs(self, file: Path) -> list[str]:
        """Return the prefabs of a file."""
        return list(object_of(self.texts.document(file).get("prefabs")))

    def rows(self, place: Place) -> list[Row]:
        """Return what can be changed of an entity."""
        own, scene = self.plain(place), self.scene
        found: dict[str, Any] = next((each for each in scene.document["entities"] if each["id"] == own.get("id")), {})
        present = {key: merged(found.get(key) or {}, own.get(key) or {}) for key in ("transform", "components")}
        names = {
            ("parent",): [row.id for row in self.entities if row.id != own.get("id")],
            ("prefab",): self.prefabs(place.file),
            ("components", "mesh", "material"): list(scene.document.get("materials", {})),
            ("components", "mesh", "source"): [name for name, each in scene.assets.items() if each.kind == "model"],
        }
        return inspected_rows(own, present, names)

    def faults_of(self, place: Place) -> list[tuple[str, Issue]]:
        """Return the faults inside an entity, each with its pointer below it."""
        head = f"/entities/{place.number}/"
        found = [(f"{issue.pointer}/", issue) for issue in self.faults if Path(issue.file).resolve() == place.file]
        return [(pointer[len(head) : -1], issue) for pointer, issue in found if pointer.startswith(head)]

    def place_of(self, issue: Issue) -> Place | None:
        """Return the entity that a fault is in, None where it is in another part of the scene."""
        found, file = _ENTITY.match(issue.pointer), Path(issue.file).resolve()
        if found is None or file not in self.texts.files:
            return None
        entities = self.texts.document(file).get("entities")
        inside = isinstance(entities, list) and int(found[1]) < len(entities)
        return Place(file, int(found[1])) if inside else None

    def set(self, place: Place, cell: Cell, typed: str, *, merge: bool = False) -> None:
        """Set a value to what was typed.

        Raises:
            ValueError: See `Cell.written`.
        """
        steps, source = cell.written(typed)
        if source is None:
            self.remove(place, steps)
            return
        text = set_value(self.texts.text(place.file), [*place.steps, *steps], source, _after(steps))
        name = str(self.plain(place).get("id", ""))
        texts = {place.file: text}
        if steps == ("id",):
            texts = self._with_children(texts, name, source)
        self._change(f"{name}: {'.'.join(steps)}", texts, merge=merge)

    def put(self, place: Place, steps: Sequence[str], source: str) -> None:
        """Set a value, given as JSON, that no row has yet."""
        text = _with_object(self.texts.text(place.file), place.steps, self.plain(place), steps[0])
        text = set_value(text, [*place.steps, *steps], source)
        self._change(f"{self.plain(place).get('id', '')}: {'.'.join(steps)} added", {place.file: text})

    def remove(self, place: Place, steps: Sequence[str]) -> None:
        """Remove a value from the file, so that its default, or that of the prefab, counts; what is not there stays."""
        path = [*place.steps, *steps]
        text = self.texts.text(place.file)
        if steps != ("id",) and find_span(text, path) is not None:
            name = self.plain(place).get("id", "")
            self._change(f"{name}: {'.'.join(steps)} removed", {place.file: remove_value(text, path)})

    def move(self, name: str, position: Vec3) -> None:
        """Set the translation of an entity."""
        place = self.find(name)
        self._dragged.add(name)
        if place is not None:
            numbers = source_of([round(float(value), _DIGITS) + 0.0 for value in position])
            text = _with_object(self.texts.text(place.file), place.steps, self.plain(place), "transform")
            text = set_value(text, [*place.steps, "transform", "translation"], numbers, _HEAD)
            self._change(f"{name}: moved to {numbers}", {place.file: text})

    def add(self, entity: dict[str, Any]) -> str:
        """Add an entity at the end of the scene file; return its id, which is made unique."""
        file = self.texts.files[0]
        entity = {**entity, "id": self._free_id(str(entity["id"]))}
        entities = self.texts.document(file).get("entities")
        text = self.texts.text(file)
        if isinstance(entities, list):
            text = insert_item(text, ["entities"], len(entities), source_of(entity))
        else:
            text = set_value(text, ["entities"], source_of([entity]))
        self._change(f"{entity['id']} added", {file: text})
        return str(entity["id"])

    def duplicate(self, place: Place, offset: Vec3) -> str:
        """Put a copy of an entity behind it, as it is written, moved by an offset; return the id of the copy."""
        text = self.texts.text(place.file)
        span = find_span(text, place.steps)
        assert span is not None
        own = self.plain(place)
        name = self._free_id(str(own.get("id", "entity")))
        before = numbers_of(object_of(own.get("transform")).get("translation"), (0.0, 0.0, 0.0))
        moved = [round(float(a) + b, _DIGITS) for a, b in zip(before, offset, strict=True)]
        copy = _with_object(text[slice(*span)], [], own, "transform")
        copy = set_value(copy, ["id"], source_of(name))
        copy = set_value(copy, ["transform", "translation"], source_of(moved), _HEAD)
        self._change(f"{name} added", {place.file: insert_item(text, ["entities"], place.number + 1, copy)})
        return name

    def delete(self, place: Place) -> int:
        """Delete an entity with all that move with it; return how many they were."""
        rows = self.entities
        first = next(number for number, row in enumerate(rows) if row.place == place)
        last = first + 1
        while last < len(rows) and rows[last].depth > rows[first].depth:
            last += 1
        texts: dict[Path, str] = {}
        for row in sorted(rows[first:last], key=lambda each: -each.place.number):  # numbers in front of it stay
            text = texts.get(row.place.file, self.texts.text(row.place.file))
            texts[row.place.file] = remove_value(text, row.place.steps)
        self._change(f"{rows[first].id} deleted", texts)
        return last - first

    def undo(self, *, again: bool = False) -> str:
        """Undo the last step, or do it `again`; return its words, "" where there is none."""
        what = self.texts.redo() if again else self.texts.undo()
        self.stale = self.stale or bool(what)
        return what

    def read_again(self) -> None:
        """Take the files from the disk, see `SceneTexts.read_again`; then `apply`.

        Raises:
            SceneError: One cannot be read; the present texts stay.
        """
        self.texts.read_again()
        self.stale = True

    def save_as(self, path: Path) -> None:
        """Write the scene under a new name, which it has from now on.

        Raises:
            SceneError: It exists, cannot be written, or the scene would have faults there, as other includes.
        """
        data = self.texts.text(self.texts.files[0]).encode()
        scene, faults = review_scene(path, self.scene, {**self.texts.unsaved, path.resolve(): data})
        if scene is None and not self.faults:
            raise SceneError(faults)
        self.texts.save_as(path.resolve())
        self._shown.path = path
        self.stale = True

    def apply(self) -> None:
        """Read and check the texts; where the files are right, show them."""
        self.stale = False
        scene, self.faults = review_scene(self._shown.path, self.scene, self.texts.unsaved)
        if scene is None:
            return
        shown = self._shown
        self.texts.follow(scene.sources)
        apply_scene(shown.world, self.scene, scene)
        for name in self._dragged & scene.by_id.keys():  # also where an undone drag leaves the texts as they were
            place_node(shown.world.find(name), scene.entity(name).transform)
        self._dragged.clear()
        shown.scene = scene
        try:
            if not self.faults:
                rest(scene, shown.world)
        except MimicsError as error:
            self.faults = error.issues
        shown.world.update()
        shown.files, shown.notes = list(scene.files), list(scene.notes)

    def _change(self, what: str, texts: dict[Path, str], *, merge: bool = False) -> None:
        self.stale = self.texts.change(what, texts, merge=merge) or self.stale

    def _with_children(self, texts: dict[Path, str], old: str, new: str) -> dict[Path, str]:
        """Name the new id, as JSON, in everything that moves with an entity."""
        for row in self.entities:
            if self.plain(row.place).get("parent") == old:
                text = texts.get(row.place.file, self.texts.text(row.place.file))
                texts[row.place.file] = set_value(text, [*row.place.steps, "parent"], new)
        return texts

    def _free_id(self, wanted: str) -> str:
        """Return an id that no entity has: "box_2" where there is a "box"."""
        taken = {row.id for row in self.entities}
        base = wanted.rstrip("0123456789").rstrip("_") or "entity"
        numbers = range(2, len(taken) + 3)
        return wanted if wanted not in taken else next(name for n in numbers if (name := f"{base}_{n}") not in taken)


def _with_object(text: str, steps: Sequence[str], own: Mapping[str, Any], key: str) -> str:
    """Return the text with an object at a key of an entity; a faulty value that stands there gives way.

    Args:
        text: The text.
        steps: Steps of the entity's pointer.
        own: The entity.
        key: The key.
    """
    there = own.get(key)
    return text if there is None or isinstance(there, Mapping) else set_value(text, [*steps, key], "{}")


def _after(steps: Sequence[str]) -> Sequence[str]:
    """Return the keys behind which a new key of an entity is written."""
    return _HEAD if steps[0] in (*_HEAD, "transform") else ()


def pointer_of(steps: Sequence[str]) -> str:
    """Return steps as the rest of a JSON pointer, without its first stroke."""
    return "/".join(escape(step) for step in steps)
