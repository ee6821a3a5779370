"""Check of all indices and names of a glTF file, also in parts that are not used.

Readers check only the indices they follow, not those of skipped skins, clips, morph targets and primitives.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mimics_app.world.files.gltf.gltf_document import GltfSource
from mimics_app.world.files.reading.json_text import escape

__all__ = ["check_references"]

_REFERENCES = (
    ("accessors/*/bufferView", "bufferViews"),
    ("accessors/*/sparse/indices/bufferView", "bufferViews"),
    ("accessors/*/sparse/values/bufferView", "bufferViews"),
    ("bufferViews/*/buffer", "buffers"),
    ("images/*/bufferView", "bufferViews"),
    ("textures/*/source", "images"),
    ("textures/*/sampler", "samplers"),
    ("materials/*/pbrMetallicRoughness/baseColorTexture/index", "textures"),
    ("materials/*/pbrMetallicRoughness/metallicRoughnessTexture/index", "textures"),
    ("materials/*/normalTexture/index", "textures"),
    ("materials/*/occlusionTexture/index", "textures"),
    ("materials/*/emissiveTexture/index", "textures"),
    ("meshes/*/primitives/*/attributes/*", "accessors"),
    ("meshes/*/primitives/*/indices", "accessors"),
    ("meshes/*/primitives/*/material", "materials"),
    ("meshes/*/primitives/*/targets/*/*", "accessors"),
    ("skins/*/inverseBindMatrices", "accessors"),
    ("skins/*/skeleton", "nodes"),
    ("skins/*/joints/*", "nodes"),
    ("nodes/*/skin", "skins"),
    ("animations/*/samplers/*/input", "accessors"),
    ("animations/*/samplers/*/output", "accessors"),
    ("animations/*/channels/*/target/node", "nodes"),
    ("scenes/*/nodes/*", "nodes"),
)
"""Paths of indices, * for every item or member, and the list they refer to; the reader of nodes checks its own."""

_NAMED = (
    *("accessors", "animations", "bufferViews", "buffers", "cameras", "images", "materials", "meshes"),
    *("nodes", "samplers", "scenes", "skins", "textures"),
)
"""Lists whose items may have names."""


def check_references(source: GltfSource) -> None:
    """Report every index out of range and every name that is not a text; values of a wrong shape are skipped.

    The time is linear in the size of the file.
    """
    for path, name in _REFERENCES:
        steps = path.split("/")
        for value, pointer in _values(source.json, steps):
            with source.collecting():
                source.index(value, len(source.table(name)), name, pointer)
    for name in _NAMED:
        with source.collecting():
            for i, item in enumerate(source.table(name)):
                source.text(item, "name", f"/{name}/{i}")


def _values(document: dict[str, Any], steps: list[str]) -> Iterator[tuple[Any, str]]:
    """Yield every value at a path, with its pointer."""
    found: list[tuple[Any, str]] = [(document, "")]
    for step in steps:
        below: list[tuple[Any, str]] = []
        for value, pointer in found:
            if step != "*":
                below += [(value[step], f"{pointer}/{step}")] if isinstance(value, dict) and step in value else []
            elif isinstance(value, dict):
                below += [(item, f"{pointer}/{escape(key)}") for key, item in value.items()]
            elif isinstance(value, list):
                below += [(item, f"{pointer}/{i}") for i, item in enumerate(value)]
        found = below
    yield from found
