"""Carrying in the report: where the object was taken and released, and the grasp force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.report_section import Curve, Marks, ReportedAttempt, ReportSection, Traces, frontal

__all__ = ["CarrySection"]


class CarrySection(ReportSection):
    """Path of the empty hand blue, that of the hand with the object orange, the mark green.

    Facts under "carry": body, row, mark_world [m], within_m, grasp_n [N].
    """

    heading = "Carrying"
    colours = "The path of the empty hand is blue, that of the hand with the object orange, the mark green."
    path_error = "distance from the straight line"
    from_floor = True

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return isinstance(facts.get("carry"), Mapping)

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        return {
            "placed": (task.get("placed"), ""),
            "drops": (task.get("drops"), ""),
            "bruises": (task.get("bruises"), ""),
            "path of the hand": (task.get("path_m"), "m"),
            "grasp error": (task.get("grasp_error_n"), "N"),
        }

    def behind(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Curve]:
        mark, within = np.array(facts["carry"]["mark_world"], np.float64), float(facts["carry"]["within_m"])
        ends = np.array([[mark[0] - within, mark[1]], [mark[0] + within, mark[1]]])
        return [Curve(ends, "wall", "mark")]

    def hand(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Curve]:
        path, held = frontal(attempt), _is_held(attempt, facts)
        empty = np.where((attempt.free & ~held)[:, None], path, np.nan)
        full = np.where((attempt.free & held)[:, None], path, np.nan)
        name = f"{facts['carry']['body']} in the hand"
        return [Curve(empty, "robot", "hand, empty"), Curve(full, "carried", name)]

    def marks(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Marks]:
        held, path = _is_held(attempt, facts), frontal(attempt)
        changes = np.flatnonzero(np.diff(held.astype(np.int8)) != 0) + 1
        words = ["taken" if held[i] else "let go" for i in changes]
        hovers = [f"{word} at {attempt.samples['t'][i]:.1f} s" for word, i in zip(words, changes, strict=True)]
        return [Marks(path[changes], "taken, let go", hovers)]

    def traces(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Traces:
        samples = attempt.samples
        least, most = (np.full(len(samples), float(value)) for value in facts["carry"]["grasp_n"])
        grip = samples["f_grip"]
        return {
            "grip [N]": {
                "measured": ("grasp force", samples["grasp"]),
                "bisector": ("right at most", most),
                "wall": ("right at least", least),
            },
            "felt of it [N]": {
                "robot": ("upwards", grip[:, 1]),
                "normal": ("sideways", grip[:, 0]),
                "binormal": ("forwards", grip[:, 2]),
            },
        }


def _is_held(attempt: ReportedAttempt, facts: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Return where the object was in the hand, shape [n]."""
    held: NDArray[np.bool_] = attempt.samples["held_body"] == float(facts["carry"]["row"])
    return held
