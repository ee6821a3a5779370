"""Registration of a group of methods from a table: rivals that share probes of cost and error."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

from mimics_app.contracts.ports.methods import Group, Method, Settings, registry
from mimics_app.lab.probe import reference_us

__all__ = ["Growth", "Probes", "Rival", "compare", "group_of"]

Probe = Callable[..., float]


@dataclass(frozen=True, slots=True)
class Rival:
    """One method of a group.

    Attributes:
        name, source, valid_range, settings: As in `Method`; without settings it is a yardstick.
        probed: Arguments of the probes; (): its name.
        sizes: Sizes of the work at which its growth is measured, ascending; None: those of the group.
        cost, error: Its own probes, without arguments; None: those of the group.
    """

    name: str
    source: str
    valid_range: str
    settings: Settings | None = None
    probed: tuple[object, ...] = ()
    sizes: tuple[int, ...] | None = None
    cost: Callable[[], float] | None = None
    error: Callable[[], float] | None = None


@dataclass(frozen=True, slots=True)
class Probes:
    """What measures the rivals of a group.

    Attributes:
        cost: Probe of the cost [us per call]; called with `Rival.probed`, and a size of the work where there are sizes.
        error: Probe of the error in the group's unit; called with `Rival.probed`.
        reference: Probe of the reference loop [us per call].
    """

    cost: Probe
    error: Probe
    reference: Callable[[], float] = reference_us


@dataclass(frozen=True, slots=True)
class Growth:
    """Sizes of the work with which a cost grows.

    Attributes:
        work: Unit of the sizes; "" where the cost does not grow.
        sizes: Sizes at which growth is measured, ascending; () where it does not grow.
        typical: Size at which the costs are compared.
    """

    work: str = ""
    sizes: tuple[int, ...] = ()
    typical: int = 1


_EVEN = Growth()


def group_of(module: str) -> str:
    """Return the group that a module of the package `groups` registers, by the name of the module."""
    return module.rpartition(".")[2].replace("_", " ")


def compare(
    module: str,
    what: str,
    unit: str,
    rivals: Iterable[Rival],
    probes: Probes,
    *,
    default: str,
    growth: Growth = _EVEN,
    few: str = "",
    why_default: str = "",
) -> None:
    """Describe a group and register its rivals.

    Args:
        module: `__name__` of the group's module, which is named like the group.
        what: One line: task of the methods, and input of the measurement.
        unit: Unit of the error.
        rivals: The methods, in the order of the charts.
        probes: What measures them.
        default: Name of the default method of the product.
        growth: Sizes of the work with which the cost grows.
        few: Reason for fewer than three rivals; "" otherwise.
        why_default: Reason for a default that a rival beats in cost at no larger error; "" otherwise.
    """
    group = group_of(module)
    registry.describe(Group(group, what, unit, growth.work, probes.reference, few, why_default))
    for rival in rivals:
        probed, own = rival.probed or (rival.name,), growth.sizes if rival.sizes is None else rival.sizes
        grown = partial(probes.cost, *probed)
        registry.register(
            Method(
                group=group,
                name=rival.name,
                source=rival.source,
                cost=rival.cost or (partial(grown, growth.typical) if growth.sizes else grown),
                error=rival.error or partial(probes.error, *probed),
                unit=unit,
                valid_range=rival.valid_range,
                settings=rival.settings,
                default=rival.name == default,
                growth=grown if own else None,
                sizes=own,
            )
        )
