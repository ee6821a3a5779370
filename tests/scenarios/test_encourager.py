"""Somebody who encourages: reacts to results, each time a little otherwise, and changes nothing that is felt."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import mimics_app as mimics
from mimics_app.app.api.opened import Opened
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system.resources import root
from mimics_app.world.content.motion.state_machine import StateMachine
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world

SCENES = ("wavy_tunnel", "pick_and_place")


def _reported(tmp_path: Path, **encourager: object) -> Path:
    """The tunnel with another encourager, in a file of its own."""
    scene = json.loads((root() / "scenes" / "wavy_tunnel.json").read_text())
    entity = next(each for each in scene["entities"] if each["id"] == "encourager")
    entity["components"]["encourager"] = encourager
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    return file


def _machine(world: World) -> StateMachine:
    return world.motion.machines[world.find("encourager").index]


def test_results_are_answered_and_not_always_in_the_same_way() -> None:
    world = build_world(load_checked_scene(root() / "scenes" / "wavy_tunnel.json"))
    machine, shown = _machine(world), []
    for cause in ("ready", "goal", "ready", "goal", "goal", "timeout", "goal", "contact", "done"):
        machine.trigger(cause)
        shown.append(machine.state)
        for _ in range(60 * 4):
            world.motion.time += 1.0 / 60.0
            world.update()
        assert machine.state == "idle"
    assert shown == [
        "greet", "praise 0", "idle", "praise 1", "cheer", "console", "cheer", "idle", "farewell",
    ]  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_a_session_greets_and_the_encourager_looks_at_the_person(name: str) -> None:
    awaited = {"idle", "greet"} | ({"praise 0"} if name == "wavy_tunnel" else set())  # by then the person is through
    seen: set[str] = set()

    def all_seen(session: Opened) -> bool:
        seen.add(_machine(session.world).state)
        return awaited <= seen

    with mimics.open(name, record=False) as session:
        assert session.step_until(all_seen, 14.0), seen


def test_who_is_not_wanted_is_neither_drawn_nor_moved(tmp_path: Path) -> None:
    world = build_world(load_checked_scene(_reported(tmp_path, shown=False)))
    index = world.find("encourager").index
    assert not world.find("encourager").visible and index not in world.motion.machines
    assert not world.motion.animators[index].moves
    assert not world.motion.alive


def test_a_clip_that_the_model_lacks_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r'components/encourager/praise/1.*no clip "clapp"'):
        load_checked_scene(_reported(tmp_path, praise=["wave", "clapp"]))


@pytest.mark.parametrize(
    ("name", "who"), [("city_walk", "companion"), ("canyon_walk", "encourager"), ("soccer", "encourager")]
)
def test_somebody_encourages_on_a_walk(name: str, who: str) -> None:
    """The companion of the city, too, who walks beside the person meanwhile."""
    scene = load_checked_scene(root() / "scenes" / f"{name}.json")
    world = build_world(scene)
    machine = world.motion.machines[world.find(who).index]
    shown = [machine.state for cause in ("ready", "goal", "timeout", "goal", "done") if machine.trigger(cause)]
    assert shown == ["greet", "praise 0", "console", "cheer", "farewell"]
