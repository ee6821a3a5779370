"""Entities from the nodes of a model: components authored in a modeller (`extras.mimics`), and sound emitters."""

from __future__ import annotations

from collections import Counter
from typing import Any

from mimics_app.contracts.errors import Issue, nearest
from mimics_app.maths.decompose import decompose_trs
from mimics_app.world.files.gltf.sounds import EXTENSION
from mimics_app.world.files.reading.provenance import Layer
from mimics_app.world.files.scene.assets import ModelPart, SceneAsset, find_in_model, sound_of_model
from mimics_app.world.files.scene.document import EntityDraft, SceneDocument

__all__ = ["unfold_model"]

_TRANSFORM = ("translation", "rotation", "scale")


def unfold_model(
    draft: EntityDraft, document: SceneDocument, assets: dict[str, SceneAsset], issues: list[Issue]
) -> None:
    """Add the nodes of an entity's model that have components, as entities "entity/Node", and its sound emitters.

    Components of a node that is shown itself belong to the entity; the scene file overrides the model. The entity's
    `overrides` are merged over the nodes they name.

    Args:
        draft: Any entity; nothing happens unless its mesh has a `source` that exists.
        document: Receives the new entities.
        assets: The scene's assets.
        issues: Receives overrides that name nothing.
    """
    nodes: dict[str, Layer] = {}
    emitters: set[str] = set()
    part = _part(draft, assets)
    if part is not None:
        nodes = _layers(part)
        emitters = _add_emitters(draft, part, document)
        if part.node is not None:
            draft.layers.append(_layer(part, part.node))
    for name, layer in nodes.items():
        over = draft.overrides.pop(name, None)
        if over is not None or layer.value["components"] or name in emitters:
            layers = [layer] if over is None else [over, layer]
            document.add(EntityDraft(f"{draft.id}/{name}", draft.id, layers, in_model=True))
    for path, layer in draft.overrides.items():
        hint = nearest(path, nodes) if nodes else "it has neither a prefab nor a model with parts"
        issues.append(Issue(layer.file, layer.pointer, f'nothing inside "{draft.id}" is called "{path}"', hint))


def _part(draft: EntityDraft, assets: dict[str, SceneAsset]) -> ModelPart | None:
    mesh = draft.part("components").get("mesh") if draft.mentions("mesh") else None
    source = mesh.get("source") if isinstance(mesh, dict) else None
    try:
        return find_in_model(assets, source) if isinstance(source, str) else None
    except KeyError:
        return None  # reported by the check of the reference


def _layers(part: ModelPart) -> dict[str, Layer]:
    """Return the layers of all nodes below the one shown, or of the whole model, by name."""
    model = part.model
    below = [index for index in part.members if index != part.node]
    return {model.nodes[index].name: _layer(part, index) for index in below if model.nodes[index].name}


def _layer(part: ModelPart, index: int) -> Layer:
    value = {"components": part.model.nodes[index].components}
    return Layer(part.model.file, part.asset.path.parent, f"/nodes/{index}/extras/mimics", value)


def _add_emitters(draft: EntityDraft, part: ModelPart, document: SceneDocument) -> set[str]:
    """Add the sources of a model's emitters as entities; return the names of the nodes they move with.

    A source on a node without a unique name stays at that node's initial pose; those of the scene are global.
    """
    model, sounds = part.model, part.model.sounds
    if sounds is None or part.mesh is not None:
        return set()
    names = Counter(node.name for node in model.nodes)
    moving = set()
    for index in (index for index in part.members if index in sounds.of_nodes):
        name = model.nodes[index].name
        owner, transform = draft.id, {}
        if index != part.node and names[name] == 1 and name:
            moving.add(name)
            owner = f"{draft.id}/{name}"
        elif index != part.node:
            transform = _placed(part, index)
        place = f"/nodes/{index}/extensions/{EXTENSION}"
        _add_played(document, part, f"{owner}/sound_{index}", owner, sounds.of_nodes[index], place, transform)
    for number in sounds.of_scene if part.node is None else ():
        place = f"/extensions/{EXTENSION}/emitters/{number}"
        _add_played(document, part, f"{draft.id}/everywhere_{number}", draft.id, number, place, {})
    return moving


def _add_played(
    document: SceneDocument,
    part: ModelPart,
    name: str,
    owner: str,
    emitter: int,
    place: str,
    transform: dict[str, Any],
) -> None:
    """Add an entity with sound and emitter for each source of an emitter of the file."""
    for number, played in enumerate(part.model.sounds.emitters[emitter] if part.model.sounds else ()):
        entity = name if number == 0 else f"{name}_{number}"
        components = {
            "sound": {**played.sound, "asset": sound_of_model(part.asset.id, played.audio)},
            "sound_emitter": {**played.emitter, "sound": entity},
        }
        value = {"transform": transform, "components": components}
        layer = Layer(part.model.file, part.asset.path.parent, place, value)
        document.add(EntityDraft(entity, owner, [layer]))


def _placed(part: ModelPart, index: int) -> dict[str, Any]:
    """Return the transform of a node relative to the entity of its model, as in a scene file."""
    from mimics_app.world.files.scene.placing import model_matrix

    translation, rotation, scale, _ = decompose_trs(model_matrix(part, index))
    return {name: each.tolist() for name, each in zip(_TRANSFORM, (translation, rotation, scale), strict=True)}
