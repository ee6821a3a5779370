"""Detection of the robot's arrival at the start of a trial."""

from __future__ import annotations

from itertools import chain, repeat

from mimics_app.tasks.observation import Observation
from mimics_app.tasks.task import StartSpec

__all__ = ["Arrival"]


class Arrival:
    """Arrival: the joint errors are within tolerance for the hold time, while the robot follows its controller."""

    def __init__(self, spec: StartSpec, start_joints: tuple[float, ...]) -> None:
        self._spec = spec
        self._start = start_joints
        self._since_ns: int | None = None

    def restart(self) -> None:
        """Reset at the beginning of an approach."""
        self._since_ns = None

    def reached(self, seen: Observation) -> bool:
        """Whether the robot has arrived by this frame. Call once per frame of an approach."""
        errors = (abs(q - start) for q, start in zip(seen.q, self._start, strict=True))
        most = chain(self._spec.tolerance, repeat(self._spec.tolerance[-1]))
        near = all(error <= limit for error, limit in zip(errors, most, strict=False))
        if not (near and seen.movable):
            self._since_ns = None
            return False
        if self._since_ns is None:
            self._since_ns = seen.now_ns
        return (seen.now_ns - self._since_ns) / 1e9 >= self._spec.hold_s
