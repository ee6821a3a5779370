"""Entities out of the nodes of a model: components authored in a modeller, under `extras.mimics` of a glTF node."""

from __future__ import annotations

from mimics_app.contracts.errors import Issue, nearest
from mimics_app.world.scene.assets import ModelPart, SceneAsset, find_in_model
from mimics_app.world.scene.document import EntityDraft, SceneDocument
from mimics_app.world.scene.provenance import Layer

__all__ = ["unfold_model"]


def unfold_model(
    draft: EntityDraft, document: SceneDocument, assets: dict[str, SceneAsset], issues: list[Issue]
) -> None:
    """Add the nodes of an entity's model that carry components, as entities "entity/Node".

    Those of the node that is shown itself belong to the entity; the scene file wins over the model. The entity's
    `overrides` are laid over the nodes they name.

    Args:
        draft: Any entity; nothing happens unless its mesh has a `source` that exists.
        document: Receives the new entities.
        assets: The scene's assets.
        issues: Receives overrides that name nothing.
    """
    nodes: dict[str, Layer] = {}
    part = _part(draft, assets)
    if part is not None:
        nodes = _layers(part)
        if part.node is not None:
            draft.layers.append(_layer(part, part.node))
    for name, layer in nodes.items():
        over = draft.overrides.pop(name, None)
        if over is not None or layer.value["components"]:
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
    """Nodes below the one that is meant, or all of the model, by name."""
    model = part.model
    tops = part.nodes if part.node is None else (part.node,)
    below = [index for top in tops for index in model.subtree(top) if index != part.node]
    return {model.nodes[index].name: _layer(part, index) for index in below if model.nodes[index].name}


def _layer(part: ModelPart, index: int) -> Layer:
    value = {"components": part.model.nodes[index].components}
    return Layer(part.model.file, part.asset.path.parent, f"/nodes/{index}/extras/mimics", value)
