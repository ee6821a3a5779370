"""Rivals that one compiled probe distinguishes by their number: a probe's loop cannot be handed a function to run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from mimics_app.contracts.methods import Group, Method, Settings, registry

__all__ = ["NumberedRival", "register_numbered"]


@dataclass(frozen=True, slots=True)
class NumberedRival:
    """One of them; its number is its place in the list.

    Attributes:
        name, source, valid_range, settings: As in `Method`.
        sizes: Of the work at which its growth is measured, ascending.
    """

    name: str
    source: str
    valid_range: str
    settings: Settings | None
    sizes: tuple[int, ...]


def register_numbered(
    group: Group,
    rivals: Sequence[NumberedRival],
    cost: Callable[[int, int], float],
    error: Callable[[int], float],
    typical: int,
) -> None:
    """Describe a group and register its rivals; the first is the one the product uses by default.

    Args:
        group: What they are for.
        rivals: Number 0 first.
        cost: Cost [us per call] of a number at a size of the work.
        error: Error of a number, in the group's unit.
        typical: Size at which their costs are compared.
    """
    registry.describe(group)
    for number, rival in enumerate(rivals):
        registry.register(
            Method(
                group=group.name,
                name=rival.name,
                source=rival.source,
                cost=partial(cost, number, typical),
                error=partial(error, number),
                unit=group.unit,
                valid_range=rival.valid_range,
                settings=rival.settings,
                default=number == 0,
                growth=partial(cost, number),
                sizes=rival.sizes,
            )
        )
