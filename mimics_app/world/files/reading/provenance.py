"""Origins of the values of a resolved scene: file, and pointer in it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["Layer", "Origins", "merged"]

_INDEX = re.compile(r"[0-9]{1,9}")


@dataclass(frozen=True, eq=False)
class Layer:
    """One source of a value.

    Attributes:
        file: Name in messages.
        folder: Base folder of relative file names in it.
        pointer: JSON pointer in that file.
        value: Value at that pointer.
    """

    file: str
    folder: Path
    pointer: str
    value: Any

    def child(self, key: str, value: object) -> Layer:
        """Return the layer of a part of the value; `key` is an escaped step of a pointer."""
        return Layer(self.file, self.folder, f"{self.pointer}/{key}", value)


class Origins:
    """Layers of each part of the resolved document, strongest first, by its pointer there."""

    def __init__(self, document: Layer) -> None:
        self._layers: dict[str, list[Layer]] = {"": [document]}

    def set(self, pointer: str, layers: list[Layer]) -> None:
        """Set the layers of the value at `pointer`."""
        self._layers[pointer] = layers

    def locate(self, pointer: str) -> Layer:
        """Return the layer that a value of the resolved document was written in.

        It is the strongest layer with the whole path; where none has it (a missing key), the one with most of it.
        """
        prefix = pointer
        while prefix not in self._layers:
            prefix = prefix.rpartition("/")[0]
        steps = pointer[len(prefix) :].split("/")[1:]
        layers = self._layers[prefix]
        best, depth = layers[0], -1
        for layer in layers:
            reached = _depth(layer.value, steps)
            if reached > depth:
                best, depth = layer, reached
        tail = "/".join(steps)
        return best.child(tail, None) if tail else best


def merged(low: object, high: object) -> Any:
    """Merge `high` over `low`: objects key by key, all else replaced; null removes a key."""
    if not (isinstance(low, dict) and isinstance(high, dict)):
        return high
    result = dict(low)
    for key, value in high.items():
        if value is None:
            result.pop(key, None)
        else:
            result[key] = merged(result.get(key), value)
    return result


def _depth(value: object, steps: list[str]) -> int:
    """Return the number of steps of a pointer that exist."""
    for done, step in enumerate(steps):
        key = step.replace("~1", "/").replace("~0", "~")
        if isinstance(value, dict) and key in value:
            value = value[key]
        elif isinstance(value, list) and _INDEX.fullmatch(key) and int(key) < len(value):
            value = value[int(key)]
        else:
            return done
    return len(steps)
