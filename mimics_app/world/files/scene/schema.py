"""JSON Schema of scene files, generated from the Structs that read them, for editors."""

from __future__ import annotations

import copy
from typing import Any

import msgspec

from mimics_app.world.components.plugins import register_plugins
from mimics_app.world.components.registry import component_types, section_of, system_types
from mimics_app.world.files.scene.spec import SceneSpec

__all__ = ["scene_schema"]

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_COMMENTS = {"^x-": {"description": "Free for comments; never read"}}
_PARTIAL = "Partial"
"""Suffix of the variant without required keys, for parts that are merged over a prefab's."""


def scene_schema() -> dict[str, Any]:
    """Return the schema as a plain object, with every registered component, system and section."""
    register_plugins()
    components, systems, task = component_types(), system_types(), section_of("task")
    types = [SceneSpec, *components.values(), *systems.values(), *([] if task is None else [task.type])]
    references, definitions = msgspec.json.schema_components(types, ref_template="#/$defs/{name}")
    _add_partial(definitions)
    for definition in definitions.values():
        if definition.get("type") == "object" and "properties" in definition:
            definition["additionalProperties"] = False
            definition["patternProperties"] = _COMMENTS
    by_type = dict(zip(types, references, strict=True))
    whole = {name: by_type[struct] for name, struct in components.items()}
    partial = {name: {"anyOf": [_partial(ref), {"type": "null"}]} for name, ref in whole.items()}
    for name in ("PrefabSpec", "OverrideSpec"):
        _set_table(definitions[name], "components", partial)
    entity = definitions["EntitySpec"]
    _set_table(entity, "components", partial)
    entity["if"] = {"not": {"required": ["prefab"]}}
    entity["then"] = {"properties": {"components": {"properties": whole}}}
    scene = definitions["SceneSpec"]
    _set_table(scene, "systems", {name: by_type[struct] for name, struct in systems.items()})
    if task is not None:
        scene["properties"]["task"] = by_type[task.type]
    return {"$schema": _DIALECT, "title": "Scene of mimics_app", "$ref": "#/$defs/SceneSpec", "$defs": definitions}


def _set_table(definition: dict[str, Any], key: str, properties: dict[str, Any]) -> None:
    """Restrict an object-valued property to these keys."""
    definition["properties"][key] |= {
        "properties": properties,
        "additionalProperties": False,
        "patternProperties": _COMMENTS,
    }


def _partial(reference: dict[str, Any]) -> dict[str, Any]:
    return {"$ref": reference["$ref"] + _PARTIAL}


def _add_partial(definitions: dict[str, Any]) -> None:
    for name, definition in list(definitions.items()):
        loose = copy.deepcopy(definition)
        loose.pop("required", None)
        definitions[name + _PARTIAL] = loose
