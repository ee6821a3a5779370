"""Inheritance between items of one table, by the key `inherits`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from typing import Any

import msgspec

from mimics_app.contracts.errors import Issue, nearest
from mimics_app.world.files.reading.provenance import Layer, merged

__all__ = ["inherit"]


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
