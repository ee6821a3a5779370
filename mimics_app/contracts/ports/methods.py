"""Registry of methods: every algorithm with alternatives, with its measured cost and error.

A stage registers its methods beside the code that implements them; the planner chooses the cheapest one within a
scene's tolerance and passes its settings on; `mimics lab` measures and draws them. Probes call the same functions as
the loop. Names are for display only: no decision depends on them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

__all__ = ["Group", "Method", "Registry", "Settings", "registry"]

Settings = Mapping[str, object]
"""Settings that select a method: JSON values by field, with the names and values of scene settings."""


@dataclass(frozen=True, slots=True)
class Method:
    """One method of a group.

    Attributes:
        group: Task of the methods, e.g. "tunnel projection".
        name: Name, unique in the group.
        source: One line: description and source.
        cost: Probe of the cost [us per call].
        error: Probe of the error in `unit` against a closed form or a brute-force reference.
        unit: Unit of the error, e.g. "m".
        valid_range: One line: range of validity.
        default: True for the default without a setting of the scene or the planner; at most one per group.
        settings: Settings that make the product run it; {}: it always runs. None: the product cannot run it; a
            yardstick that is measured and drawn beside the others but never chosen.
        growth: Probe of the cost [us per call] at a size of the work; None if the cost is constant.
        sizes: Sizes for `growth`, ascending, in units of the group's `work`.
        package: Module of the package that registered it; "" where it is built in.
    """

    group: str
    name: str
    source: str
    cost: Callable[[], float]
    error: Callable[[], float]
    unit: str
    valid_range: str
    settings: Settings | None
    default: bool = False
    growth: Callable[[int], float] | None = None
    sizes: tuple[int, ...] = ()
    package: str = ""

    @property
    def runnable(self) -> bool:
        """Whether the product can run it; otherwise it is a yardstick."""
        return self.settings is not None


@dataclass(frozen=True, slots=True)
class Group:
    """Description of a group of methods.

    Attributes:
        name: Name, as in `Method.group`.
        what: One line: the task of the methods, and the input of the measurement.
        unit: Unit of the error, as in `Method.unit`.
        work: Unit of the sizes, e.g. "pieces of the tunnel"; "" if the cost is constant.
        reference: Probe of the group's reference loop [us per call], run right before the methods, so that the ratio
            holds on any machine.
        few: Reason for fewer than three methods; "" otherwise.
        why_default: Reason for a default that another method beats in cost at no larger error; "" otherwise.
    """

    name: str
    what: str
    unit: str
    work: str
    reference: Callable[[], float]
    few: str = ""
    why_default: str = ""


class Registry:
    """Methods by group, in the order of registration; `lab.catalogue` imports the modules that register them."""

    def __init__(self) -> None:
        self._groups: dict[str, dict[str, Method]] = {}
        self._described: dict[str, Group] = {}

    def describe(self, group: Group) -> Group:
        """Add the description of a group; ValueError if it has one."""
        if group.name in self._described:
            raise ValueError(f'group "{group.name}" is described twice')
        self._described[group.name] = group
        return group

    def register(self, method: Method) -> Method:
        """Add a method; ValueError for a duplicate name, a second default, or a default that cannot run."""
        group = self._groups.setdefault(method.group, {})
        if method.default and any(rival.default for rival in group.values()):
            raise ValueError(f'group "{method.group}" has two defaults, the second is "{method.name}"')
        if method.default and not method.runnable:
            raise ValueError(f'the product cannot run "{method.name}", the default of group "{method.group}"')
        if method.name in group:
            raise ValueError(f'method "{method.name}" is registered twice in group "{method.group}"')
        group[method.name] = method
        return method

    def take(self, group: str, register: Callable[[Registry], None]) -> None:
        """Let a package register its methods of a group; after any exception, nothing of them is here.

        Raises:
            ValueError: The group has no description, or no method.
            Exception: Whatever the package raises.
        """
        trial = Registry()
        trial._groups = {name: dict(methods) for name, methods in self._groups.items()}
        trial._described = dict(self._described)
        register(trial)
        if group not in trial._described or not trial._groups.get(group):
            raise ValueError(f'group "{group}" has no description, or no method')
        for name, methods in trial._groups.items():
            known = self._groups.get(name, {})
            trial._groups[name] = {
                key: method if key in known else replace(method, package=register.__module__)
                for key, method in methods.items()
            }
        self._groups, self._described = trial._groups, trial._described

    def groups(self) -> list[str]:
        """Return the names of the groups."""
        return list(self._groups)

    def rivals(self, group: str) -> list[Method]:
        """Return the methods of a group; KeyError for an unknown group."""
        return list(self._groups[group].values())

    def described(self, group: str) -> Group:
        """Return the description of a group; KeyError if it has none."""
        return self._described[group]

    def default(self, group: str) -> Method | None:
        """Return the default method of a group, or None; KeyError for an unknown group."""
        return next((method for method in self._groups[group].values() if method.default), None)


registry = Registry()
"""Registry of this process; a stage registers its methods when its `methods` module is imported."""
