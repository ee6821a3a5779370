"""Which figures a task has: one that does not apply is left out of its rows, its totals, and what a person reads."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from mimics_app.tasks.tally import Measures
from mimics_app.tasks.task import ScoreSpec, TaskSpec

__all__ = ["Figures"]

_OF_A_WAY = ("path_error_rms_m", "path_error_max_m", "progress")
_OF_CARRYING = ("drops", "bruises", "grasp_error_n")


@dataclass(frozen=True, slots=True)
class Figures:
    """The kinds of figures of one task.

    Attributes:
        way: There is a way, along a tunnel or to a mark: its progress and the distance from it are measured.
        carries: Something is carried.
        score: Trials earn points. The built-in score judges a way; without one the task must state its own.
    """

    way: bool
    carries: bool
    score: bool

    @classmethod
    def of(cls, spec: TaskSpec, *, tunnel: bool) -> Figures:
        """Those of a task, in a scene with a tunnel or without."""
        carries = spec.carry is not None
        way = tunnel or carries
        return cls(way, carries, score=way or spec.score != ScoreSpec())

    def row(self, measures: Measures) -> dict[str, Any]:
        """The measures that apply, by their names."""
        left_out = {*(() if self.way else _OF_A_WAY), *(() if self.carries else _OF_CARRYING)}
        return {name: value for name, value in asdict(measures).items() if name not in left_out}
