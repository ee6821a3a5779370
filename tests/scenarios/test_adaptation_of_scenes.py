"""The seven kinds of action of D2.1, each shown to change a scenario: what is felt, seen, heard, or what comes next."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, get_args

import pytest

import mimics_app as mimics
from mimics_app.app.api.opened import Opened
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import SceneError, UsageError
from mimics_app.contracts.messages.stage_messages import TrialResult, UserState
from mimics_app.contracts.system.resources import root
from mimics_app.learning.agent import Agent
from mimics_app.tasks.actions import build_action_space, build_learning_space, fill_defaults
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task import ActionKind, TaskSpec
from mimics_app.tasks.trials import plan_trials, trial_blocks

TUNNEL, MARKET, WALK = (root() / "scenes" / f"{n}.json" for n in ("wavy_tunnel", "pick_and_place", "guided_walk"))


class Played:
    """What the renderers were given in a few frames."""

    def __init__(self, scene: Path, values: dict[str, float], frames: int = 3) -> None:
        self.haptic: dict[str, object] = {}
        self.visual: dict[str, object] = {}
        self.audio: dict[str, object] = {}
        with mimics.open(scene, record=False) as session:
            if scene == TUNNEL:  # each of its trials has a radius of its own
                session.edit("task", trials=[{"name": "any", "trials": [{}]}])
            session.command(mimics.Policy("off"))
            session.set(**values)
            for _ in range(frames):
                session.step()
                orders = session.orders
                self.haptic |= {str(field): value for field, value in orders.haptic.numbers.items()}
                self.visual |= {feature.name: value for feature, value in orders.visual.values.items()}
                self.audio |= {} if orders.audio.gain is None else {"gain": orders.audio.gain}
            self.limit = session._begun.tasks._time_limit_s()
        task = fill_defaults(task_of(session.scene), lambda target: 1.0)
        self.kinds = {p.name: p.kind for p in build_action_space(task)}


def test_each_kind_is_free_in_a_shipped_scene() -> None:
    """A learning system may change it: it is in the space of one, which leaves out what is vetoed."""
    free: dict[str, set[str]] = {}
    for scene in (TUNNEL, MARKET, WALK):
        task = load_checked_scene(scene).section(TaskSpec)
        assert task is not None
        for parameter in build_learning_space(fill_defaults(task, lambda target: 1.0)):
            free.setdefault(parameter.kind, set()).add(scene.stem)
    assert set(free) == set(get_args(ActionKind))


def test_an_explorer_changes_flow_and_duration_of_the_market() -> None:
    """In trials after which the reward is known, and only as often as their dwell times allow."""
    task = load_checked_scene(MARKET).section(TaskSpec)
    assert task is not None
    space = build_learning_space(fill_defaults(task, lambda target: 1.0))
    agent, changed = Agent("thompson", space, 2), {"flow": 0, "duration": 0}
    values = space.defaults()
    for trial in range(30):
        result = TrialResult(trial, 0, "finished", 0.7, 0.7, values=dict(values))
        action = agent.choose(UserState(0), result, 0.5, trial * 30 * 10**9)
        chosen = {} if action is None else dict(action.values)
        for name in changed:
            changed[name] += chosen.get(name, values[name]) != values[name]
        values |= chosen
    assert all(1 <= count <= 15 for count in changed.values()), changed


def test_the_flow_of_the_market_has_another_block_to_go_to() -> None:
    """Where it is mapped, and that the flow of the scene is another with it; how: below."""
    task = load_checked_scene(MARKET).section(TaskSpec)
    assert task is not None
    assert [target.to for target in task.parameters["flow"].maps] == ["task.block"]
    blocks = {trial.block for trial in plan_trials(trial_blocks(task), 1)}
    assert task.parameters["flow"].max == len(blocks) == 2


def test_difficulty_is_felt() -> None:
    easy, hard = (Played(TUNNEL, {"radius": radius}, 60) for radius in (1.2, 0.6))
    assert easy.kinds["radius"] == "difficulty"
    assert easy.haptic["tunnel.radius_scale"] > hard.haptic["tunnel.radius_scale"]


def test_complexity_is_seen() -> None:
    few, many = (Played(MARKET, {"obstacles": count}, 60) for count in (0.0, 3.0))
    assert few.kinds["obstacles"] == "complexity"
    assert few.visual["obstacles"] != many.visual["obstacles"]


def test_appearance_is_seen() -> None:
    glass, hidden = (Played(TUNNEL, {"appearance": look}) for look in (0.0, 2.0))
    assert glass.kinds["appearance"] == "appearance"
    assert (glass.visual["tunnel_look"], hidden.visual["tunnel_look"]) == ("tunnel", "hidden")


def test_sound_is_heard() -> None:
    loud, quiet = (Played(TUNNEL, {"sound": gain}, 90) for gain in (1.0, 0.0))
    assert loud.kinds["sound"] == "sound"
    assert (loud.audio["gain"], quiet.audio["gain"]) == (1.0, 0.0)


def test_duration_is_another() -> None:
    assert Played(TUNNEL, {"duration": 60.0}).kinds["duration"] == "duration"
    assert Played(TUNNEL, {"duration": 20.0}).limit == 20.0


def test_the_avatar_goes_elsewhere() -> None:
    still, near = (Played(WALK, {"deed": deed}, 600) for deed in (3.0, 0.0))
    assert still.kinds["deed"] == "avatar"
    gaps = [math.dist(*(place(walk, who) for who in ("person", "avatar"))) for walk in (still, near)]
    assert gaps[1] < gaps[0] - 0.5


@pytest.mark.parametrize(
    ("scene", "learn", "goal", "able"),
    [
        (TUNNEL, "kalman", "arousal:-0.2:0.3", "linucb, thompson, q, sarsa, actor_critic"),
        (TUNNEL, "fixed", "effort:0:0.5", "linucb, thompson, q, sarsa, actor_critic"),
        (WALK, "linucb", "task", "q, sarsa, random, fixed"),
        (WALK, "random", "arousal:-1:-0.5", "q, sarsa"),
    ],
)
def test_a_policy_that_cannot_follow_the_goal_is_refused_by_check_and_at_the_start(
    scene: Path, learn: str, goal: str, able: str, tmp_path: Path
) -> None:
    document = json.loads(scene.read_text())
    document["task"] |= {"learn": learn, "goal": goal}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(document))
    with pytest.raises(SceneError) as refused:
        load_checked_scene(file)
    assert [issue.pointer for issue in refused.value.issues] == ["/task/learn"]
    assert refused.value.issues[0].fix == f"these can: {able}"
    with pytest.raises(UsageError, match=learn) as at_start:
        prepare_scene(load_checked_scene(scene), RunSettings(scene, learn=learn, goal=goal))
    assert at_start.value.fix == f"these can: {able}"


def place(played: Played, who: str) -> list[Any]:
    return list(played.visual[f"walk.{who}"])


@pytest.mark.parametrize("block", [0, 2])
def test_the_flow_goes_on_elsewhere(block: int, tmp_path: Path) -> None:
    document = json.loads(WALK.read_text())
    task = document["task"]
    task |= {"time_limit_s": 1.0, "result_s": 0.1, "rest_s": 0.1, "goals": [{"kind": "duration", "seconds": 0.2}]}
    task["trials"] = [{"name": name, "trials": [{}, {}]} for name in ("first", "second")]
    task["parameters"]["flow"] = {
        "default": 0, "min": 0, "max": 2, "step": 1, "kind": "flow", "maps": [{"to": "task.block"}]
    }  # fmt: skip
    scene = tmp_path / "walk.json"
    scene.write_text(json.dumps(document))
    with mimics.open(scene, record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        session.set(flow=block)
        session.step_until(lambda s: s.orders.finished)
    blocks = [row["block"] for row in session.trials]
    assert [row["trial"] for row in session.trials] == [0, 1, 2, 3]
    listed, changed = ["first", "first", "second", "second"], ["first", "second", "second", "first"]
    assert blocks == (changed if block else listed)


def test_the_walk_reports_steps_and_the_person_is_moved() -> None:
    seen: list[TrialResult] = []
    with mimics.open(WALK, seed=2, record="memory") as session:
        before = person(session)
        for _ in range(60 * 40):
            session.step()
            seen += [] if session.orders.result is None else [session.orders.result]
        after = person(session)
    assert len(seen) > 15
    assert session.events.where(kind="result")["reward"].tolist() == [result.reward for result in seen]
    assert {result.outcome for result in seen} == {"step"}
    assert {"gap", "left"} <= set(seen[0].observed)
    assert before[2] - after[2] != 0.0


def person(session: Opened) -> Any:
    return session.world.find("person").world_matrix()[:3, 3].copy()
