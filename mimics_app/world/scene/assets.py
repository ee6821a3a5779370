"""The files a scene names under `assets`: found, of a known kind, and readable."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.regular_file import open_regular, read_regular
from mimics_app.world.components.struct_reader import FAILED, read_struct
from mimics_app.world.gltf.file import GltfDocument, load_gltf
from mimics_app.world.gltf.images import PictureFault, read_picture
from mimics_app.world.materials.material import TextureData
from mimics_app.world.scene.json_text import escape
from mimics_app.world.scene.paths import PathFault, find_file
from mimics_app.world.scene.provenance import Layer
from mimics_app.world.scene.spec import AssetSpec

__all__ = [
    "AssetKind",
    "ModelPart",
    "SceneAsset",
    "find_in_model",
    "read_asset",
    "sound_of_model",
    "sounds_of_model",
]

AssetKind = Literal["model", "picture", "sound", "head", "path"]

_KINDS: dict[str, AssetKind] = {
    ".glb": "model",
    ".gltf": "model",
    ".png": "picture",
    ".jpg": "picture",
    ".jpeg": "picture",
    ".wav": "sound",
    ".ogg": "sound",
    ".flac": "sound",
    ".sofa": "head",
    ".csv": "path",
    ".json": "path",
}


@dataclass(frozen=True, eq=False)
class SceneAsset:
    """One file of the scene.

    Attributes:
        id: Its key under `assets`.
        kind: By the file name's ending.
        path: Where it is.
        model: The decoded file of a model.
        inside: Of a sound that a model holds: its number there; then `path` is the model.
        picture: The decoded file of a picture.
        files: It and every file it names in turn.
        digest: SHA-256 over the bytes of `files`.
    """

    id: str
    kind: AssetKind
    path: Path
    model: GltfDocument | None = None
    inside: int | None = None
    picture: TextureData | None = None
    files: tuple[Path, ...] = ()
    digest: str = ""


@dataclass(frozen=True, eq=False)
class ModelPart:
    """What a reference into a model means.

    Attributes:
        nodes: Top nodes of the whole model; each brings all below it.
        node: One node that is meant itself, with all below it, or None.
        mesh: One mesh, or None.
    """

    asset: SceneAsset
    model: GltfDocument
    nodes: tuple[int, ...] = ()
    node: int | None = None
    mesh: int | None = None


def read_asset(name: str, layer: Layer, root: Path) -> SceneAsset | None:
    """Find and decode one asset.

    Args:
        name: Its id.
        layer: What stands under `assets`; its shape was checked and reported already.
        root: Folder it must stay inside.

    Returns:
        The asset, or None when its shape is wrong.

    Raises:
        SceneError: the file is missing, of an unknown kind, or itself wrong (then the issues name that file).
    """
    spec = read_struct(AssetSpec, layer.value, lambda *fault: None)
    if spec is FAILED:
        return None
    place = f"{layer.pointer}/uri"
    try:
        path = find_file(spec.uri, layer.folder, root)
    except PathFault as fault:
        raise SceneError(Issue(layer.file, place, fault.what, fault.fix)) from None
    kind = _KINDS.get(path.suffix.lower())
    if kind is None:
        known = ", ".join(_KINDS)
        raise SceneError(Issue(layer.file, place, f'"{spec.uri}" is of no kind that is used', f"known: {known}"))
    if kind == "model":
        model = load_gltf(path, root if path.is_relative_to(root.resolve()) else path.parent)
        return SceneAsset(name, kind, path, model=model, files=tuple(model.files), digest=_digest(model.files))
    if kind == "picture":
        return SceneAsset(
            name, kind, path, picture=_picture(path, spec, layer.file, place), files=(path,), digest=_digest([path])
        )
    if kind == "sound" and not _begins_as_named(path):
        raise SceneError(Issue(layer.file, place, f'"{spec.uri}" is no {path.suffix[1:].upper()} file'))
    return SceneAsset(name, kind, path, files=(path,), digest=_digest([path]))


def sounds_of_model(asset: SceneAsset) -> list[SceneAsset]:
    """The sounds of a model as assets of their own, "model#/audio/0" and so on."""
    sounds = None if asset.model is None else asset.model.sounds
    return [
        SceneAsset(sound_of_model(asset.id, number), "sound", audio.path or asset.path, inside=inside)
        for number, audio in enumerate([] if sounds is None else sounds.audio)
        for inside in [number if audio.path is None else None]
    ]


def sound_of_model(name: str, number: int) -> str:
    """Id of the asset that a sound of a model is."""
    return f"{name}#/audio/{number}"


def find_in_model(assets: dict[str, SceneAsset], reference: str) -> ModelPart:
    """What "asset", "asset#/nodes/Name" or "asset#/meshes/Name" refers to.

    Raises:
        KeyError: no such model, node or mesh; the message names the nearest.
    """
    name, _, fragment = reference.partition("#")
    asset = assets.get(name)
    if asset is None or asset.model is None:
        raise KeyError(f'no model "{name}" among the assets')
    model = asset.model
    if not fragment:
        return ModelPart(asset, model, tuple(model.roots))
    _, table, item = (fragment.split("/", 2) + ["", "", ""])[:3]
    item = item.replace("~1", "/").replace("~0", "~")
    if table == "nodes":
        return ModelPart(asset, model, node=model.find_node(item))
    if table == "meshes":
        return ModelPart(asset, model, mesh=model.find_mesh(item))
    raise KeyError(f'"#{fragment}" refers to nothing; write {escape(name)}#/nodes/Name or {escape(name)}#/meshes/Name')


def _picture(path: Path, spec: AssetSpec, file: str, place: str) -> TextureData:
    try:
        with open_regular(path) as stream:
            return TextureData(read_picture(stream), spec.srgb, spec.wrap, spec.filter)
    except PictureFault as fault:
        raise SceneError(Issue(file, place, f'"{spec.uri}" {fault}')) from None
    except OSError as error:
        raise SceneError(Issue(file, place, f'"{spec.uri}" cannot be read: {error.strerror}')) from None


def _digest(files: Sequence[Path]) -> str:
    digest = hashlib.sha256()
    for file in files:
        digest.update(read_regular(file))
    return digest.hexdigest()


def _begins_as_named(path: Path) -> bool:
    """Whether a sound file begins as its name's ending promises."""
    try:
        with open_regular(path) as stream:
            head = stream.read(12)
    except OSError:
        return False
    heads = {".wav": head[:4] == b"RIFF" and head[8:] == b"WAVE", ".ogg": head[:4] == b"OggS"}
    return heads.get(path.suffix.lower(), head[:4] == b"fLaC")
