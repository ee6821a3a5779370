"""The Method registry: every algorithm that has a rival, with its measured cost and its measured error.

A stage registers its rivals beside the code that implements them; the planner chooses the cheapest one inside a
scene's tolerance; `mimics lab` measures and draws them. The functions registered are the very objects the loop runs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

__all__ = ["Method", "Registry", "registry"]


@dataclass(frozen=True, slots=True)
class Method:
    """One way to do one thing.

    Attributes:
        group: What the rivals have in common, e.g. "tunnel projection".
        name: Its own name, unique in the group.
        source: One line: what it is and where it comes from.
        cost: Probe that returns the measured cost [us per call].
        error: Probe that returns the measured error in `unit` against a closed form or a brute-force reference.
        unit: Unit of the error, e.g. "m".
        valid_range: One line: where the method may be used.
        run: The function the product calls.
    """

    group: str
    name: str
    source: str
    cost: Callable[[], float]
    error: Callable[[], float]
    unit: str
    valid_range: str
    run: Callable[..., Any]


class Registry:
    """Methods by group, in the order they were registered."""

    def __init__(self) -> None:
        self._groups: dict[str, dict[str, Method]] = {}

    def register(self, method: Method) -> Method:
        """Add a method; ValueError when its group has one of that name already."""
        group = self._groups.setdefault(method.group, {})
        if method.name in group:
            raise ValueError(f'method "{method.name}" is registered twice in group "{method.group}"')
        group[method.name] = method
        return method

    def groups(self) -> list[str]:
        """Names of the groups."""
        return list(self._groups)

    def rivals(self, group: str) -> list[Method]:
        """The methods of a group; KeyError when there is none."""
        return list(self._groups[group].values())


registry = Registry()
"""The registry of this process; a stage's methods appear when its `methods` module is imported."""
