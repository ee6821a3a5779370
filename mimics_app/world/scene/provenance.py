"""Where each value of a resolved scene was written: which file, and which pointer in it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["Layer", "Origins", "merged"]


@dataclass(frozen=True, eq=False)
class Layer:
    """One place that contributes to a value.

    Attributes:
        file: As shown to people.
        folder: Folder relative file names in it are relative to.
        pointer: JSON pointer in that file.
        value: What stands there.
    """

    file: str
    folder: Path
    pointer: str
    value: Any

    def child(self, key: str, value: Any) -> Layer:
        """The layer of a part of the value; `key` is a step of a pointer already."""
        return Layer(self.file, self.folder, f"{self.pointer}/{key}", value)


class Origins:
    """Layers of each part of the resolved document, strongest first, by its pointer there."""

    def __init__(self, document: Layer) -> None:
        self._layers: dict[str, list[Layer]] = {"": [document]}

    def set(self, pointer: str, layers: list[Layer]) -> None:
        """Say what the value at `pointer` was made of."""
        self._layers[pointer] = layers

    def locate(self, pointer: str) -> Layer:
        """Where the value at a pointer of the resolved document was written.

        The strongest layer that holds the whole path; where none does (a key that is missing), the one that holds
        most of it.
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


def merged(low: Any, high: Any) -> Any:
    """`high` laid over `low`: objects key by key, everything else replaced; null takes a key away."""
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
    """How many steps of a pointer lead to something."""
    for done, step in enumerate(steps):
        key = step.replace("~1", "/").replace("~0", "~")
        if isinstance(value, dict) and key in value:
            value = value[key]
        elif isinstance(value, list) and key.isdigit() and int(key) < len(value):
            value = value[int(key)]
        else:
            return done
    return len(steps)
