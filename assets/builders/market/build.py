"""The models of the pick and place scene, a toy market in metres: apple, stall, trees, meadow, hand, things about."""

from __future__ import annotations

from collections.abc import Mapping

from assets.builders.market.fruit import apple
from assets.builders.market.garden import MEADOW_COVERAGES, TREE_COVERAGES, build_meadow, build_tree
from assets.builders.market.props import barrel, bed, crate, fence, jug
from assets.builders.market.sculpt import PIXELS, PIXELS_OF_EDGES, PIXELS_OF_SKIN, Sculpt, pack_forms, pack_model
from assets.builders.market.sleeved_hand import fingers, palm, thumb
from assets.builders.market.stall import awning, goods, stall_wood

__all__ = ["compose"]


def compose(seed: int) -> dict[str, bytes]:
    """Every model as a GLB file.

    Args:
        seed: Of everything that grows.
    """
    models: Mapping[str, Mapping[str, tuple[Sculpt, float]]] = {
        "apple": {"apple": (apple(), 0.30)},
        "stall": {"wood": (stall_wood(), 0.8), "cloth": (awning(), 1.0), "goods": (goods(), 0.4)},
        "hand": {"palm": (palm(), 0.6), "fingers": (fingers(), 0.6), "thumb": (thumb(), 0.6)},
        "crate": {"crate": (crate(0.075, 0.09, 0.085), 0.85)},
        "barrel": {"barrel": (barrel(), 0.8)},
        "bed": {"bed": (bed(), 0.9)},
        "fence": {"fence": (fence(), 0.8)},
        "jug": {"jug": (jug(), 0.25)},
    }
    pixels = dict.fromkeys(("apple", "bed", "crate", "fence"), PIXELS_OF_EDGES) | {"hand": PIXELS_OF_SKIN}
    files = {f"{name}.glb": pack_model(name, parts, pixels.get(name, PIXELS)) for name, parts in models.items()}
    trees = {"tree": build_tree(2 * seed - 2), "tree_round": build_tree(2 * seed - 1)}
    files |= {f"{name}.glb": pack_forms(name, "tree", {"tree": forms}, TREE_COVERAGES) for name, forms in trees.items()}
    tiles = {f"meadow_{number}": forms for number, forms in enumerate(build_meadow(seed))}
    return files | {"meadow.glb": pack_forms("meadow", "meadow", tiles, MEADOW_COVERAGES)}
