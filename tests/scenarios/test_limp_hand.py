"""Every task at every difficulty with a hand that does nothing: it is not moved before the go, and wins nothing."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.api.opened import Opened
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task import DurationGoal

TRAVEL_S = 4.0
"""Length of a travel [s]: the assistance of an easier tunnel took three seconds from its start to its goal."""
STILL_M = 0.005
"""Largest way of the hand between its arrival at the start and the go."""
PASSIVE = {"avatar_cord", "calibration", "guided_walk", "examples/guided_path"}
"""Scenes in which the person watches, or is led."""

KINDS = {
    "wavy_tunnel": "tunnel",
    "pick_and_place": "carry",
    "city_walk": "city_walk",
    "canyon_walk": "canyon_walk",
    "soccer": "soccer",
    "guided_walk": "guided_walk",
    "avatar_cord": "avatar_cord",
    "calibration": "calibration",
}
"""A shipped scene of each kind of task."""
OTHERS = ("springs_and_magnets", "guided_path", "force_field", "kicking", "impedance_control")
"""Scenes in which something pulls at the hand."""
SCENES = (*KINDS, *(f"examples/{name}" for name in OTHERS))


def plays() -> list[tuple[str, str]]:
    """Every scene at the usual difficulty, and those that have parameters at the others."""
    eased = ("wavy_tunnel", "pick_and_place")
    return [(name, "usual") for name in SCENES] + [(name, how) for name in eased for how in ("easier", "harder")]


@dataclass
class Limp:
    """A session of a passive arm, or of nobody at the handle.

    Attributes:
        session: The session, at its end.
        still: Places of the hand between arrival and go [m].
        went: Places during the travel [m].
    """

    session: Opened
    still: list[Any] = field(default_factory=list)
    went: list[Any] = field(default_factory=list)


def make_limp(session: Opened) -> None:
    """Give the simulated person no intent, and the travel a few seconds."""
    session.edit("patient", intent=False)
    task = task_of(session.scene)
    goals = [msgspec.structs.replace(g, seconds=TRAVEL_S) if isinstance(g, DurationGoal) else g for g in task.goals]
    rest = {
        name: each
        for name, each in task.parameters.items()
        if not any(target.to == "task.time_limit_s" for target in each.maps)
    }
    session.edit("task", goals=goals, parameters=rest, time_limit_s=TRAVEL_S)


def play_limp(name: str, difficulty: str, **settings: Any) -> Limp:
    with mimics.open(name, difficulty=difficulty, trials=1, record=False, **settings) as session:
        make_limp(session)
        limp = Limp(session)

        def ended(session: Opened) -> bool:
            state = session.orders.view.state
            if state is TrialState.READY:
                limp.still.append(session.state["hip_world"][0])
            elif state is TrialState.TRAVEL:
                limp.went.append(session.state["hip_world"][0])
            return bool(session.trials)

        session.step_until(ended)
    return limp


def way(places: list[Any]) -> float:
    """Largest distance from the first place [m]."""
    return float(np.linalg.norm(np.array(places) - places[0], axis=1).max())


def check_limp(limp: Limp, name: str) -> None:
    assert len(limp.still) > 40 and way(limp.still) <= STILL_M
    assert limp.went, "the go came"
    (row,) = limp.session.trials
    assert task_of(limp.session.scene).passive == (name in PASSIVE)
    if name not in PASSIVE:
        assert row["outcome"] == "timeout" and not row["score"]
        assert row["happened"] == f"Time is over: the {limp.session._begun.tasks._limb} did nothing"


def test_every_kind_of_task_is_played():
    assert set(KINDS.values()) == {kind.name for kind in task_kinds()}


@pytest.mark.parametrize(("name", "difficulty"), plays())
def test_a_limp_arm_is_held_until_the_go_and_wins_nothing(name, difficulty):
    check_limp(play_limp(name, difficulty), name)


@pytest.mark.parametrize("name", ["wavy_tunnel", "city_walk"])
def test_a_handle_that_nobody_holds_wins_nothing(name):
    check_limp(play_limp(name, "easier", device="pointer"), name)
