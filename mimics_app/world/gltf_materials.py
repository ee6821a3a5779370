"""Materials of a glTF file: metallic-roughness, alpha modes, unlit, emissive strength, texture transforms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.gltf_images import GltfImages
from mimics_app.world.gltf_source import GltfSource
from mimics_app.world.material import AlphaMode, Material

__all__ = ["GltfMaterial", "GltfMaterials"]

_ALPHA_MODES: dict[str, AlphaMode] = {"OPAQUE": "opaque", "MASK": "mask", "BLEND": "blend"}
_UNUSED_TEXTURES = ("normalTexture", "occlusionTexture", "emissiveTexture")


@dataclass(frozen=True, eq=False)
class GltfMaterial:
    """A material and how its texture lies on a mesh.

    Attributes:
        material: Its `base_texture` is a key of the file's textures.
        uv_set: Which TEXCOORD_n the texture uses.
        uv_transform: Rows of the 2 x 3 matrix applied to those coordinates (KHR_texture_transform), [2, 3].
    """

    material: Material
    uv_set: int
    uv_transform: NDArray[np.float64]


class GltfMaterials:
    """Reads materials in order; names are made unique, so that they can be keys."""

    def __init__(self, source: GltfSource, images: GltfImages) -> None:
        self._source = source
        self._images = images
        self._names: set[str] = set()

    def read_all(self) -> list[GltfMaterial]:
        """Every material; faults are collected, and a faulty material stands as plain grey."""
        result = []
        for i, item in enumerate(self._source.table("materials")):
            material = GltfMaterial(Material(f"material{i}"), 0, np.eye(3)[:2])
            with self._source.collecting():
                material = self._read(item, f"/materials/{i}", i)
            result.append(material)
        return result

    def _read(self, item: dict[str, Any], place: str, number: int) -> GltfMaterial:
        source = self._source
        shading = source.object(item, "pbrMetallicRoughness", place)
        below = f"{place}/pbrMetallicRoughness"
        extensions = source.object(item, "extensions", place)
        mode = source.text(item, "alphaMode", place, "OPAQUE")
        if mode not in _ALPHA_MODES:
            source.fail(f"{place}/alphaMode", f'"{mode[:40]}" is not one of {", ".join(_ALPHA_MODES)}')
        texture, uv_set, transform = self._base_texture(shading, below)
        material = Material(
            name=self._unique(source.text(item, "name", place) or f"material{number}"),
            technique="unlit" if "KHR_materials_unlit" in extensions else "lit",
            base_colour=cast(Any, source.vector(shading, "baseColorFactor", below, (1.0, 1.0, 1.0, 1.0))),
            metallic=min(source.number(shading, "metallicFactor", below, 1.0, 0.0), 1.0),
            roughness=min(source.number(shading, "roughnessFactor", below, 1.0, 0.0), 1.0),
            emission=self._emission(item, place),
            base_texture=texture,
            alpha_mode=_ALPHA_MODES[mode],
            alpha_cutoff=source.number(item, "alphaCutoff", place, 0.5, 0.0),
            double_sided=item.get("doubleSided") is True,
        )
        self._note_unused(item, shading, material.name)
        return GltfMaterial(material, uv_set, transform)

    def _emission(self, item: dict[str, Any], place: str) -> tuple[float, float, float]:
        source = self._source
        extensions = source.object(item, "extensions", place)
        strength_place = f"{place}/extensions/KHR_materials_emissive_strength"
        holder = source.object(extensions, "KHR_materials_emissive_strength", f"{place}/extensions")
        strength = source.number(holder, "emissiveStrength", strength_place, 1.0, 0.0)
        red, green, blue = source.vector(item, "emissiveFactor", place, (0.0, 0.0, 0.0))
        return red * strength, green * strength, blue * strength

    def _base_texture(self, shading: dict[str, Any], place: str) -> tuple[str | None, int, NDArray[np.float64]]:
        source = self._source
        if "baseColorTexture" not in shading:
            return None, 0, np.eye(3)[:2]
        info = source.object(shading, "baseColorTexture", place)
        here = f"{place}/baseColorTexture"
        key = self._images.texture(info.get("index"), f"{here}/index")
        uv_set = source.whole(info, "texCoord", here, 0)
        extensions = source.object(info, "extensions", here)
        if "KHR_texture_transform" not in extensions:
            return key, uv_set, np.eye(3)[:2]
        shift = source.object(extensions, "KHR_texture_transform", f"{here}/extensions")
        there = f"{here}/extensions/KHR_texture_transform"
        return key, source.whole(shift, "texCoord", there, uv_set), self._uv_transform(shift, there)

    def _uv_transform(self, shift: dict[str, Any], place: str) -> NDArray[np.float64]:
        offset = self._source.vector(shift, "offset", place, (0.0, 0.0))
        scale = self._source.vector(shift, "scale", place, (1.0, 1.0))
        angle = self._source.number(shift, "rotation", place, 0.0)
        cos, sin = math.cos(angle), math.sin(angle)
        return np.array(
            [[cos * scale[0], sin * scale[1], offset[0]], [-sin * scale[0], cos * scale[1], offset[1]]], np.float64
        )

    def _note_unused(self, item: dict[str, Any], shading: dict[str, Any], name: str) -> None:
        unused = [key for key in _UNUSED_TEXTURES if key in item]
        unused += ["metallicRoughnessTexture"] if "metallicRoughnessTexture" in shading else []
        if unused:
            self._source.notes.append(f'material "{name}": not used: {", ".join(unused)}')

    def _unique(self, name: str) -> str:
        number, unique = 1, name
        while unique in self._names:
            unique = f"{name}.{number:03d}"
            number += 1
        self._names.add(unique)
        return unique
