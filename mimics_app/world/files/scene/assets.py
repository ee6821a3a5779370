"""Assets of a scene: the files under `assets`, located, identified and decoded."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.regular_file import open_regular
from mimics_app.world.components.checked_scene import AssetKind
from mimics_app.world.content.materials.material import TextureData
from mimics_app.world.files.gltf.file import GltfDocument
from mimics_app.world.files.gltf.images import PictureFault, read_picture
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.reading.paths import PathFault, find_file
from mimics_app.world.files.reading.provenance import Layer
from mimics_app.world.files.reading.struct_reader import FAILED, read_struct
from mimics_app.world.files.scene.model_shelf import MODELS, digest_of
from mimics_app.world.files.scene.spec import AssetSpec

__all__ = [
    "ModelPart",
    "SceneAsset",
    "find_in_model",
    "read_asset",
    "sound_of_model",
    "sounds_of_model",
]

_KINDS: dict[str, AssetKind] = {
    ".glb": "model",
    ".gltf": "model",
    ".vrm": "model",
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
    """One asset of the scene.

    Attributes:
        id: Its key under `assets`.
        kind: Kind, by the file name's ending.
        path: The file.
        model: Decoded model, or None.
        inside: Number of a sound embedded in a model, whose file `path` then is; else None.
        picture: Decoded image file, or None.
        files: The file and all files it refers to.
        digest: SHA-256 over the bytes of `files`, in hexadecimal.
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
    """Target of a reference into a model.

    Attributes:
        nodes: Root nodes of the whole model, each with its subtree.
        node: One node with its subtree, or None.
        mesh: One mesh, or None.
    """

    asset: SceneAsset
    model: GltfDocument
    nodes: tuple[int, ...] = ()
    node: int | None = None
    mesh: int | None = None

    @property
    def members(self) -> list[int]:
        """All its nodes, parents first; none for a mesh."""
        tops = self.nodes if self.node is None else (self.node,)
        return [index for top in tops for index in self.model.subtree(top)]


def read_asset(name: str, layer: Layer, root: Path, own: Path | None = None) -> SceneAsset | None:
    """Find and decode one asset.

    Args:
        name: Id of the asset.
        layer: Its item under `assets`, whose shape was checked and reported already.
        root: Folder that the file must be inside.
        own: Model in its place, of the person who plays, wherever it is; None: the scene's own.

    Returns:
        The asset, or None when its shape is wrong.

    Raises:
        SceneError: the file is missing, unreadable, of an unknown kind, or broken (then the issues name that file).
    """
    spec = read_struct(AssetSpec, layer.value, lambda *fault: None)
    if spec is FAILED:
        return None
    if own is not None:
        return _decode(name, "model", own, spec, own.parent)
    place = f"{layer.pointer}/uri"
    try:
        path = find_file(spec.uri, layer.folder, root)
    except PathFault as fault:
        raise SceneError(Issue(layer.file, place, fault.what, fault.fix)) from None
    kind = _KINDS.get(path.suffix.lower())
    if kind is None:
        known = ", ".join(_KINDS)
        raise SceneError(Issue(layer.file, place, f'"{spec.uri}" is of an unknown kind', f"known: {known}"))
    try:
        return _decode(name, kind, path, spec, root)
    except PictureFault as fault:
        raise SceneError(Issue(layer.file, place, f'"{spec.uri}" {fault}')) from None
    except OSError as error:
        raise SceneError(Issue(layer.file, place, f'"{spec.uri}" cannot be read: {error.strerror}')) from None


def _decode(name: str, kind: AssetKind, path: Path, spec: AssetSpec, root: Path) -> SceneAsset:
    """Decode a file of known kind; raise SceneError, PictureFault or OSError."""
    if kind == "model":
        model, digest = MODELS.read(path, root if path.is_relative_to(root.resolve()) else path.parent)
        return SceneAsset(name, kind, path, model=model, files=tuple(model.files), digest=digest)
    picture = None
    if kind == "picture":
        with open_regular(path) as stream:
            picture = TextureData(read_picture(stream), spec.srgb, spec.wrap, spec.filter)
    elif kind == "sound" and not _has_signature(path):
        raise PictureFault(f"is not in {path.suffix[1:].upper()} format")
    return SceneAsset(name, kind, path, picture=picture, files=(path,), digest=digest_of([path]))


def sounds_of_model(asset: SceneAsset) -> list[SceneAsset]:
    """Return the sounds of a model as assets, "model#/audio/0" and so on."""
    sounds = None if asset.model is None else asset.model.sounds
    return [
        SceneAsset(sound_of_model(asset.id, number), "sound", audio.path or asset.path, inside=inside)
        for number, audio in enumerate([] if sounds is None else sounds.audio)
        for inside in [number if audio.path is None else None]
    ]


def sound_of_model(name: str, number: int) -> str:
    """Return the asset id of a sound of a model."""
    return f"{name}#/audio/{number}"


def find_in_model(assets: dict[str, SceneAsset], reference: str) -> ModelPart:
    """Resolve a reference "asset", "asset#/nodes/Name" or "asset#/meshes/Name".

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


def _has_signature(path: Path) -> bool:
    """True when a sound file begins with the signature of its name's ending."""
    with open_regular(path) as stream:
        head = stream.read(12)
    heads = {".wav": head[:4] == b"RIFF" and head[8:] == b"WAVE", ".ogg": head[:4] == b"OggS"}
    return heads.get(path.suffix.lower(), head[:4] == b"fLaC")
