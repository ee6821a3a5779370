"""The Method registry: every algorithm that has a rival, with its measured cost and its measured error.

A stage registers its rivals beside the code that implements them; the planner chooses the cheapest one inside a
scene's tolerance and hands its settings on; `mimics lab` measures and draws them. Probes call the very functions that
the loop runs. Names are for people: nothing is decided by them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

__all__ = ["Group", "Method", "Registry", "Settings", "registry"]

Settings = Mapping[str, object]
"""What the product sets to run a method: values of JSON by field, in the words of the scene's own settings."""


@dataclass(frozen=True, slots=True)
class Method:
    """One method to do one thing.

    Attributes:
        group: What the rivals have in common, e.g. "tunnel projection".
        name: Its own name, unique in the group.
        source: One line: what it is and where it comes from.
        cost: Probe that returns the measured cost [us per call].
        error: Probe that returns the measured error in `unit` against a closed form or a brute-force reference.
        unit: Unit of the error, e.g. "m".
        valid_range: One line: where the method may be used.
        default: What the product uses unless a scene or the planner says otherwise; at most one of a group.
        settings: What makes the product run it; {} where it runs it always. None: the product cannot run it, and it is
            a yardstick, measured and drawn beside the others but never chosen.
        growth: Probe of the cost [us per call] when the work has a given size; None where it does not grow.
        sizes: Sizes of the work to measure the growth at, ascending; what they count is the group's `work`.
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

    @property
    def runnable(self) -> bool:
        """Whether the product can run it; a yardstick otherwise."""
        return self.settings is not None


@dataclass(frozen=True, slots=True)
class Group:
    """What the rivals of a group are for, and the yardstick their costs are compared with.

    Attributes:
        name: As in `Method.group`.
        what: One line: the job all of them do, and on which input they are measured.
        unit: Unit of the error, as in `Method.unit`.
        work: What a size counts, e.g. "pieces of the tunnel"; "" where the cost does not grow.
        reference: Probe of the group's reference loop [us per call], run right before the rivals so that the ratio
            holds on any machine.
        few: Why no third rival is measured; "" where there are three.
        why_default: Why the default stands though a rival costs less at no greater error; "" where none does.
    """

    name: str
    what: str
    unit: str
    work: str
    reference: Callable[[], float]
    few: str = ""
    why_default: str = ""


class Registry:
    """Methods by group, in the order they were registered; imports nothing: `lab.catalogue` loads the stages' ones."""

    def __init__(self) -> None:
        self._groups: dict[str, dict[str, Method]] = {}
        self._described: dict[str, Group] = {}

    def describe(self, group: Group) -> Group:
        """Say what a group is for; ValueError when it has been said already."""
        if group.name in self._described:
            raise ValueError(f'group "{group.name}" is described twice')
        self._described[group.name] = group
        return group

    def register(self, method: Method) -> Method:
        """Add a method; ValueError when its group has one of that name already."""
        group = self._groups.setdefault(method.group, {})
        if method.default and any(rival.default for rival in group.values()):
            raise ValueError(f'group "{method.group}" has two defaults, the second is "{method.name}"')
        if method.default and not method.runnable:
            raise ValueError(f'the product cannot run "{method.name}", the default of group "{method.group}"')
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

    def described(self, group: str) -> Group:
        """The description of a group; KeyError when there is none."""
        return self._described[group]

    def default(self, group: str) -> Method | None:
        """The method of a group that the product uses by default, None where none is marked; KeyError: no group."""
        return next((method for method in self._groups[group].values() if method.default), None)


registry = Registry()
"""The registry of this process; a stage's methods appear when its `methods` module is imported."""
