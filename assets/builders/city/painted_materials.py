"""Materials of streets and houses with painted pictures: a table of the pictures, and a record of one material."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from assets.builders.city import fittings, textures
from mimics_app.world.files.gltf.writer import GltfWriter

__all__ = ["Colour", "Painted", "add_materials"]

Colour = tuple[float, float, float, float]
"""Linear RGBA."""

_PICTURES: dict[str, tuple[Callable[[int], bytes], bool]] = {
    "brick": (textures.paint_brick, True),
    "plaster": (textures.paint_plaster, True),
    "stone": (textures.paint_stone, True),
    "tiles": (textures.paint_tiles, True),
    "slate": (textures.paint_slate, True),
    "brick_bay": (partial(textures.paint_bay, kind="brick"), True),
    "plaster_bay": (partial(textures.paint_bay, kind="plaster"), True),
    "road": (textures.paint_road, True),
    "zebra": (textures.paint_zebra, False),
    "asphalt": (textures.paint_asphalt, True),
    "paving": (textures.paint_paving, True),
    "grass": (textures.paint_grass, True),
    "gardens": (textures.paint_gardens, True),
    "bark": (textures.paint_bark, True),
    "leaves": (fittings.paint_leaves, False),
    "railing": (fittings.paint_railing, True),
    "window": (fittings.paint_windows, False),
    "detail": (fittings.paint_details, False),
}
"""Picture: who paints it from the seed, and whether it repeats."""


@dataclass(frozen=True, slots=True)
class Painted:
    """A material.

    Attributes:
        picture: Name of its picture, "" for none.
        colour: Linear RGBA, multiplied with the picture.
        roughness: 0 (mirror) to 1 (matt).
        mask: Opacity below which nothing is drawn; None: opaque.
    """

    picture: str = ""
    colour: Colour = (1.0, 1.0, 1.0, 1.0)
    roughness: float = 1.0
    mask: float | None = None


def add_materials(writer: GltfWriter, seed: int, materials: Mapping[str, Painted], prefix: str = "") -> dict[str, int]:
    """Add materials, named with a prefix, and the pictures that they need; return the index of each material."""
    needed = {material.picture for material in materials.values()}
    pictures = {
        name: writer.add_picture(name, paint(seed), repeat=repeats)
        for name, (paint, repeats) in _PICTURES.items()
        if name in needed
    }
    return {
        name: writer.add_material(
            prefix + name,
            texture=pictures.get(each.picture),
            colour=each.colour,
            roughness=each.roughness,
            mask=each.mask,
        )
        for name, each in materials.items()
    }
