"""Carrying in the report: where the object was taken and released, and the grasp force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.report_section import (
    Marks,
    PlottedCurve,
    ReportedAttempt,
    ReportSection,
    Traces,
    frontal,
)
from mimics_app.contracts.system.phrases import phrase

__all__ = ["CarrySection"]


class CarrySection(ReportSection):
    """Path of the empty hand blue, that of the hand with the object orange, mark and obstacles green.

    Facts under "carry": body, row, mark_world [m], within_m, grasp_n [N]; above_m: height of the middle of the object
    above what it lies on [m]; obstacles: left, bottom, right, top of each [m]. Older recordings lack the last two.
    """

    heading = phrase("Carrying")
    colours = phrase(
        "The path of the empty hand is blue, that of the hand with the object orange. Green is where the middle of the "
        "object lies at its mark, and the outline of the obstacles."
    )
    path_error = phrase("distance from the straight line")
    from_floor = True

    def takes(self, facts: Mapping[str, Any], attempts: Sequence[ReportedAttempt]) -> bool:
        return isinstance(facts.get("carry"), Mapping)

    def tiles(self, task: Mapping[str, Any]) -> Mapping[str, tuple[Any, str]]:
        return {
            phrase("placed"): (task.get("placed"), ""),
            phrase("drops"): (task.get("drops"), ""),
            phrase("bruises"): (task.get("bruises"), ""),
            phrase("path of the hand"): (task.get("path_m"), "m"),
            phrase("grip force off its target"): (task.get("grasp_error_n"), "N"),
        }

    def behind(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[PlottedCurve]:
        carry = facts["carry"]
        mark, within = np.array(carry["mark_world"], np.float64), float(carry["within_m"])
        height = mark[1] + float(carry.get("above_m", 0.0))
        ends = np.array([[mark[0] - within, height], [mark[0] + within, height]])
        shown = int(attempt.row.get("parameter.obstacles", len(carry.get("obstacles", ()))))
        outlines = [_outline(box) for box in carry.get("obstacles", ())[:shown]]
        labels = [phrase("obstacle"), *[""] * len(outlines)]
        return [
            PlottedCurve(ends, "wall", phrase("mark")),
            *(PlottedCurve(o, "wall", label) for o, label in zip(outlines, labels, strict=False)),
        ]

    def hand(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[PlottedCurve]:
        path, held = frontal(attempt), _is_held(attempt, facts)
        empty = np.where((attempt.free & ~held)[:, None], path, np.nan)
        full = np.where((attempt.free & held)[:, None], path, np.nan)
        name = phrase("{body:s} in the hand", body=str(facts["carry"]["body"]).replace("_", " "))
        return [PlottedCurve(empty, "robot", phrase("hand, empty")), PlottedCurve(full, "carried", name)]

    def marks(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Sequence[Marks]:
        held, path = _is_held(attempt, facts), frontal(attempt)
        changes = np.flatnonzero(np.diff(held.astype(np.int8)) != 0) + 1
        words = [phrase("taken") if held[i] else phrase("let go") for i in changes]
        hovers = [
            phrase("{what:s} at {seconds:.1f} s", what=word, seconds=float(attempt.samples["t"][i]))
            for word, i in zip(words, changes, strict=True)
        ]
        return [Marks(path[changes], phrase("taken, let go"), hovers)]

    def traces(self, attempt: ReportedAttempt, facts: Mapping[str, Any]) -> Traces:
        samples = attempt.samples
        least, most = (np.full(len(samples), float(value)) for value in facts["carry"]["grasp_n"])
        grip = samples["f_grip"]
        return {
            phrase("grip [N]"): {
                "measured": (phrase("grasp force"), samples["grasp"]),
                "bisector": (phrase("right at most"), most),
                "wall": (phrase("right at least"), least),
            },
            phrase("felt of it [N]"): {
                "robot": (phrase("upwards"), grip[:, 1]),
                "normal": (phrase("sideways"), grip[:, 0]),
                "binormal": (phrase("forwards"), grip[:, 2]),
            },
        }


def _outline(box: Sequence[float]) -> F8:
    left, bottom, right, top = box
    corners = [[left, bottom], [left, top], [right, top], [right, bottom], [left, bottom]]
    return np.array(corners, np.float64)


def _is_held(attempt: ReportedAttempt, facts: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Return where the object was in the hand, shape [n]."""
    held: NDArray[np.bool_] = attempt.samples["held_body"] == float(facts["carry"]["row"])
    return held
