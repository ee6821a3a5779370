"""Resolution of a scene's files to one document: includes merged, prefabs expanded, the origin of every value kept."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from mimics_app.contracts.errors import Issue, SceneError, nearest
from mimics_app.world.components.registry import section_of
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.reading.provenance import Layer, Origins, merged
from mimics_app.world.files.reading.struct_reader import is_comment
from mimics_app.world.files.scene.scene_files import SceneSource
from mimics_app.world.files.scene.spec import MAX_ENTITIES

__all__ = ["EntityDraft", "SceneDocument", "resolve"]

_ID = re.compile(r"[A-Za-z0-9_.-]+")

_MAX_NESTING = 32
"""Maximum nesting of prefabs."""

_TABLES = ("assets", "materials", "techniques", "prefabs")


@dataclass(eq=False)
class EntityDraft:
    """An entity before its components are decoded.

    Attributes:
        id: Full id; inside a prefab "instance/child".
        parent: Full id, or None.
        layers: Its sources, strongest first.
        overrides: Changes of descendants that no prefab consumed, meant for nodes of a model; by path.
        in_model: True for a node of a model, made with the model.
    """

    id: str
    parent: str | None
    layers: list[Layer]
    overrides: dict[str, Layer] = field(default_factory=dict)
    in_model: bool = False

    def part(self, key: str) -> dict[str, Any]:
        """Return `transform` or `components`, all layers merged."""
        values = [_dict(layer.value.get(key)) for layer in reversed(self.layers)]
        result: dict[str, Any] = values[0] if len(values) == 1 and None not in values[0].values() else {}
        for value in values if not result else ():
            result = merged(result, value)
        return result

    def mentions(self, component: str) -> bool:
        """True when a layer has a component."""
        return any(component in _dict(layer.value.get("components")) for layer in self.layers)


@dataclass(eq=False)
class SceneDocument:
    """A scene as one document, still plain JSON.

    Attributes:
        origins: File and pointer of each value.
        tables: `assets`, `materials`, `techniques`, `prefabs`: layer of each item, by id.
        entities: Entities in the order of the files, prefabs expanded.
        sections: `systems` item by item ("systems/NAME"), `task` and other registered sections: layer of each.
    """

    origins: Origins
    tables: dict[str, dict[str, Layer]]
    entities: list[EntityDraft]
    sections: dict[str, Layer]

    def add(self, draft: EntityDraft) -> str:
        """Append an entity and return its pointer."""
        pointer = f"/entities/{len(self.entities)}"
        self.entities.append(draft)
        self.origins.set(pointer, draft.layers)
        return pointer


def resolve(sources: list[SceneSource], issues: list[Issue], device: str = "") -> SceneDocument:
    """Merge the files of a scene, the first one strongest.

    Args:
        sources: From `source.read_sources`; faults of shape were reported there and are skipped here.
        issues: Receives ids defined twice, unknown prefabs and prefabs that contain themselves.
        device: Name of the device that plays; entities that the files give for it replace those of the same id.

    Raises:
        SceneError: there are more entities than a scene may have.
    """
    document = SceneDocument(Origins(sources[0].layer), {name: {} for name in _TABLES}, [], {})
    for source in sources:
        for name in _TABLES:
            _join_table(document, name, source.layer, issues)
        _join_sections(document, source.layer)
    unfolding = _Unfolding(document, issues, whole=sources[0].whole)
    instead = [layer for source in sources for layer in _entities_for(device, source)]
    replaced = {layer.value["id"] for layer in instead}
    for source in sources:
        for layer in _entities_at("entities", source.document.get("entities"), source):
            if layer.value["id"] not in replaced:
                unfolding.unfold(layer)
    for layer in instead:
        unfolding.unfold(layer)
    return document


def _entities_for(device: str, source: SceneSource) -> Iterator[Layer]:
    """Yield the entities that a file has for a device."""
    given = _dict(source.document.get("devices")).get(device)
    yield from _entities_at(f"devices/{escape(device)}", given, source)


def _entities_at(pointer: str, values: object, source: SceneSource) -> Iterator[Layer]:
    for i, value in enumerate(_list(values)):
        if isinstance(value, dict) and isinstance(value.get("id"), str):
            yield source.layer.child(f"{pointer}/{i}", value)


def _join_table(document: SceneDocument, name: str, layer: Layer, issues: list[Issue]) -> None:
    table = document.tables[name]
    for key, value in _dict(layer.value.get(name)).items():
        item = layer.child(f"{name}/{escape(key)}", value)
        if key in table:
            what = f'"{key}" is defined already, in {table[key].file}#{table[key].pointer}'
            issues.append(Issue(item.file, item.pointer, what, "choose another id"))
            continue
        table[key] = item
        document.origins.set(f"/{name}/{escape(key)}", [item])


def _join_sections(document: SceneDocument, layer: Layer) -> None:
    parts = [(f"systems/{escape(key)}", value) for key, value in _dict(layer.value.get("systems")).items()]
    parts += [(key, value) for key, value in layer.value.items() if key == "task" or section_of(key)]
    for pointer, value in parts:
        if isinstance(value, dict) and pointer not in document.sections:
            document.sections[pointer] = layer.child(pointer, value)
            document.origins.set(f"/{pointer}", [document.sections[pointer]])


class _Unfolding:
    """Expansion of entities and the prefabs they are instances of."""

    def __init__(self, document: SceneDocument, issues: list[Issue], *, whole: bool) -> None:
        self._document = document
        self._issues = issues
        self._whole = whole

    def unfold(self, layer: Layer) -> None:
        """Add a top-level entity and the children of its prefab."""
        parent = layer.value.get("parent")
        self._instance(layer, layer.value["id"], parent if isinstance(parent, str) else None, {}, ())

    def _instance(
        self, own: Layer, name: str, parent: str | None, above: dict[str, Layer], inside: tuple[str, ...]
    ) -> None:
        """Add one entity.

        Args:
            own: Its layer.
            name: Its full id.
            parent: Full id of its parent.
            above: Overrides of outer instances, by path from here ("" is this entity).
            inside: Prefabs being expanded.
        """
        if len(self._document.entities) >= MAX_ENTITIES:
            raise SceneError(Issue(own.file, own.pointer, f"more than {MAX_ENTITIES} entities, prefabs expanded"))
        if not _ID.fullmatch(own.value["id"]):
            what = f'"{own.value["id"]}" is not an id'
            self._issues.append(Issue(own.file, f"{own.pointer}/id", what, "use letters, digits, _ - and ."))
        bodies = list(self._bodies(own, inside))
        overrides = {
            path: own.child(f"overrides/{escape(path)}", value)
            for path, value in _dict(own.value.get("overrides")).items()
            if isinstance(value, dict)
        } | {path: layer for path, layer in above.items() if path}
        strongest = [above[""]] if "" in above else []
        draft = EntityDraft(name, parent, strongest + [layer for layer, _ in bodies], overrides)
        self._document.add(draft)
        for layer, prefabs in bodies[1:]:
            for i, value in enumerate(_list(layer.value.get("children"))):
                if isinstance(value, dict) and isinstance(value.get("id"), str):
                    self._child(layer.child(f"children/{i}", value), draft, prefabs)

    def _child(self, layer: Layer, instance: EntityDraft, inside: tuple[str, ...]) -> None:
        step = layer.value["id"]
        beside = layer.value.get("parent")
        parent = f"{instance.id}/{beside}" if isinstance(beside, str) else instance.id
        above = {}
        for path in list(instance.overrides):
            if path == step or path.startswith(f"{step}/"):
                above[path[len(step) + 1 :]] = instance.overrides.pop(path)
        self._instance(layer, f"{instance.id}/{step}", parent, above, inside)

    def _bodies(self, own: Layer, inside: tuple[str, ...]) -> Iterator[tuple[Layer, tuple[str, ...]]]:
        """Yield the entity itself, its prefab, the base of that one, and so on, each with its chain of prefabs."""
        yield own, inside
        layer = own
        while isinstance(name := layer.value.get("prefab"), str):
            place = layer.child("prefab", None)
            known = self._document.tables["prefabs"]
            if name not in known and not self._whole:
                return
            if name not in known:
                hint = nearest(name, known) if known else "the scene has no prefabs"
                self._issues.append(Issue(place.file, place.pointer, f'no prefab "{name}"', hint))
                return
            if name in inside:
                chain = " -> ".join((*inside[inside.index(name) :], name))
                self._issues.append(Issue(place.file, place.pointer, f"the prefab contains itself: {chain}"))
                return
            if len(inside) >= _MAX_NESTING:
                self._issues.append(Issue(place.file, place.pointer, f"more than {_MAX_NESTING} prefabs in each other"))
                return
            inside = (*inside, name)
            layer = known[name]
            if not isinstance(layer.value, dict):
                return
            yield layer, inside


def _dict(value: object) -> dict[str, Any]:
    return {key: item for key, item in value.items() if not is_comment(key)} if isinstance(value, dict) else {}


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []
