"""Materials and techniques of a scene, with inheritance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import reduce
from typing import Any

import msgspec

from mimics_app.contracts.errors import Issue, nearest
from mimics_app.world.content.materials.material import MAPS, Affine, Material
from mimics_app.world.content.materials.technique import TechniqueSpec
from mimics_app.world.files.reading.json_text import escape
from mimics_app.world.files.reading.provenance import Layer, merged
from mimics_app.world.files.reading.struct_reader import FAILED, read_struct
from mimics_app.world.files.scene.document import SceneDocument
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.files.scene.spec import MaterialSpec, UvTransform
from mimics_app.world.files.scene.technique_library import built_in_techniques

__all__ = ["edit_materials", "load_materials", "load_techniques"]


def inherit(
    table: dict[str, Layer], what: str, issues: list[Issue], built_in: Mapping[str, msgspec.Struct] | None = None
) -> dict[str, tuple[dict[str, Any], list[Layer]]]:
    """Return each item merged with all it inherits, and its layers, strongest first.

    Args:
        table: Items by id; one that is not an object is skipped.
        what: Name of the kind of item in messages.
        issues: Receives faults: unknown ids and items that inherit themselves.
        built_in: Further items that may be inherited.
    """
    result = {}
    ground = {name: msgspec.to_builtins(struct) for name, struct in (built_in or {}).items()}
    for name, layer in table.items():
        if isinstance(layer.value, dict):
            layers = _layers(name, table, what, issues, ground)
            lowest = ground.get(layers[-1].value.get("inherits"), {})
            result[name] = (reduce(merged, (each.value for each in reversed(layers)), lowest), layers)
    return result


def _layers(
    name: str, table: dict[str, Layer], what: str, issues: list[Issue], built_in: Mapping[str, object]
) -> list[Layer]:
    chain, layers = [name], [table[name]]
    while isinstance(base := layers[-1].value.get("inherits"), str):
        place = layers[-1].child("inherits", None)
        fault = None
        if base not in table and base in built_in:
            break
        if base not in table:
            known = {**table, **built_in}
            fault = Issue(place.file, place.pointer, f'no {what} "{base}"', nearest(base, known))
        elif base in chain:
            ring = " -> ".join((*chain[chain.index(base) :], base))
            fault = Issue(place.file, place.pointer, f"the {what} inherits itself: {ring}")
        if fault is not None or not isinstance(table[base].value, dict):
            issues += [fault] if fault is not None and fault not in issues else []
            break
        chain.append(base)
        layers.append(table[base])
    return layers


_SPEC_ONLY = ("inherits", "uv_transform")


def load_techniques(scene: Scene, document: SceneDocument, issues: list[Issue]) -> None:
    """Decode the scene's own techniques; faults of their shape were reported already."""
    known = built_in_techniques()
    for name, (value, layers) in inherit(document.tables["techniques"], "technique", issues, known).items():
        document.origins.set(f"/techniques/{escape(name)}", layers)
        spec = read_struct(TechniqueSpec, value, lambda *fault: None)
        if spec is FAILED:
            continue
        scene.techniques[name] = spec
        if not spec.passes:
            what = "the technique has no pass"
            issues.append(scene.issue(f"/techniques/{escape(name)}", what, 'give it "passes", or "inherits"'))
    for name, spec in scene.techniques.items():
        fallback = {f"/techniques/{escape(name)}/fallback": spec.fallback}
        issues += scene.check_names(fallback, "no technique", scene.techniques | known)


def load_materials(scene: Scene, document: SceneDocument, issues: list[Issue]) -> None:
    """Decode the scene's materials; a missing technique is only noted, because a default replaces it."""
    known = scene.techniques | built_in_techniques()
    for name, (value, layers) in inherit(document.tables["materials"], "material", issues).items():
        document.origins.set(f"/materials/{escape(name)}", layers)
        spec = read_struct(MaterialSpec, value, lambda *fault: None)
        if spec is FAILED:
            continue
        scene.materials[name] = _material(name, spec)
        for key, texture in ((f"{which}_texture", getattr(spec, f"{which}_texture")) for which in MAPS):
            if texture is not None:
                _check_picture(scene, document.tables["assets"], f"/materials/{escape(name)}/{key}", texture, issues)
        technique = {f"/materials/{escape(name)}/technique": spec.technique}
        scene.notes += map(str, scene.check_names(technique, "no technique", known))


def edit_materials(scene: Scene, before: Mapping[str, object]) -> None:
    """Decode what an edit of the resolved scene changed or added among its materials; `before` is what they were."""
    for name, value in scene.document.get("materials", {}).items():
        if value != before.get(name):
            scene.materials[name] = _material(name, msgspec.convert(value, MaterialSpec))


def _check_picture(scene: Scene, known: dict[str, Layer], pointer: str, texture: str, issues: list[Issue]) -> None:
    asset = scene.assets.get(texture)
    issues += scene.check_names({pointer: texture}, "no asset", known, "the scene has no assets")
    if texture in known and asset is not None and asset.kind != "picture":
        issues.append(scene.issue(pointer, f'asset "{texture}" is a {asset.kind}, not a picture'))


def _material(name: str, spec: MaterialSpec) -> Material:
    fields = {key: getattr(spec, key) for key in spec.__struct_fields__ if key not in _SPEC_ONLY}
    return Material(name, uv_transforms=(_affine(spec.uv_transform),) * len(MAPS), **fields)


def _affine(spec: UvTransform) -> Affine:
    """Return the matrix of a KHR_texture_transform: scale, then rotation, then translation, v downwards."""
    cos, sin = math.cos(spec.rotation), math.sin(spec.rotation)
    (right, down), (wide, high) = spec.offset, spec.scale
    return cos * wide, sin * high, right, -sin * wide, cos * high, down
