"""Reader of glTF 2.0 files, which validates all their content.

GLB and .gltf, data URIs and files beside it, sparse and strided accessors, normalised integers, metallic-roughness
materials, cameras, lights, sounds, skins, clips, morph targets, and components in `extras.mimics`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.contracts.errors import nearest
from mimics_app.contracts.system.regular_file import Stamp
from mimics_app.world.content.materials.material import Material, TextureData
from mimics_app.world.files.gltf.accessors import GltfAccessors
from mimics_app.world.files.gltf.buffers import GltfBuffers
from mimics_app.world.files.gltf.gltf_document import GltfError, GltfSource, open_gltf
from mimics_app.world.files.gltf.images import GltfImages
from mimics_app.world.files.gltf.materials import GltfMaterials
from mimics_app.world.files.gltf.meshes import GltfMesh, GltfMeshes
from mimics_app.world.files.gltf.nodes import GltfCamera, GltfLight, GltfNode, GltfNodes
from mimics_app.world.files.gltf.references import check_references
from mimics_app.world.files.gltf.sounds import GltfSounds, read_sounds


def read_bones(source: GltfSource) -> dict[str, int]:
    """Return the node of each bone in the file's own table, by VRM 1.0 name; empty for a file that has none.

    Faults are collected.
    """
    newer = source.extension(source.json, "VRMC_vrm", "")
    older = source.extension(source.json, "VRM", "")
    with source.collecting():
        if newer:
            return _newer(source, newer, "/extensions/VRMC_vrm")
        if older:
            return _older(source, older, "/extensions/VRM")
    return {}


def _newer(source: GltfSource, extension: dict[str, Any], place: str) -> dict[str, int]:
    humanoid, place = source.object(extension, "humanoid", place), f"{place}/humanoid"
    bones, place = source.object(humanoid, "humanBones", place), f"{place}/humanBones"
    return {name: _node(source, source.object(bones, name, place), f"{place}/{name}") for name in bones}


def _older(source: GltfSource, extension: dict[str, Any], place: str) -> dict[str, int]:
    humanoid, place = source.object(extension, "humanoid", place), f"{place}/humanoid"
    found = dict[str, int]()
    for i, item in enumerate(source.list(humanoid, "humanBones", place)):
        here = f"{place}/humanBones/{i}"
        if not isinstance(item, dict):
            source.fail(here, "must be an object")
        found[source.text(item, "bone", here)] = _node(source, item, here)
    return found


def _node(source: GltfSource, item: dict[str, Any], place: str) -> int:
    return source.index(item.get("node"), len(source.table("nodes")), "nodes", f"{place}/node")


if TYPE_CHECKING:
    from mimics_app.world.content.motion.clip import Clip
    from mimics_app.world.files.gltf.skins import GltfSkin

__all__ = ["GltfDocument", "GltfError", "load_gltf"]

_SUPPORTED_EXTENSIONS = frozenset(
    {
        "EXT_mesh_gpu_instancing",
        "KHR_audio_emitter",
        "KHR_lights_punctual",
        "KHR_materials_emissive_strength",
        "KHR_materials_unlit",
        "KHR_mesh_quantization",
        "KHR_node_visibility",
        "KHR_texture_transform",
        "MSFT_lod",
        "VRM",
        "VRMC_vrm",
    }
)
"""Extensions a file may require."""


@dataclass(frozen=True, eq=False)
class GltfDocument:
    """Content of a valid file.

    Attributes:
        file: Name in messages.
        nodes: In file order; indices elsewhere refer to it.
        roots: Root nodes of its default scene.
        meshes: In file order; a node's `mesh` is an index.
        materials: In file order, names unique; `base_texture` is a key of `textures`.
        textures: Textures that the materials use.
        cameras: In file order; None for one of an unsupported type.
        lights: In file order.
        skins: In file order; a node's `skin` is an index.
        clips: Its animations, in file order; their targets are nodes.
        sounds: Sounds of KHR_audio_emitter; None where the file has none.
        bones: Node of each bone of a person in the table of a VRM file, by VRM 1.0 name.
        raw: The whole JSON, extensions included.
        notes: Notes on content that was left out or repaired.
        files: Every file read, its own first.
        stamps: State of each of the others before it was read, see `stamp_of`.
    """

    file: str
    nodes: list[GltfNode]
    roots: list[int]
    meshes: list[GltfMesh]
    materials: list[Material]
    textures: dict[str, TextureData]
    cameras: list[GltfCamera | None]
    lights: list[GltfLight | None]
    skins: list[GltfSkin]
    clips: list[Clip]
    sounds: GltfSounds | None
    bones: dict[str, int]
    raw: dict[str, Any]
    notes: list[str]
    files: list[Path]
    stamps: dict[Path, Stamp | None]

    @cached_property
    def _node_names(self) -> dict[str, list[int]]:
        return _by_name([node.name for node in self.nodes])

    @cached_property
    def _mesh_names(self) -> dict[str, list[int]]:
        return _by_name([mesh.name for mesh in self.meshes])

    def find_node(self, name: str) -> int:
        """Return the index of a node by name.

        Raises:
            KeyError: there is none (the message names the nearest), or there are several.
        """
        return _find(name, self._node_names, "node")

    def find_mesh(self, name: str) -> int:
        """Return the index of a mesh by name.

        Raises:
            KeyError: there is none (the message names the nearest), or there are several.
        """
        return _find(name, self._mesh_names, "mesh")

    @property
    def moves(self) -> bool:
        """True when the model has clips, skins or morph targets."""
        return bool(self.clips or self.skins or any(mesh.morphs for mesh in self.meshes))

    def bends(self, index: int) -> bool:
        """True when the mesh of a node is skinned or has morph targets."""
        node = self.nodes[index]
        if node.mesh is None:
            return False
        parts = [part.mesh for part in self.meshes[node.mesh].primitives]
        return any(mesh.morphs or (node.skin is not None and mesh.weights is not None) for mesh in parts)

    def subtree(self, index: int) -> Iterator[int]:
        """Yield the indices of a subtree, parents first."""
        waiting = [index]
        while waiting:
            node = waiting.pop()
            yield node
            waiting += reversed(self.nodes[node].children)


def load_gltf(path: Path, root: Path | None = None, *, without_pictures: bool = False) -> GltfDocument:
    """Read a .glb, .gltf or .vrm file.

    Args:
        path: The file.
        root: Folder that all files it names must be inside; default: its own folder. No URL is opened.
        without_pictures: True notes a missing or broken image file instead of refusing the model.

    Raises:
        GltfError: every fault found, each with file, JSON pointer and reason.
    """
    source = open_gltf(path, path.parent if root is None else root, str(path))
    source.without_pictures = without_pictures
    try:
        return _read(source)
    except GltfError as error:
        for issue in error.issues:
            source.report(issue)
        raise GltfError(source.issues) from None


def _read(source: GltfSource) -> GltfDocument:
    with source.collecting():
        _check_extensions(source)
    check_references(source)
    buffers = GltfBuffers(source)
    images = GltfImages(source, buffers)
    materials = GltfMaterials(source, images).read_all()
    images.check_files()
    accessors = GltfAccessors(source, buffers)
    meshes = GltfMeshes(source, accessors, materials).read_all()
    tree = GltfNodes(source, [mesh.farthest for mesh in meshes], [mesh.morphs for mesh in meshes])
    tree.read_all()
    _expand_instances(source, accessors, tree.nodes)
    roots = tree.roots()
    skins, clips = (
        _read_skins(source, accessors, tree.nodes, meshes),
        _read_clips(source, accessors, tree.nodes, meshes),
    )
    sounds = read_sounds(source, buffers)
    bones = _read_bones(source)
    if source.issues:
        raise GltfError(source.issues)
    roots = _turn_to_front(source, tree.nodes, roots, skins, bones)
    _note_names(source, tree.nodes)
    return GltfDocument(
        source.file,
        tree.nodes,
        roots,
        meshes,
        [item.material for item in materials],
        images.textures,
        tree.cameras,
        tree.lights,
        skins,
        clips,
        sounds,
        bones,
        source.json,
        source.notes,
        list(dict.fromkeys(source.files)),
        source.stamps,
    )


def _read_skins(
    source: GltfSource, accessors: GltfAccessors, nodes: list[GltfNode], meshes: list[GltfMesh]
) -> list[GltfSkin]:
    if not source.table("skins"):
        return []
    from mimics_app.world.files.gltf.skins import GltfSkins, check_bound_nodes

    skins = GltfSkins(source, accessors).read_all()
    check_bound_nodes(source, nodes, meshes, skins)
    return skins


def _read_clips(
    source: GltfSource, accessors: GltfAccessors, nodes: list[GltfNode], meshes: list[GltfMesh]
) -> list[Clip]:
    if not source.table("animations"):
        return []
    from mimics_app.world.files.gltf.clips import GltfClips

    return GltfClips(source, accessors, nodes, meshes).read_all()


def _expand_instances(source: GltfSource, accessors: GltfAccessors, nodes: list[GltfNode]) -> None:
    if not any("extensions" in item for item in source.table("nodes")):
        return
    from mimics_app.world.files.gltf.instances import expand_instances

    expand_instances(source, accessors, nodes)


def _read_bones(source: GltfSource) -> dict[str, int]:
    if not source.json.get("extensions"):
        return {}

    return read_bones(source)


def _turn_to_front(
    source: GltfSource, nodes: list[GltfNode], roots: list[int], skins: list[GltfSkin], bones: dict[str, int]
) -> list[int]:
    if not skins:
        return roots
    from mimics_app.world.files.gltf.looking_ahead import turn_to_front

    roots, way = turn_to_front(nodes, roots, skins, bones)
    if way:
        source.note(f"the person looks along {way} in the file and is turned round to look along +z")
    return roots


def _check_extensions(source: GltfSource) -> None:
    for i, name in enumerate(source.list(source.json, "extensionsRequired", "")):
        if not isinstance(name, str) or name not in _SUPPORTED_EXTENSIONS:
            source.fail(f"/extensionsRequired/{i}", f"{name!r:.60} is required and not supported")
    used = source.list(source.json, "extensionsUsed", "")
    for i, name in enumerate(used):
        if not isinstance(name, str):
            source.fail(f"/extensionsUsed/{i}", f"{name!r:.60} must be a text")
    ignored = [name for name in used if name not in _SUPPORTED_EXTENSIONS]
    if ignored:
        source.note("extensions not used: " + ", ".join(ignored))


def _note_names(source: GltfSource, nodes: list[GltfNode]) -> None:
    counts = Counter(node.name for node in nodes if node.name)
    twice = sorted(name for name, count in counts.items() if count > 1)
    if twice:
        source.note("several nodes have the same name and cannot be referred to: " + ", ".join(twice))


def _by_name(names: list[str]) -> dict[str, list[int]]:
    """Return the indices of each name."""
    found: dict[str, list[int]] = {}
    for i, name in enumerate(names):
        found.setdefault(name, []).append(i)
    return found


def _find(name: str, names: dict[str, list[int]], what: str) -> int:
    found = names.get(name, [])
    if len(found) == 1:
        return found[0]
    if found:
        raise KeyError(f'{len(found)} {what}s are named "{name}"; give them different names')
    known = [each for each in names if each]
    hint = nearest(name, known) if known else f"its {what}s have no names"
    raise KeyError(f'no {what} "{name}"; {hint}')
