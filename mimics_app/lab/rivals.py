"""Rivals that one pair of probes measures: a table of them becomes a group of the registry."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

from mimics_app.contracts.methods import Group, Method, Settings, registry
from mimics_app.contracts.probe import reference_us

__all__ = ["Rival", "compare"]

Probe = Callable[..., float]


@dataclass(frozen=True, slots=True)
class Rival:
    """One method of a group.

    Attributes:
        name, source, valid_range, settings: As in `Method`; without settings it is a yardstick.
        probed: What the probes are called with; () stands for its name.
        sizes: Of the work at which its growth is measured, ascending; None: those of the group.
        cost, error: Probes of its own, which are called with nothing; None: those of the group.
    """

    name: str
    source: str
    valid_range: str
    settings: Settings | None = None
    probed: tuple[object, ...] = ()
    sizes: tuple[int, ...] | None = None
    cost: Callable[[], float] | None = None
    error: Callable[[], float] | None = None


def compare(
    group: str,
    what: str,
    unit: str,
    rivals: Iterable[Rival],
    *,
    cost: Probe,
    error: Probe,
    default: str,
    work: str = "",
    sizes: tuple[int, ...] = (),
    typical: int = 1,
    reference: Callable[[], float] = reference_us,
    few: str = "",
    why_default: str = "",
) -> None:
    """Describe a group and register its rivals.

    Args:
        group: Its name.
        what: The job all of them do, and on which input they are measured, one line.
        unit: Of the error.
        rivals: In the order of the charts.
        cost: Cost [us per call] of what a rival is probed with, and of a size of the work where it has sizes.
        error: Error of what a rival is probed with, in `unit`.
        default: Name of the rival that the product uses.
        work: What a size counts; "" where the cost does not grow.
        sizes: Of the work at which growth is measured, ascending; () where it does not grow.
        typical: Size at which the costs are compared.
        reference: Probe of the reference loop [us per call].
        few: Why no third rival is measured; "" where there are three.
        why_default: Why the default stands though a rival costs less at no greater error; "" where none does.
    """
    registry.describe(Group(group, what, unit, work, reference, few, why_default))
    for rival in rivals:
        probed, own = rival.probed or (rival.name,), sizes if rival.sizes is None else rival.sizes
        grown = partial(cost, *probed)
        registry.register(
            Method(
                group=group,
                name=rival.name,
                source=rival.source,
                cost=rival.cost or (partial(grown, typical) if sizes else grown),
                error=rival.error or partial(error, *probed),
                unit=unit,
                valid_range=rival.valid_range,
                settings=rival.settings,
                default=rival.name == default,
                growth=grown if own else None,
                sizes=own,
            )
        )
