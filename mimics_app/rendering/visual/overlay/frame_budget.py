"""Time budget of each stage of a frame at 60 frames per second, for the frame graph and the bench."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["BUDGET_MS", "FRAME_MS", "over_budget"]

FRAME_MS = 1000.0 / 60.0
"""Duration of a frame [ms]."""

BUDGET_MS: Mapping[str, float] = {
    "reload": 0.1,
    "inputs": 0.1,
    "signals": 0.2,
    "watch": 0.2,
    "tasks": 0.5,
    "scenario": 0.4,
    "world update": 0.5,
    "sound": 0.4,
    "record": 0.2,
    "prepare": 0.6,
    "shadows": 1.5,
    "cull": 0.9,
    "mirrors": 1.0,
    "submit": 7.0,
    "overlay": 0.5,
    "board": 0.3,
    "post": 1.7,
    "swap": 0.5,
}
"""Budget by stage in order of execution [ms]; the sum is below FRAME_MS. `submit` draws the world in all views."""


def over_budget(stages_ms: Mapping[str, float]) -> list[str]:
    """Return the stages beyond their budget, ordered by the ratio, the worst first."""
    over = {name: ms / BUDGET_MS[name] for name, ms in stages_ms.items() if ms > BUDGET_MS.get(name, float("inf"))}
    return sorted(over, key=lambda name: -over[name])
