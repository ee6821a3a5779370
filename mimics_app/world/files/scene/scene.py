"""Scene: the decoded and checked content of scene files, with the origin of each value."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Hashable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, TypeVar, cast, overload

import msgspec

from mimics_app.contracts.errors import Issue, SceneError, nearest
from mimics_app.contracts.ports.methods import Settings
from mimics_app.world.components.checked_scene import AssetKind
from mimics_app.world.components.registry import component_types
from mimics_app.world.components.visible import MeshComponent
from mimics_app.world.content.materials.material import Material
from mimics_app.world.content.materials.technique import TechniqueSpec
from mimics_app.world.files.gltf.file import GltfDocument
from mimics_app.world.files.reading.paths import PathFault, find_file
from mimics_app.world.files.reading.provenance import Origins
from mimics_app.world.files.scene.assets import SceneAsset, find_in_model
from mimics_app.world.files.scene.spec import TransformSpec

__all__ = ["Scene", "SceneEdit", "SceneEntity"]


class SceneEdit(Protocol):
    """Change of a resolved scene for the person who plays."""

    def __call__(self, document: dict[str, Any]) -> dict[str, Any]:
        """Return a changed copy of a resolved scene, as plain JSON; new entities come last.

        Raises:
            UsageError: It cannot be changed in this way.
        """
        ...

    def files(self) -> Mapping[str, Path]:
        """Return files of the person's own in place of assets of the scene, by id."""
        ...


_QUATERNION_TOLERANCE = 1e-3
"""Largest deviation of a quaternion's length from 1: four decimals pass, a mistyped number does not."""

S = TypeVar("S", bound=msgspec.Struct)
D = TypeVar("D")


@dataclass(frozen=True, eq=False)
class SceneEntity:
    """One entity of a scene.

    Attributes:
        id: Unique in the scene; inside a prefab or model "instance/child".
        parent: Id of the entity it moves with, or None.
        transform: Relative to the parent.
        components: Components by type.
        pointer: JSON pointer in the resolved document.
        in_model: True for a node of a model, which is created with the model.
    """

    id: str
    parent: str | None
    transform: TransformSpec
    components: dict[str, msgspec.Struct]
    pointer: str
    in_model: bool = False


@dataclass(frozen=True, slots=True)
class _Derived:
    """A derived value, its source (None: the scene as a whole), and the component types that `make` read."""

    made: object
    source: object
    used: set[str]


@dataclass(eq=False)
class Scene:
    """Content of a scene file and all it includes.

    Attributes:
        name: Short name.
        path: The scene file.
        root: Folder that contains all its files.
        document: The whole scene as one plain JSON object, includes and prefabs resolved.
        title, description, picture: Shown by the launcher; `picture` is an image file, or None.
        scenario: Name of the scenario that runs it.
        device: Name of the device whose entities it has, see `devices`; "": its own.
        devices: Names of the devices for which its files have other entities.
        hash: SHA-256 of `document` and of every asset's bytes, in hexadecimal.
        entities: Entities in the order of the files.
        materials: Materials by id; their textures are asset ids.
        techniques: The scene's own, by id.
        assets: Assets by id.
        systems: Settings of the stages, decoded, by name.
        task: The task as plain JSON, {} where there is none.
        sections: Registered sections, decoded ("task"), by name.
        files: Every file read, the scene file first.
        sources: The scene file and all it includes, resolved.
        broken: Ids of entities with a component that could not be read; references to them are not checked further.
        named_files: Files that components name, in order of request.
        methods: Settings chosen by the planner where the files leave the choice to it, by group of methods; {} before
            it ran.
        notes: Notes on parts of models that were left out or repaired.
        edit: Change of the resolved document for the person who plays; None: none.
        read: Names of the component types whose values were requested since it was last cleared.
    """

    name: str
    path: Path
    root: Path
    document: dict[str, Any]
    origins: Origins
    title: str = ""
    description: str = ""
    scenario: str = ""
    picture: Path | None = None
    device: str = ""
    devices: tuple[str, ...] = ()
    hash: str = ""
    entities: list[SceneEntity] = field(default_factory=list)
    materials: dict[str, Material] = field(default_factory=dict)
    techniques: dict[str, TechniqueSpec] = field(default_factory=dict)
    assets: dict[str, SceneAsset] = field(default_factory=dict)
    systems: dict[str, msgspec.Struct] = field(default_factory=dict)
    task: dict[str, Any] = field(default_factory=dict)
    sections: dict[str, msgspec.Struct] = field(default_factory=dict)
    files: list[Path] = field(default_factory=list)
    sources: tuple[Path, ...] = ()
    notes: list[str] = field(default_factory=list)
    named_files: list[Path] = field(default_factory=list)
    broken: set[str] = field(default_factory=set)
    methods: dict[str, Settings] = field(default_factory=dict)
    edit: SceneEdit | None = None
    read: set[str] = field(default_factory=set)
    _derived: dict[Hashable, _Derived] = field(default_factory=dict)
    _before: dict[Hashable, _Derived] = field(default_factory=dict)
    _by_id: dict[str, SceneEntity] = field(default_factory=dict)
    _indexed: int = 0

    @property
    def file(self) -> str:
        """The scene file as the user wrote it."""
        return str(self.path)

    @overload
    def components(self, wanted: type[S]) -> list[tuple[str, S, str]]: ...

    @overload
    def components(self, wanted: str) -> list[tuple[str, Any, str]]: ...

    def components(self, wanted: type[msgspec.Struct] | str) -> list[tuple[str, Any, str]]:
        """Return (entity id, component, pointer) of every component of a type, given by its Struct or its name.

        The type is noted as used in `read`; `has` does not note it.

        Raises:
            KeyError: no component type has that name; the message names the nearest.
        """
        keys = _keys_of(wanted)
        self.read.update(keys)
        return [
            (entity.id, entity.components[key], f"{entity.pointer}/components/{key}")
            for entity in self.entities
            for key in keys
            if key in entity.components
        ]

    def has(self, wanted: type[msgspec.Struct]) -> bool:
        """True when an entity has a component of a type."""
        keys = _keys_of(wanted)
        return any(key in entity.components for entity in self.entities for key in keys)

    @property
    def unread(self) -> list[str]:
        """Component types of the scene whose values were not requested since `read` was cleared, sorted."""
        return sorted({name for entity in self.entities for name in entity.components} - self.read)

    def derive(self, key: Hashable, make: Callable[[], D], source: object = None) -> D:
        """Return a value derived from the scene, computed once: tables of objects, curves, meshes.

        The value is shared and must not be changed. Component types that `make` reads count as read by every caller.
        A reloaded scene reuses values with an equal source.

        Args:
            key: Key of the value.
            make: Computes it; an exception passes through, and nothing is stored.
            source: All inputs of `make`, as comparable values; None: unknown, so the value is never reused.
        """
        if key not in self._derived:
            before = self._before.get(key)
            if source is not None and before is not None and before.source == source:
                self._derived[key] = before
            else:
                self._derived[key] = self._computed(make, source)
        found = self._derived[key]
        self.read |= found.used
        return cast("D", found.made)

    def _computed(self, make: Callable[[], Any], source: object) -> _Derived:
        before, self.read = self.read, set()
        try:
            made = make()
        finally:
            used, self.read = self.read, before | self.read
        return _Derived(made, source, used)

    def discard_derived(self) -> None:
        """Forget what was derived, after an edit; what has an equal source is taken again."""
        self.take_over(self)
        self._derived.clear()

    def take_over(self, before: Scene) -> None:
        """Allow `derive` to reuse values of the scene that this one replaces."""
        self._before = dict(before._derived)

    def first(self, wanted: type[S]) -> S | None:
        """Return the first component of a type, None where the scene has none: `scene.first(Robot) or Robot()`."""
        found = self.components(wanted)
        return found[0][1] if found else None

    def system(self, wanted: type[S]) -> S | None:
        """Return the settings of a type among `systems`, None where the scene states none."""
        return _of_type(self.systems, wanted)

    def section(self, wanted: type[S]) -> S | None:
        """Return the section of a type, None where the scene has none."""
        return _of_type(self.sections, wanted)

    def one(self, wanted: type[S]) -> tuple[str, S, str]:
        """Return (entity id, component, pointer) of the first component of a type.

        Raises:
            SceneError: the scene has none.
        """
        found = self.components(wanted)
        if not found:
            names = [name for name, struct in component_types().items() if struct is wanted]
            raise SceneError(
                self.issue("/entities", f'no entity has a "{"".join(names)}"', "give one of them this component")
            )
        return found[0]

    def entity(self, name: str) -> SceneEntity:
        """Return an entity by id.

        Raises:
            KeyError: there is none; the message names the nearest.
        """
        found = self.by_id.get(name)
        if found is None:
            raise KeyError(f'no entity "{name}"; {nearest(name, self.by_id)}')
        return found

    @property
    def by_id(self) -> Mapping[str, SceneEntity]:
        """Entities by id; the first of several with one id."""
        if len(self.entities) != self._indexed:
            self._by_id = {entity.id: entity for entity in reversed(self.entities)}
            self._indexed = len(self.entities)
        return self._by_id

    def model_of(self, pointer: str) -> GltfDocument | None:
        """Return the model that the entity of a pointer shows; None where it is missing or broken."""
        entity = next((each for each in self.entities if pointer.startswith(f"{each.pointer}/")), None)
        mesh = None if entity is None else entity.components.get("mesh")
        if not isinstance(mesh, MeshComponent) or mesh.source is None:
            return None
        try:
            return find_in_model(self.assets, mesh.source).model
        except KeyError:
            return None

    def owner(self, pointer: str) -> SceneEntity:
        """Return the entity that contains a pointer of the resolved document."""
        return self.entities[int(pointer.split("/", 3)[2])]

    def issue(self, pointer: str, what: str, fix: str = "") -> Issue:
        """Return a fault at a pointer of the resolved document, with the file and pointer of its origin."""
        layer = self.origins.locate(pointer)
        return Issue(layer.file, layer.pointer, what, fix)

    def place(self, pointer: str) -> str:
        """Return the origin of a value of the resolved document as `file#pointer`."""
        layer = self.origins.locate(pointer)
        return f"{layer.file}#{layer.pointer}"

    def file_at(self, pointer: str, uri: str) -> Path:
        """Return the file of a URI at `pointer`, and add it to `files`.

        Raises:
            SceneError: it is missing or outside the root.
        """
        try:
            path = find_file(uri, self.origins.locate(pointer).folder, self.root)
        except PathFault as fault:
            raise SceneError(self.issue(pointer, fault.what, fault.fix)) from None
        if path not in self.files:
            self.files.append(path)
            self.named_files.append(path)
        return path

    def check_file(self, pointer: str, uri: str) -> list[Issue]:
        """Check a URI at `pointer`."""
        try:
            self.file_at(pointer, uri)
        except SceneError as error:
            return error.issues
        return []

    def check_asset(self, pointer: str, name: str | None, kind: AssetKind) -> list[Issue]:
        """Check an asset id at `pointer`; None: there is none."""
        if name is None or name not in self.assets:
            return self.check_names({pointer: name}, "no asset", self.document.get("assets", {}))
        found = self.assets[name].kind
        return [] if found == kind else [self.issue(pointer, f'asset "{name}" is a {found}, not a {kind}')]

    def check_material(self, pointer: str, name: str | None) -> list[Issue]:
        """Check a material id at `pointer`; None: there is none."""
        return self.check_names({pointer: name}, "no material", self.document.get("materials", {}))

    def check_entity(self, pointer: str, name: str | None) -> list[Issue]:
        """Check an entity id at `pointer`; None: there is none."""
        return self.check_names({pointer: name}, "no entity", self.by_id)

    def check_entity_with(self, wanted: type[msgspec.Struct], pointer: str, name: str | None) -> list[Issue]:
        """Check the id at `pointer` of an entity that must have a component of a type; None: there is none."""
        if name in self.broken:
            return []
        known = [entity for entity, _, _ in self.components(wanted)]
        types = "".join(key for key, struct in component_types().items() if struct is wanted)
        return self.check_names({pointer: name}, f'no entity with a "{types}"', known)

    def check_model_reference(self, pointer: str, reference: str) -> list[Issue]:
        """Check a reference into a model at `pointer`."""
        name = reference.partition("#")[0]
        if name not in self.assets and name in self.document.get("assets", {}):
            return []  # the fault of the model itself was reported
        faults = self.check_asset(pointer, name, "model")
        if faults:
            return faults
        try:
            find_in_model(self.assets, reference)
        except KeyError as error:
            return [self.issue(pointer, str(error.args[0]))]
        return []

    def check_rotation(self, pointer: str, rotation: tuple[float, ...] | None) -> list[Issue]:
        """Check that a quaternion at `pointer` has length 1; None: there is none."""
        if rotation is None or abs(math.hypot(*rotation) - 1.0) <= _QUATERNION_TOLERANCE:
            return []
        what = f"a quaternion of length {math.hypot(*rotation):.4g} instead of 1"
        return [self.issue(pointer, what, "write x, y, z, w of a unit quaternion")]

    def check_names(
        self, names: Mapping[str, str | None], what: str, known: Collection[str], otherwise: str = "the scene has none"
    ) -> list[Issue]:
        """Return a fault for each name that is not known.

        Args:
            names: Names by their pointers; None: there is none.
            what: Beginning of the fault, before the name: "no entity".
            known: Possible names.
            otherwise: Advice where nothing is possible.
        """
        return [
            self.issue(pointer, f'{what} "{name}"', nearest(name, known) if known else otherwise)
            for pointer, name in names.items()
            if name is not None and name not in known
        ]


def _keys_of(wanted: type[msgspec.Struct] | str) -> list[str]:
    """Return the names of a component type; raise KeyError for an unknown name."""
    names = component_types()
    if isinstance(wanted, str) and wanted not in names:
        raise KeyError(f'no component type "{wanted}"; {nearest(wanted, names)}')
    return [wanted] if isinstance(wanted, str) else [name for name, struct in names.items() if struct is wanted]


def _of_type(named: dict[str, msgspec.Struct], wanted: type[S]) -> S | None:
    return next((each for each in named.values() if isinstance(each, wanted)), None)
