"""Materials of a glTF file: metallic-roughness, alpha modes, unlit, emissive strength, texture transforms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.content.materials.material import IDENTITY, MAPS, Affine, AlphaMode, Material
from mimics_app.world.files.gltf.gltf_document import GltfSource
from mimics_app.world.files.gltf.images import GltfImages

__all__ = ["GltfMaterial", "GltfMaterials"]

_ALPHA_MODES: dict[str, AlphaMode] = {"OPAQUE": "opaque", "MASK": "mask", "BLEND": "blend"}
_PLACES = {
    "base": "baseColorTexture",
    "normal": "normalTexture",
    "surface": "metallicRoughnessTexture",
    "occlusion": "occlusionTexture",
    "emission": "emissiveTexture",
}
"""Property of the file for each map."""

_IN_SHADING = ("base", "surface")
_MIN_AREA = 1e-12
"""Minimum area of the transformed unit square for an invertible texture transform."""
_PLAIN = np.eye(3)[:2]
_SETS = 2
"""Sets of texture coordinates that a material may use."""


@dataclass(frozen=True, eq=False)
class GltfMaterial:
    """A material and its texture coordinates.

    Attributes:
        material: The material; its textures are keys of the file's textures, on coordinates after `uv_transform`.
        uv_set: Number n of the TEXCOORD_n that its first texture uses.
        uv_transform: Rows of the 2 x 3 matrix applied to those coordinates (KHR_texture_transform), [2, 3].
        second_set: Number of the set that the maps in `Material.second_uv` use; None: there are none.
    """

    material: Material
    uv_set: int
    uv_transform: NDArray[np.float64]
    second_set: int | None = None


@dataclass(frozen=True, eq=False)
class _Placed:
    """One texture of a material: key, set of coordinates, and transform of these [2, 3]."""

    key: str
    uv_set: int
    transform: NDArray[np.float64]


class GltfMaterials:
    """Reader of materials in file order; names are made unique, as they are keys."""

    def __init__(self, source: GltfSource, images: GltfImages) -> None:
        self._source = source
        self._images = images
        self._names: dict[str, int] = {}

    def read_all(self) -> list[GltfMaterial]:
        """Read every material; faults are collected, and a faulty material is replaced by plain grey."""
        items = self._source.table("materials")
        return self._source.read_each(items, "/materials", self._read, lambda: GltfMaterial(Material(""), 0, _PLAIN))

    def _read(self, item: dict[str, Any], place: str) -> GltfMaterial:
        source = self._source
        shading = source.object(item, "pbrMetallicRoughness", place)
        below = f"{place}/pbrMetallicRoughness"
        mode = source.choice(item, "alphaMode", place, _ALPHA_MODES, "OPAQUE")
        name = self._unique(source.text(item, "name", place) or f"material{place.rpartition('/')[2]}")
        maps, uv_set, first = self._maps(item, place, name)
        second = next((used.uv_set for used in maps.values() if used.uv_set != uv_set), None)
        aside = tuple(which for which in MAPS if which in maps and maps[which].uv_set == second)
        unlit = "KHR_materials_unlit" in source.object(item, "extensions", place)
        keys: dict[str, Any] = {f"{which}_texture": used.key for which, used in maps.items()}
        material = Material(
            name=name,
            technique="unlit" if unlit else "pbr" if maps.keys() - {"base"} else "lit",
            base_colour=cast(Any, source.vector(shading, "baseColorFactor", below, (1.0, 1.0, 1.0, 1.0))),
            metallic=min(source.number(shading, "metallicFactor", below, 1.0, 0.0), 1.0),
            roughness=min(source.number(shading, "roughnessFactor", below, 1.0, 0.0), 1.0),
            emission=self._emission(item, place),
            normal_scale=self._figure(item, place, "normal", "scale"),
            occlusion_strength=min(self._figure(item, place, "occlusion", "strength"), 1.0),
            uv_transforms=tuple(
                _beyond(_PLAIN if which in aside else first, maps[which].transform if which in maps else first)
                for which in MAPS
            ),
            second_uv=aside,
            alpha_mode=_ALPHA_MODES[mode],
            alpha_cutoff=source.number(item, "alphaCutoff", place, 0.5, 0.0),
            double_sided=item.get("doubleSided") is True,
            softness=self._softness(item, place),
            **keys,
        )
        return GltfMaterial(material, uv_set, first, second)

    def _maps(self, item: dict[str, Any], place: str, name: str) -> tuple[dict[str, _Placed], int, NDArray[np.float64]]:
        """Return the usable maps, the set of coordinates of the first, and its transform."""
        source, maps = self._source, {}
        for which in MAPS:
            holder, above = item, place
            if which in _IN_SHADING:
                holder, above = source.object(item, "pbrMetallicRoughness", place), f"{place}/pbrMetallicRoughness"
            if _PLACES[which] in holder:
                maps[which] = self._placed(source.object(holder, _PLACES[which], above), f"{above}/{_PLACES[which]}")
        if not maps:
            return {}, 0, _PLAIN
        first = next(iter(maps.values()))
        flat = abs(np.linalg.det(first.transform[:, :2])) < _MIN_AREA
        sets = list(dict.fromkeys(used.uv_set for used in maps.values()))[:_SETS]
        usable = {
            which: used
            for which, used in maps.items()
            if used.uv_set in sets[1:]
            or (used.uv_set == first.uv_set and (not flat or np.array_equal(used.transform, first.transform)))
        }
        unused = [_PLACES[which] for which in maps.keys() - usable.keys()]
        if unused:
            why = "their texture coordinates are a third set, or cannot be computed from those of the first"
            source.note(f'material "{name}": not used: {", ".join(sorted(unused))}; {why}')
        return usable, first.uv_set, first.transform

    def _figure(self, item: dict[str, Any], place: str, which: str, key: str) -> float:
        key_of_map = _PLACES[which]
        return self._source.number(self._source.object(item, key_of_map, place), key, f"{place}/{key_of_map}", 1.0)

    def _softness(self, item: dict[str, Any], place: str) -> float:
        """Read `extras.mimics.softness`: no extension has subsurface scattering in a unit for a cheap shader."""
        extras = item.get("extras")
        ours = self._source.object(extras, "mimics", f"{place}/extras") if isinstance(extras, dict) else {}
        return min(self._source.number(ours, "softness", f"{place}/extras/mimics", 0.0, 0.0), 1.0)

    def _emission(self, item: dict[str, Any], place: str) -> tuple[float, float, float]:
        source = self._source
        holder = source.extension(item, "KHR_materials_emissive_strength", place)
        where = f"{place}/extensions/KHR_materials_emissive_strength"
        strength = source.number(holder, "emissiveStrength", where, 1.0, 0.0)
        red, green, blue = source.vector(item, "emissiveFactor", place, (0.0, 0.0, 0.0))
        return red * strength, green * strength, blue * strength

    def _placed(self, info: dict[str, Any], here: str) -> _Placed:
        source = self._source
        key = self._images.texture(info.get("index"), f"{here}/index")
        uv_set = source.whole(info, "texCoord", here, 0)
        shift = source.extension(info, "KHR_texture_transform", here)
        there = f"{here}/extensions/KHR_texture_transform"
        return _Placed(key, source.whole(shift, "texCoord", there, uv_set), self._uv_transform(shift, there))

    def _uv_transform(self, shift: dict[str, Any], place: str) -> NDArray[np.float64]:
        offset = self._source.vector(shift, "offset", place, (0.0, 0.0))
        scale = self._source.vector(shift, "scale", place, (1.0, 1.0))
        angle = self._source.number(shift, "rotation", place, 0.0)
        cos, sin = math.cos(angle), math.sin(angle)
        return np.array(
            [[cos * scale[0], sin * scale[1], offset[0]], [-sin * scale[0], cos * scale[1], offset[1]]], np.float64
        )

    def _unique(self, name: str) -> str:
        number, unique = self._names.get(name, 0), name
        while unique in self._names:
            number += 1
            unique = f"{name}.{number:03d}"
        self._names[name] = number
        self._names.setdefault(unique, 0)
        return unique


def _beyond(first: NDArray[np.float64], wanted: NDArray[np.float64]) -> Affine:
    """Return the rows of the matrix from coordinates transformed by `first` to those transformed by `wanted`."""
    if np.array_equal(first, wanted):
        return IDENTITY
    lowest = np.array([[0.0, 0.0, 1.0]])
    rows = (np.vstack([wanted, lowest]) @ np.linalg.inv(np.vstack([first, lowest])))[:2]
    return cast(Affine, tuple(rows.ravel().tolist()))
