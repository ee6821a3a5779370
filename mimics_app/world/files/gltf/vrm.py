"""Bones of a person that a VRM file names itself, of version 1 (`VRMC_vrm`) and 0 (`VRM`)."""

from __future__ import annotations

from typing import Any

from mimics_app.world.files.gltf.gltf_document import GltfSource

__all__ = ["read_bones"]


def read_bones(source: GltfSource) -> dict[str, int]:
    """Return the node of each bone in the file's own table, by VRM 1.0 name; empty for a file that has none.

    Faults are collected.
    """
    newer = source.extension(source.json, "VRMC_vrm", "")
    older = source.extension(source.json, "VRM", "")
    with source.collecting():
        if newer:
            return _newer(source, newer, "/extensions/VRMC_vrm")
        if older:
            return _older(source, older, "/extensions/VRM")
    return {}


def _newer(source: GltfSource, extension: dict[str, Any], place: str) -> dict[str, int]:
    humanoid, place = source.object(extension, "humanoid", place), f"{place}/humanoid"
    bones, place = source.object(humanoid, "humanBones", place), f"{place}/humanBones"
    return {name: _node(source, source.object(bones, name, place), f"{place}/{name}") for name in bones}


def _older(source: GltfSource, extension: dict[str, Any], place: str) -> dict[str, int]:
    humanoid, place = source.object(extension, "humanoid", place), f"{place}/humanoid"
    found = dict[str, int]()
    for i, item in enumerate(source.list(humanoid, "humanBones", place)):
        here = f"{place}/humanBones/{i}"
        if not isinstance(item, dict):
            source.fail(here, "must be an object")
        found[source.text(item, "bone", here)] = _node(source, item, here)
    return found


def _node(source: GltfSource, item: dict[str, Any], place: str) -> int:
    return source.index(item.get("node"), len(source.table("nodes")), "nodes", f"{place}/node")
