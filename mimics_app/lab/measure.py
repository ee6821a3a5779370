"""Measurement of a group of methods: cost relative to a reference loop, error, and growth of the cost with the work."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mimics_app.contracts.errors import MimicsError, short_text
from mimics_app.contracts.ports.method_table import Row, Table
from mimics_app.contracts.ports.methods import Group, Method, Registry
from mimics_app.lab.measured_on import measured_on

__all__ = ["Growth", "Measured", "MeasuredGroup", "as_dict", "count_probes", "fit_exponent", "measure", "to_table"]

Step = Callable[[str], None]
"""Called with a description of the next measurement."""


@dataclass(frozen=True, slots=True)
class Growth:
    """Growth of a method's cost.

    Attributes:
        sizes: Sizes of the work, ascending.
        cost_us: Cost at each size [us per call].
        exponent: Exponent p of cost ~ size^p by least squares of the logarithms.
    """

    sizes: tuple[int, ...]
    cost_us: tuple[float, ...]
    exponent: float


@dataclass(frozen=True, slots=True)
class Measured:
    """Measured cost and error of a method.

    Attributes:
        method: The entry of the registry.
        cost_us: Cost [us per call].
        ratio: Cost as a multiple of the reference loop, timed immediately before and after.
        error: Error in the method's unit; infinite where it fails.
        growth: Growth of the cost; None where it has no probe.
        spread_us: Smallest and largest cost over the rounds [us per call]; both 0 after a single round.
    """

    method: Method
    cost_us: float
    ratio: float
    error: float
    growth: Growth | None
    spread_us: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class MeasuredGroup:
    """Measurements of a group.

    Attributes:
        group: Description of the group.
        reference_us: Smallest cost of the reference loop [us per call].
        rows: Measurements of the methods that can run on this machine, in the order of the registry.
        skipped: Reason why a method could not be measured, by its name.
    """

    group: Group
    reference_us: float
    rows: list[Measured]
    skipped: dict[str, str] = field(default_factory=dict)

    @property
    def default(self) -> str:
        """Name of the default method of the product; "" for none."""
        return next((row.method.name for row in self.rows if row.method.default), "")


def count_probes(registry: Registry, groups: Sequence[str], rounds: int = 1) -> int:
    """Return the number of calls of `step` by `measure` for these groups."""
    return sum(rounds * (1 + len(method.sizes)) for group in groups for method in registry.rivals(group))


def measure(group: str, registry: Registry, step: Step = lambda _: None, rounds: int = 1) -> MeasuredGroup:
    """Measure every method of a group, with the reference loop before and after each.

    A method whose probes raise a MimicsError cannot run on this machine and is skipped, as is one of a package whose
    probes raise anything.

    Args:
        group: Name of the group, whose module has been imported.
        registry: Registry of the group.
        step: Called with a description before each probe.
        rounds: Number of measurements of the whole group. The smallest of each cost counts: other load on the machine
            only adds to it.

    Raises:
        KeyError: The group is unknown, or it has no description.
    """
    passes = [_measure_once(group, registry, step, first=not number) for number in range(rounds)]
    by_name = [{row.method.name: row for row in one.rows} for one in passes]
    rows = [_least([one[name] for one in by_name if name in one]) for name in by_name[0]]
    return replace(passes[0], reference_us=min(one.reference_us for one in passes), rows=rows)


def _measure_once(group: str, registry: Registry, step: Step, *, first: bool) -> MeasuredGroup:
    described, rivals = registry.described(group), registry.rivals(group)
    measured, skipped = list[Measured](), dict[str, str]()
    try:
        before = shortest = described.reference()
    except (Exception, SystemExit) as failure:  # noqa: BLE001 a third-party probe may raise anything
        return MeasuredGroup(described, math.nan, [], {one.name: _why_skipped(one, failure) for one in rivals})
    for method in rivals:
        step(f"{group}: {method.name}")
        try:
            cost = _time_of(method.cost())
            error = _size_of(method.error()) if first else math.inf
            after = described.reference()
            growth = _growth(method, step)
        except (Exception, SystemExit) as failure:  # noqa: BLE001 a third-party probe may raise anything
            skipped[method.name] = _why_skipped(method, failure)
            continue
        measured.append(Measured(method, cost, cost / min(before, after), error, growth))
        shortest, before = min(shortest, before, after), after
    return MeasuredGroup(described, shortest, measured, skipped)


def _why_skipped(method: Method, failure: BaseException) -> str:
    """Return why a method is skipped; a built-in probe must not raise anything but a MimicsError."""
    if isinstance(failure, MimicsError):
        return str(failure)
    if not method.package:
        raise failure
    why = short_text(" ".join(f"{type(failure).__name__}: {failure}".split()))
    return f"the probes of {method.package} fail: {why}"


def _least(rows: Sequence[Measured]) -> Measured:
    """Return the rounds of a method as one measurement: the error of the first, and the smallest of each cost."""
    first, grown = rows[0], [row.growth for row in rows if row.growth is not None]
    growth = first.growth
    if growth is not None and len(grown) > 1:
        least = tuple(min(one) for one in zip(*(each.cost_us for each in grown), strict=True))
        growth = Growth(growth.sizes, least, fit_exponent(growth.sizes, least))
    costs = [row.cost_us for row in rows]
    spread = (min(costs), max(costs)) if len(costs) > 1 else first.spread_us
    ratio = min(row.ratio for row in rows)
    return replace(first, cost_us=min(costs), ratio=ratio, growth=growth, spread_us=spread)


def _time_of(cost: float) -> float:
    """Return a cost; raises ValueError where it is no duration: the planner would choose it before all others."""
    if not 0.0 < cost < math.inf:
        raise ValueError(f"a cost of {cost} us")
    return float(cost)


def _size_of(error: float) -> float:
    """Return the magnitude of an error; NaN is a failure, hence infinite."""
    return math.inf if math.isnan(error) else abs(float(error))


def _growth(method: Method, step: Step) -> Growth | None:
    if method.growth is None or len(method.sizes) < 2:
        return None
    costs = []
    for size in method.sizes:
        step(f"{method.group}: {method.name}, {size}")
        costs.append(method.growth(size))
    return Growth(method.sizes, tuple(costs), fit_exponent(method.sizes, costs))


def fit_exponent(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """Return the exponent p of cost = c * size^p by least squares of the logarithms.

    Raises:
        ValueError: Fewer than two different sizes, or a value that is not positive.
    """
    if len(set(sizes)) < 2 or min(*sizes, *costs) <= 0.0:
        raise ValueError(f"no exponent from sizes {list(sizes)} and costs {list(costs)}")
    x, y = [math.log(size) for size in sizes], [math.log(cost) for cost in costs]
    middle = sum(x) / len(x)
    return sum((a - middle) * b for a, b in zip(x, y, strict=True)) / sum((a - middle) ** 2 for a in x)


def to_table(groups: Sequence[MeasuredGroup]) -> Table:
    """Return the table of the planner: the measurements of the methods that the product can run."""
    groups = [one for one in groups if one.rows]
    return Table(
        groups={one.group.name: [_table_row(row) for row in one.rows if row.method.runnable] for one in groups},
        machine=measured_on().as_dict(),
        reference_us={one.group.name: one.reference_us for one in groups},
    )


def _table_row(row: Measured) -> Row:
    return Row(row.method.name, row.cost_us, row.ratio, row.error, row.method.unit, row.method.settings or {})


def as_dict(measured: MeasuredGroup) -> dict[str, Any]:
    """Return plain values for `--json`, None where one does not apply."""
    rows = [
        {
            "method": row.method.name,
            "cost_us": row.cost_us,
            "ratio": row.ratio,
            "error": row.error,
            "unit": row.method.unit,
            "default": row.method.default,
            "settings": row.method.settings,
            "exponent": row.growth.exponent if row.growth else None,
            "growth": list(zip(row.growth.sizes, row.growth.cost_us, strict=True)) if row.growth else None,
        }
        for row in measured.rows
    ]
    return {"reference_us": measured.reference_us, "rows": rows, "skipped": measured.skipped}
