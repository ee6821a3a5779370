"""SceneLoader: decodes the resolved document of a scene."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec

from mimics_app.contracts.errors import MOST_SOUGHT, Issue, SceneError, nearest
from mimics_app.world.components.plugins import fault_of_plugin
from mimics_app.world.components.registry import component_types, section_of, system_types
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.reading.paths import PathFault, find_file
from mimics_app.world.files.reading.struct_reader import FAILED, is_comment, read_struct
from mimics_app.world.files.scene.assets import read_asset, sounds_of_model
from mimics_app.world.files.scene.document import EntityDraft, SceneDocument, resolve
from mimics_app.world.files.scene.materials import edit_materials, load_materials, load_techniques
from mimics_app.world.files.scene.scene import Scene, SceneEdit, SceneEntity
from mimics_app.world.files.scene.scene_files import SceneSource
from mimics_app.world.files.scene.spec import TransformSpec
from mimics_app.world.files.scene.unfolding import unfold_model

__all__ = ["SceneLoader"]


class SceneLoader:
    """Decoder of a resolved document; every fault goes to `issues` with its place in the files."""

    def __init__(
        self,
        sources: list[SceneSource],
        root: Path,
        issues: list[Issue],
        device: str = "",
        edit: SceneEdit | None = None,
    ) -> None:
        self._sources = sources
        self._issues = issues
        self._device = device
        self._document: SceneDocument = resolve(sources, issues, device)
        main = sources[0]
        self._scene = Scene(_text(main, "name") or main.path.stem, main.path, root, {}, self._document.origins)
        self._scene.edit = edit
        self.unedited: Exception | None = None

    def load(self) -> Scene:
        """Decode the scene, or stop after `MOST_SOUGHT` faults."""
        scene, main = self._scene, self._sources[0]
        scene.title = _text(main, "title") or scene.name.replace("_", " ")
        scene.description = _text(main, "description")
        scene.scenario = _text(main, "scenario") or scene.name
        scene.device = self._device
        scene.devices = tuple(dict.fromkeys(name for each in self._sources for name in _named_devices(each)))
        scene.sources = tuple(source.path.resolve() for source in self._sources)
        scene.files = list(scene.sources)
        self._load_assets()
        load_techniques(scene, self._document, self._issues)
        load_materials(scene, self._document, self._issues)
        for draft in list(self._document.entities):
            unfold_model(draft, self._document, scene.assets, self._issues)
        scene.document = self._resolved(main)
        if scene.edit is not None and not self._issues:
            self._edit(scene.edit, main)
        for i, draft in enumerate(self._document.entities):
            if len(self._issues) >= MOST_SOUGHT:
                return scene
            scene.entities.append(self._entity(draft, scene.document["entities"][i], f"/entities/{i}"))
        self._load_sections()
        self._check_picture(main)
        return scene

    def _edit(self, edit: SceneEdit, main: SceneSource) -> None:
        """Change the resolved scene for the person who plays; a faulty one stays, and its checks say why."""
        scene = self._scene
        before = scene.document.get("materials", {})
        try:
            scene.document = edit(scene.document)
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            self.unedited = error
            return
        edit_materials(scene, before)
        for made in scene.document["entities"][len(self._document.entities) :]:
            layer = main.layer.child("", made)
            self._document.add(EntityDraft(made["id"], made["parent"], [layer]))

    def _load_assets(self) -> None:
        own = {} if self._scene.edit is None else self._scene.edit.files()
        for name, layer in self._document.tables["assets"].items():
            try:
                asset = read_asset(name, layer, self._scene.root, own.get(name))
            except SceneError as error:
                self._issues += error.issues
                continue
            if asset is not None:
                self._scene.assets[name] = asset
                self._scene.assets |= {each.id: each for each in sounds_of_model(asset)}
                self._scene.files += [file for file in asset.files if file not in self._scene.files]
                if asset.model is not None:
                    self._scene.notes += [f"{asset.model.file}: {note}" for note in asset.model.notes]

    def _entity(self, draft: EntityDraft, plain: dict[str, Any], pointer: str) -> SceneEntity:
        types = component_types()
        transform = read_struct(TransformSpec, plain["transform"], self._report, f"{pointer}/transform")
        components: dict[str, msgspec.Struct] = {}
        for name, value in plain["components"].items():
            place = f"{pointer}/components/{escape(name)}"
            if name not in types:
                self._report(place, f'unknown component "{name}"', fault_of_plugin(name) or nearest(name, types))
                self._scene.broken.add(draft.id)
                continue
            if not isinstance(value, dict):
                continue  # reported with the file's shape
            struct = read_struct(types[name], value, self._report, place)
            if struct is FAILED:
                self._scene.broken.add(draft.id)
            else:
                components[name] = struct
        if transform is FAILED:
            transform = TransformSpec()
        return SceneEntity(draft.id, draft.parent, transform, components, pointer, draft.in_model)

    def _load_sections(self) -> None:
        scene, systems = self._scene, system_types()
        for pointer in self._document.sections:
            kind, _, name = pointer.partition("/")
            plain = scene.document["systems"][name] if kind == "systems" else scene.document[kind]
            if kind == "systems":
                if name not in systems:
                    self._report(f"/{pointer}", f'unknown system "{name}"', nearest(name, systems))
                    continue
                struct = read_struct(systems[name], plain, self._report, f"/{pointer}")
                if struct is not FAILED:
                    scene.systems[name] = struct
                continue
            if kind == "task":
                scene.task = plain
            section = section_of(kind)
            if section is not None:
                struct = read_struct(section.type, plain, self._report, f"/{kind}")
                if struct is not FAILED:
                    scene.sections[kind] = struct

    def _check_picture(self, main: SceneSource) -> None:
        picture = _text(main, "picture")
        if picture:
            try:
                self._scene.picture = find_file(picture, main.layer.folder, self._scene.root)
            except PathFault as fault:
                self._report("/picture", fault.what, fault.fix)

    def _resolved(self, main: SceneSource) -> dict[str, Any]:
        """Return the scene as one plain JSON object."""
        document = self._document
        result: dict[str, Any] = {
            key: main.document[key] for key in ("format", "version", "units", "up") if key in main.document
        }
        result |= {
            table: {name: layer.value for name, layer in document.tables[table].items()}
            for table in ("assets", "materials", "techniques")
            if table != "techniques" or document.tables[table]
        }
        result["entities"] = [
            {
                "id": draft.id,
                "parent": draft.parent,
                "transform": draft.part("transform"),
                "components": draft.part("components"),
            }
            for draft in document.entities
        ]
        result["systems"] = {}
        for pointer, layer in document.sections.items():
            kind, _, name = pointer.partition("/")
            if kind == "systems":
                result["systems"][name] = layer.value
            else:
                result[kind] = layer.value
        return result

    def _report(self, pointer: str, what: str, fix: str) -> None:
        self._issues.append(self._scene.issue(pointer, what, fix))


def _text(source: SceneSource, key: str) -> str:
    value = source.document.get(key)
    return value if isinstance(value, str) else ""


def _named_devices(source: SceneSource) -> list[str]:
    """Return the devices for which a file has entities."""
    value = source.document.get("devices")
    return [name for name in value if not is_comment(name)] if isinstance(value, dict) else []
