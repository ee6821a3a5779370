"""What the inspector shows of an entity: its values as rows, with units and limits from the schema of scene files."""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal

import numpy as np

from mimics_app.maths.quat import about_axis, product
from mimics_app.world.files.reading.json_edit import source_of
from mimics_app.world.files.reading.struct_reader import is_comment
from mimics_app.world.files.scene.schema import scene_schema

__all__ = ["Cell", "Row", "component_names", "default_of", "inspected_rows", "numbers_of", "object_of", "quaternion_of"]

Steps = tuple[str, ...]

_UNIT = re.compile(r"\[(?:[^\],]*, )?((?:(?:kg|rad|Hz|dB|px|mm|ms|m|s|N|W|J|V|%)(?:\^?\d|[²³])?[ /]?)+)\]")
"""Unit in a description; other words in brackets are names of the D2.1."""
_UPRIGHT = 1.0 - 1e-9
"""Sine of the angle about y beyond which the two others are one."""
_NONE = "none"
"""Choice of an optional part that is absent."""


@dataclass(frozen=True)
class Cell:
    """One value that can be changed.

    Attributes:
        steps: Pointer below the entity, unescaped.
        kind: "number", "whole" (number), "text", "choice", "switch", "json", "angle" (of the rotation) or "variant" (a
            choice whose value is the tag of an object).
        value: The value.
        low, high: Limits, None: none.
        above, below: Whether the limits themselves are excluded.
        choices: Values of a choice, or suggestions for a text; "none" removes the key.
        items: All numbers of the list whose item this is, where the file does not have them; of "angle" all three.
    """

    steps: Steps
    kind: Literal["number", "whole", "text", "choice", "switch", "json", "angle", "variant"]
    value: object
    low: float | None = None
    high: float | None = None
    above: bool = False
    below: bool = False
    choices: tuple[str, ...] = ()
    items: tuple[float, ...] = ()

    @property
    def shown(self) -> str:
        """The value as the page shows it, and as typing begins with it."""
        if self.value is None:
            return ""
        return self.value if isinstance(self.value, str) else source_of(self.value)

    @property
    def limits(self) -> str:
        """The limits in words, "" where there are none."""
        least = "" if self.low is None else f"{'above' if self.above else 'from'} {_plain(self.low)}"
        most = "" if self.high is None else f"{'below' if self.below else 'to'} {_plain(self.high)}"
        return " ".join(part for part in (least, most) if part)

    def written(self, typed: str) -> tuple[Steps, str | None]:
        """Return pointer and JSON of what was typed; None: the key goes.

        Raises:
            ValueError: It is no value of this kind, or out of its limits; the message is for the person.
        """
        if self.kind in ("number", "whole", "angle"):
            return self._number(typed.strip())
        if typed == _NONE and _NONE in self.choices:
            return self.steps, None
        if self.kind == "switch":
            return self.steps, "true" if typed in ("true", "on", "yes") else "false"
        if self.kind == "json":
            try:
                source = source_of(json.loads(typed))
                source.encode()
                return self.steps, source
            except ValueError:  # also of half a character, which no file can hold
                raise ValueError("is not JSON: lists in [ ], objects in { }, texts in quotation marks") from None
        if self.kind in ("choice", "variant") and typed not in self.choices:
            raise ValueError(f"is none of {', '.join(self.choices)}")
        return self.steps, source_of(default_of(*self.steps, tag=typed) if self.kind == "variant" else typed)

    def stepped(self, direction: int) -> str:
        """Return the next or previous value as if it was typed: of a number by a tenth of its decade."""
        if self.choices:
            at = self.choices.index(self.shown) if self.shown in self.choices else -(direction > 0)
            return self.choices[(at + direction) % len(self.choices)]
        if self.kind == "switch":
            return "false" if self.value else "true"
        if self.kind not in ("number", "whole", "angle") or not isinstance(self.value, int | float):
            return self.shown
        step = 1.0 if self.kind == "whole" else 5.0 if self.kind == "angle" else _step_of(self.value)
        value = round(self.value + direction * step, 9)
        return f"{value:.10g}" if not self._excess(value) else self.shown

    def _excess(self, value: float) -> str:
        """Return "small" or "large" for a number out of the limits, "" for others."""
        if self.low is not None and (value <= self.low if self.above else value < self.low):
            return "small"
        return "large" if self.high is not None and (value >= self.high if self.below else value > self.high) else ""

    def _number(self, typed: str) -> tuple[Steps, str]:
        try:
            value = json.loads(typed)
        except ValueError:
            value = None
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
            raise ValueError("is not a number")
        if self.kind == "whole" and not isinstance(value, int):
            raise ValueError("is not a whole number")
        excess = self._excess(value)
        if excess:
            raise ValueError(f"is too {excess}: {self.limits}")
        if not self.items:
            return self.steps, typed
        items = list(self.items)
        items[int(self.steps[-1])] = value
        written = quaternion_of(items) if self.kind == "angle" else items
        return self.steps[:-1], source_of(written)


@dataclass(frozen=True)
class Row:
    """One row of the inspector.

    Attributes:
        label: Key of the value, or name of the part.
        steps: Pointer below the entity, unescaped.
        depth: Nesting, 0 for the entity's own values.
        cells: Its values; () for a heading.
        help: Description from the schema.
        unit: Unit, "" for none.
        own: Whether the file has the value; otherwise it is a default, or a prefab's.
    """

    label: str
    steps: Steps
    depth: int
    cells: tuple[Cell, ...] = ()
    help: str = ""
    unit: str = ""
    own: bool = True


@cache
def _schema() -> dict[str, Any]:
    definitions: dict[str, Any] = scene_schema()["$defs"]
    return definitions


def object_of(value: object) -> Mapping[str, Any]:
    """Return an object of a file; an empty one where there is anything else, which is a fault or null."""
    return value if isinstance(value, Mapping) else {}


def component_names() -> list[str]:
    """Return the types of components, sorted."""
    return sorted(_schema()["EntitySpec"]["properties"]["components"]["properties"])


def default_of(*steps: str, tag: str = "") -> Any:
    """Return the smallest valid value at a pointer below an entity: what must be there and nothing else.

    Args:
        steps: Pointer, unescaped.
        tag: Tag of an object with variants; "": the first.
    """
    node: dict[str, Any] = {"$ref": "#/$defs/EntitySpec"}
    for step in steps:
        node = _resolved(node)
        node = _variants(node).get(step) or node.get("properties", {}).get(step) or node.get("items", {})
        if step != "components":
            node = _whole(node)
    return _smallest(node, tag)


def inspected_rows(
    own: Mapping[str, Any], present: Mapping[str, Any], names: Mapping[Steps, Sequence[str]]
) -> list[Row]:
    """Return the rows of an entity.

    Args:
        own: The entity as its file has it.
        present: Its transform and components with those of its prefab.
        names: Suggestions for texts that are names, by their pointer.
    """
    spec = _schema()["EntitySpec"]["properties"]
    rows = [row for key in ("id", "parent", "prefab") for row in _rows((key,), spec[key], own, own, 0)]
    rows += [row for key in own if is_comment(key) for row in _comment((key,), own)]
    rows.append(Row("transform", ("transform",), 0, help="Relative to the parent"))
    moved, base = object_of(own.get("transform")), object_of(present.get("transform"))
    for key, node in _schema()["TransformSpec"]["properties"].items():
        steps = ("transform", key)
        rows += [_turned(base, own=key in moved)] if key == "rotation" else _rows(steps, node, moved, base, 1)
    components, bases = object_of(own.get("components")), object_of(present.get("components"))
    for name in dict.fromkeys([*components, *bases]):
        node = spec["components"]["properties"].get(name)
        if node is not None and bases.get(name, components.get(name)) is not None:
            rows += _rows(("components", name), _whole(node), components, {**components, **bases}, 0)
    return [_named(row, names) for row in rows]


def numbers_of(value: object, otherwise: tuple[float, ...]) -> tuple[float, ...]:
    """Return the numbers of a list that has as many as `otherwise`, which counts instead of anything else."""
    numbers = tuple(value) if isinstance(value, list | tuple) else ()
    plain = all(isinstance(each, int | float) and abs(each) <= sys.float_info.max for each in numbers)
    return numbers if plain and len(numbers) == len(otherwise) else otherwise


def quaternion_of(degrees: Sequence[float]) -> list[float]:
    """Return a rotation about x, then y, then z of the parent [deg] as a unit quaternion x, y, z, w."""
    turns = [about_axis(axis, math.radians(angle)) for axis, angle in zip(np.eye(3), degrees, strict=True)]
    turned = product(product(turns[2], turns[1]), turns[0])
    return [round(float(part), 6) + 0.0 for part in (turned if turned[3] >= 0.0 else -turned)]


def _degrees_of(quaternion: Sequence[float]) -> tuple[float, ...]:
    """Return the inverse of `quaternion_of`, rounded to a hundredth."""
    x, y, z, w = (float(part) for part in quaternion)
    rise = 2 * (w * y - z * x)
    if abs(rise) > _UPRIGHT:  # turns about x and z are the same there: the latter is shown as zero
        angles = (2 * math.atan2(x, w), math.copysign(math.pi / 2, rise), 0.0)
    else:
        angles = (
            math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
            math.asin(rise),
            math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        )
    return tuple(round(math.degrees(angle), 2) + 0.0 for angle in angles)


def _turned(base: Mapping[str, Any], *, own: bool) -> Row:
    """Return the row of the rotation, in degrees: nobody types a quaternion."""
    quaternion = numbers_of(base.get("rotation"), (0.0, 0.0, 0.0, 1.0))
    angles = _degrees_of(quaternion)
    steps = ("transform", "rotation")
    cells = [Cell((*steps, str(n)), "angle", angle, -180.0, 180.0, items=angles) for n, angle in enumerate(angles)]
    help_text = "Rotation about x, then y, then z of the parent; the file has a quaternion"
    return Row("rotation", steps, 1, tuple(cells), help_text, "deg", own)


def _rows(steps: Steps, node: dict[str, Any], own: object, base: object, depth: int) -> Iterator[Row]:
    """Yield the rows of one key of an object, `own` as its file has it and `base` with what it inherits."""
    key, spec = steps[-1], _resolved(node)
    is_own = isinstance(own, list) or (isinstance(own, Mapping) and key in own)
    value = _at(base, key, node.get("default"))
    text = node.get("description", "") or spec.get("description", "")
    unit = _UNIT.search(text)
    row = Row(key, steps, depth, (), text, unit[1].replace("^2", "²").replace("^3", "³") if unit else "", is_own)
    variants, optional = _variants(spec), _optional(node)
    inner, inner_base = _at(own, key, {}), value if value is not None else {}
    if variants:
        tag = spec["discriminator"]["propertyName"]
        present = inner_base.get(tag) if isinstance(inner_base, Mapping) else None
        choices = (*([_NONE] if optional else []), *variants)
        yield replace(row, cells=(Cell(steps, "variant", present or _NONE, choices=choices),))
        spec = _resolved(variants.get(str(present), {}))
    elif "properties" in spec and (value is not None or not optional):
        yield row
    elif spec.get("type") == "array" and "properties" in _resolved(_first_variant(spec.get("items"))) and value:
        yield row
        for number in range(len(value)):
            yield from _rows((*steps, str(number)), spec["items"], inner or [], value, depth + 1)
        return
    else:
        yield replace(row, cells=_cells(steps, spec, value, choices=_NONE if optional else "", own=is_own))
        return
    yield from _inside(steps, spec, inner, inner_base, depth + 1)


def _inside(steps: Steps, spec: dict[str, Any], own: object, base: object, depth: int) -> Iterator[Row]:
    """Yield the rows of all keys of an object, with its comments."""
    if isinstance(own, Mapping):
        yield from (replace(row, depth=depth) for key in own if is_comment(key) for row in _comment((*steps, key), own))
    for key, node in spec.get("properties", {}).items():
        if node.get("enum") != [_at(base, key, None)]:  # not the tag
            yield from _rows((*steps, key), node, own, base, depth)


def _comment(steps: Steps, own: Mapping[str, Any]) -> Iterator[Row]:
    value = own[steps[-1]]
    kind: Literal["text", "json"] = "text" if isinstance(value, str) else "json"
    yield Row(steps[-1], steps, 0, (Cell(steps, kind, value),), "A comment of the author")


def _cells(steps: Steps, spec: dict[str, Any], value: object, choices: str, *, own: bool) -> tuple[Cell, ...]:
    """Return the cells of a value that is no object."""
    parts = [_resolved(part) for part in spec.get("prefixItems", ())]
    if parts and all(part.get("type") == "number" for part in parts):
        whole = value if isinstance(value, list | tuple) else ()
        given = len(whole) == len(parts)
        items = tuple(whole) if given else tuple(_smallest(part) for part in parts)
        return tuple(
            _number((*steps, str(n)), part, items[n] if given else None, () if own and given else items)
            for n, part in enumerate(parts)
        )
    kind = spec.get("type")
    if kind in ("number", "integer"):
        return (_number(steps, spec, value, ()),)
    if "enum" in spec:
        return (Cell(steps, "choice", value, choices=(*spec["enum"], *([choices] if choices else []))),)
    if kind in ("boolean", "string"):
        return (Cell(steps, "switch" if kind == "boolean" else "text", value),)
    return (Cell(steps, "json", value),)


def _number(steps: Steps, spec: dict[str, Any], value: object, items: tuple[float, ...]) -> Cell:
    above, below = "exclusiveMinimum" in spec, "exclusiveMaximum" in spec
    return Cell(
        steps,
        "whole" if spec.get("type") == "integer" else "number",
        value,
        spec.get("exclusiveMinimum", spec.get("minimum")),
        spec.get("exclusiveMaximum", spec.get("maximum")),
        above,
        below,
        items=items,
    )


def _named(row: Row, names: Mapping[Steps, Sequence[str]]) -> Row:
    if row.steps not in names:
        return row
    found = tuple(names[row.steps])
    choices = found if row.steps == ("id",) else (_NONE, *found)
    return replace(row, cells=tuple(replace(cell, choices=choices) for cell in row.cells))


def _at(value: object, key: str, otherwise: object) -> Any:
    if isinstance(value, list):
        return value[int(key)] if key.isdecimal() and int(key) < len(value) else otherwise
    return value.get(key, otherwise) if isinstance(value, Mapping) else otherwise


def _resolved(node: dict[str, Any]) -> dict[str, Any]:
    """Follow references, and take the value of what may be null."""
    while True:
        if "$ref" in node:
            node = _schema()[node["$ref"].rpartition("/")[2]]
        elif "anyOf" in node and "discriminator" not in node and _optional(node) and len(node["anyOf"]) == 2:
            node = next(each for each in node["anyOf"] if each.get("type") != "null")
        else:
            return node


def _optional(node: dict[str, Any]) -> bool:
    return any(each.get("type") == "null" for each in node.get("anyOf", ()))


def _variants(spec: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the definitions of an object with variants by their tags; {} for anything else."""
    mapping = spec.get("discriminator", {}).get("mapping", {})
    return {tag: {"$ref": place} for tag, place in mapping.items()}


def _first_variant(node: dict[str, Any] | bool | None) -> dict[str, Any]:
    spec = _resolved(node) if isinstance(node, dict) else {}
    return next(iter(_variants(spec).values()), spec)


def _whole(node: dict[str, Any]) -> dict[str, Any]:
    """Return the definition with its required keys, of one for parts that are merged over a prefab's."""
    spec = node if "$ref" in node else next((each for each in node.get("anyOf", ()) if "$ref" in each), node)
    if "$ref" not in spec or not spec["$ref"].endswith("Partial"):
        return node
    return {"$ref": spec["$ref"].removesuffix("Partial")}


def _smallest(node: dict[str, Any], tag: str = "") -> Any:
    """Return the smallest valid value of a definition."""
    spec = _resolved(node)
    if _variants(spec):
        chosen = tag or next(iter(_variants(spec)))
        inner = _smallest(_variants(spec)[chosen])
        return {spec["discriminator"]["propertyName"]: chosen, **inner}
    if "properties" in spec:
        return {key: _smallest(spec["properties"][key]) for key in spec.get("required", ())}
    if "prefixItems" in spec:
        return [_smallest(part) for part in spec["prefixItems"]]
    if "enum" in spec:
        return spec["enum"][0]
    kind = spec.get("type")
    if kind in ("number", "integer"):
        least = spec.get("minimum", 0.1 if "exclusiveMinimum" in spec else 0.0)
        return int(max(least, 1)) if kind == "integer" else max(float(least), 0.0)
    if kind == "array":
        return [_smallest(spec["items"]) for _ in range(spec.get("minItems", 0))]
    return {"boolean": False, "string": "", "object": {}}.get(str(kind))


def _plain(value: float) -> str:
    return f"{value:g}" if abs(value) < 1e5 else f"{value:,.0f}".replace(",", " ")


def _step_of(value: float) -> float:
    """Return a tenth of the decade of a number, a thousandth for those below a hundredth."""
    return 10.0 ** (math.floor(math.log10(max(abs(value), 0.01) * 1.0000001)) - 1)
