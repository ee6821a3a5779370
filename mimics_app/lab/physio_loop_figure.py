"""Figure of the whole loop: benefit of the estimated load for a policy, by kind of people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mimics_app.lab.figure import Figure
from mimics_app.lab.panel import Panel
from mimics_app.lab.physio.loop_study import PEOPLE, SEEDS, TRIALS, LoopScore, loop_study, pooled
from mimics_app.lab.physio_drawing import physio_figure, row_of
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import legend

__all__ = ["loop_regret"]

_POLICIES = ("random", "staircase", "kalman_performance", "kalman")
_DRAWN = "drawn as they come"
_CONTROLS: Mapping[str, dict[str, bool]] = {
    "skin does not answer": {"silent": True},
    "body ignores the task": {"blind": True},
}
_CONTROL_PEOPLE = 10
"""Number of people of a control."""
_WHO = (_DRAWN, *_CONTROLS)


def _loop_scores() -> dict[tuple[str, str], list[LoopScore]]:
    """Return the scores of every policy with every kind of people, one for each seed."""
    drawn = {(_DRAWN, name): [loop_study(name, seed=seed) for seed in SEEDS] for name in _POLICIES}
    controls = {
        (who, name): [loop_study(name, _CONTROL_PEOPLE, **more)]
        for who, more in _CONTROLS.items()
        for name in _POLICIES
    }
    return drawn | controls


def loop_regret(groups: Mapping[tuple[str, str], Sequence[LoopScore]] | None = None) -> Figure:
    """Return the figure of the mean regret of a trial with its 95 % interval over the people of all groups.

    Args:
        groups: Result of `_loop_scores`; None: measured now, which takes six minutes of processor time.
    """
    groups = _loop_scores() if groups is None else groups
    scores = {what: pooled(each) for what, each in groups.items()}
    ends = [score.mean + side * score.half_width for score in scores.values() for side in (-1.0, 1.0)]
    y = Axis.around("regret of a trial", [max(value, 0.02) for value in ends], log=True)
    policies = Axis("policy", -0.6, 3.6, at=(0.0, 1.0, 2.0, 3.0), words=_POLICIES)
    panel = Panel(6.0, 70.0, 880.0, 380.0, policies, y)
    rows: list[dict[str, Any]] = []
    for (who, name), score in scores.items():
        k, policy = _WHO.index(who), _POLICIES.index(name)
        x, low, high = policy + 0.2 * (k - 1), max(score.mean - score.half_width, 0.02), score.mean + score.half_width
        panel.line([(x, low), (x, high)], f"line s{k}")
        panel.dot(x, score.mean, f"dot s{k}", f"{name}, {who}: {score.mean:.3f}")
        more = {"half_width": score.half_width, "by_seed": [group.mean for group in groups[who, name]]}
        rows.append(row_of(f"{name}, {who}", float(policy), score.mean) | more)
    parts = [legend(20.0, 52.0, [("line", f"line s{k}", who) for k, who in enumerate(_WHO)]), panel.svg()]
    people = f"{len(SEEDS) * PEOPLE} people of all kinds, {_CONTROL_PEOPLE} of each control"
    what = f"{people}, {TRIALS} trials; kalman goes by success and by the default load estimator"
    return physio_figure("physio loop regret", "What the load is worth to the loop", (900.0, 510.0), parts, rows, what)
