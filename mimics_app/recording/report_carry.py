"""The report of a run in which something is carried: where it was taken and set down, and how it was gripped."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.plotting.axis import Axis
from mimics_app.plotting.plot import Plot
from mimics_app.recording.attempts import Attempt
from mimics_app.recording.run import Run

__all__ = ["carry_cards", "carry_facts", "carry_lines", "draw_carry"]

Values = NDArray[np.float64]


def carry_facts(run: Run) -> Mapping[str, Any] | None:
    """What the scenario told of the carrying: body, row, mark_world [m], within_m, grasp_n [N]; None for another."""
    facts = run.session.get("facts")
    carry = facts.get("carry") if isinstance(facts, Mapping) else None
    return carry if isinstance(carry, Mapping) else None


def carry_cards(task: Mapping[str, Any]) -> dict[str, tuple[Any, str]]:
    """Figures of the run: name to value and unit."""
    return {
        "placed": (task.get("placed"), ""),
        "drops": (task.get("drops"), ""),
        "bruises": (task.get("bruises"), ""),
        "way of the hand": (task.get("path_m"), "m"),
        "grasp error": (task.get("grasp_error_n"), "N"),
    }


def draw_carry(attempt: Attempt, facts: Mapping[str, Any]) -> Plot:
    """Path of the hand in the frontal plane, empty and carrying, with the mark, and where things were taken and lost.

    The frontal plane is that of the world's x (lateral) and y (vertical), axes equal.
    """
    path = 1000.0 * attempt.samples["hip_world"][:, :2]
    held = is_held(attempt, facts)
    free = path[attempt.free] if attempt.free.any() else path
    mark, within = 1000.0 * np.array(facts["mark_world"]), 1000.0 * float(facts["within_m"])
    ends = np.array([[mark[0] - within, mark[1]], [mark[0] + within, mark[1]]])
    x = Axis.of("lateral [mm]", free[:, 0], ends[:, 0])
    y = Axis.of("vertical [mm]", free[:, 1], ends[:, 1], zero=True)
    plot = Plot.equal(x, y, f"Path of the hand in the frontal plane, {attempt.title}")
    plot.line(ends[:, 0], ends[:, 1], "wall", "mark")
    empty = np.where((attempt.free & ~held)[:, None], path, np.nan)
    full = np.where((attempt.free & held)[:, None], path, np.nan)
    plot.line(empty[:, 0], empty[:, 1], "robot", "hand, empty")
    plot.line(full[:, 0], full[:, 1], "carried", f"{facts['body']} in the hand")
    changes = np.flatnonzero(np.diff(held.astype(np.int8)) != 0) + 1
    if len(changes):
        words = ["taken" if held[i] else "let go" for i in changes]
        hovers = [f"{word} at {attempt.samples['t'][i]:.1f} s" for word, i in zip(words, changes, strict=True)]
        plot.points(path[changes, 0], path[changes, 1], "contact", "taken, let go", hovers)
    return plot


def is_held(attempt: Attempt, facts: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Where the thing was in the hand, shape [n]."""
    held: NDArray[np.bool_] = attempt.samples["held_body"] == float(facts["row"])
    return held


def carry_lines(attempt: Attempt, facts: Mapping[str, Any]) -> dict[str, dict[str, tuple[str, Values]]]:
    """Traces by the label of their axis: the grasp force with what is right, and what is felt of the thing held."""
    samples = attempt.samples
    least, most = (np.full(len(samples), float(value)) for value in facts["grasp_n"])
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
