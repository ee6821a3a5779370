"""A tracked head steers a walk, and a tracked person's steps in a room lead it, with a device as without one."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

import mimics_app as mimics
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.trackers.scripted_person import person_quaternion
from mimics_app.inputs.trackers.tape import TapeWriter
from mimics_app.maths.poses import pose_from_parts
from mimics_app.tasks.kinds.canyon_walk.kind import CanyonWalkPlay, CanyonWalkSpec, SectionSpec
from mimics_app.tasks.kinds.soccer.kind import SoccerPlay, SoccerSpec
from mimics_app.tasks.walking.head_steering import head_aside
from mimics_app.tasks.walking.legs import GAITS, Legs
from mimics_app.tasks.walking.room_steps import RoomSteps
from mimics_app.tasks.walking.walker import PERSON
from tests.support.command import mimics as command

Head = Callable[[float], tuple[float, float, float]]
"""Time [s] -> x, z [m] and yaw to the left [deg] of a person's head."""
FRAME, ROOM_M = 1.0 / 60.0, 3.0


def to_and_fro(seconds: float) -> tuple[float, float, float]:
    """Somebody walks a room of 3 m at 0.6 m/s to and fro, and looks where they go; they turn in a second."""
    lap, turn_s, speed = ROOM_M / 0.6, 1.0, 0.6
    number, within = divmod(seconds, lap + turn_s)
    walked = speed * min(within, lap)
    turned = 180.0 * (number + max(within - lap, 0.0) / turn_s)
    return 0.0, -walked if number % 2 == 0 else walked - ROOM_M, turned


def scene(folder: Path, name: str, head: Head, **section: object) -> Path:
    """A walk with a recorded head, and other settings of its kind of task."""
    tape = TapeWriter(folder / "head.jsonl")
    for number in range(60 * 40):
        x, z, yaw = head(number * FRAME)
        turned = person_quaternion(yaw, 0.0, 0.0)
        tape.take(TrackerSample("head", round(number * FRAME * 1e9), (x, 1.7, z), turned))
    tape.close()
    document = json.loads((root() / "scenes" / f"{name}.json").read_text())
    document["task"][name] |= section
    device = {"name": "head", "kind": "tape", "address": "head.jsonl", "roles": {"head": "head"}}
    document["systems"]["trackers"] = {"devices": [device]}
    file = folder / f"{name}.json"
    file.write_text(json.dumps(document))
    return file


@pytest.mark.parametrize(("degrees", "aside"), [(0, 0.0), (5, 0.0), (-18, 0.5), (18, -0.5), (-40, 1.0), (90, -1.0)])
def test_who_looks_aside_turns_that_way(degrees: float, aside: float) -> None:
    pose = pose_from_parts((0.1, 1.7, -0.2), person_quaternion(degrees, 0.0, 0.0))
    assert head_aside(HeadPlace.of(pose)) == pytest.approx(aside, abs=0.02)
    assert head_aside(None) == 0.0


def test_steps_in_a_room_are_the_way_ahead_and_turning_at_the_wall_is_not() -> None:
    steps, way = RoomSteps(2.0), 0.0
    for number in range(60 * 12):  # there and back again, with two turns
        x, z, yaw = to_and_fro(number * FRAME)
        steps.read(HeadPlace(x, z, math.radians(yaw)), FRAME)
        way += steps.speed * FRAME
    assert way == pytest.approx(2.0 * 2.0 * ROOM_M, rel=0.05)
    sways, swayed = RoomSteps(2.0), 0.0
    for number in range(60 * 12):
        sways.read(HeadPlace(0.0, 0.03 * math.sin(2.0 * math.pi * 0.4 * number * FRAME), 0.0), FRAME)
        swayed += sways.speed * FRAME
    assert swayed == 0.0, "who sways in place stands"
    steps.read(None, FRAME)
    for _ in range(60):
        steps.read(None, FRAME)
    assert steps.speed == 0.0, "who is not tracked stands"
    for z in (0.0, -1.5, -1.5):
        steps.read(HeadPlace(0.0, z, 0.0), FRAME)
        assert steps.speed == 0.0, "a tracker that jumps walks nobody"


def test_a_tracked_walker_crosses_and_the_run_replays(tmp_path: Path) -> None:
    used = scene(tmp_path, "canyon_walk", to_and_fro, room_gain=2.0)
    with mimics.open(used, seed=1, runs=tmp_path / "runs") as session:
        for _ in range(60 * 10):
            session.step()
        person = session.orders.visual.get(PERSON)
        run = session.run_dir
    assert person is not None and -person.z > 11.0, "from 8 m on, at 1.2 m/s but for the turns"
    assert command("replay", run).returncode == 0


class Led:
    """Legs of an orthosis at 0.4 m/s."""

    def __init__(self) -> None:
        self._legs = Legs(GAITS["healthy"])

    def read(self, joints: object, strikes: object, seconds: float) -> LegMotion:
        return self._legs.step(0.4, seconds)


@pytest.mark.parametrize("orthosis", [None, Led()])
@pytest.mark.parametrize("degrees", [25.0, -25.0])
def test_the_head_leads_by_hand_and_in_an_orthosis(orthosis: Led | None, degrees: float) -> None:
    snapshot = SimpleNamespace(left_strikes=0, right_strikes=0)
    head = HeadPlace(0.0, 0.0, math.radians(degrees))
    seen = SimpleNamespace(
        hip_world=(0.0, 0.0, 0.0), grasp=0.0, pressed=(), now_ns=0, q=(), snapshot=snapshot, head=head
    )
    soccer = SoccerPlay(SoccerSpec("person", "ball", heading="head"), 1, advises=False, orthosis=orthosis)  # type: ignore[arg-type]
    calm = CanyonWalkSpec(
        "person", "beam", heading="head", calm=True, width=3.0, sections={"": SectionSpec(30.0, 40.0)}
    )
    canyon = CanyonWalkPlay(calm, 1, orthosis)  # type: ignore[arg-type]
    for play in (soccer, canyon):
        play.begin_trial("", 0)
        play.start_attempt(seen)  # type: ignore[arg-type]
        seen.hip_world = (0.0, 0.1, 0.0)
        for _ in range(60):
            play.travel(seen, FRAME)  # type: ignore[arg-type]
        seen.hip_world = (0.0, 0.0, 0.0)
    turned = math.remainder(soccer.visual[PERSON].yaw - math.pi, 2.0 * math.pi)  # type: ignore[attr-defined]
    assert math.copysign(turned, degrees * turned) > 0.3
    assert -degrees * canyon.visual[PERSON].x > 0.1, "who looks to the left leans to the left"  # type: ignore[attr-defined]


def test_a_heading_by_a_head_that_nobody_tracks_is_refused(tmp_path: Path) -> None:
    file = scene(tmp_path, "soccer", to_and_fro, heading="head")
    document = json.loads(file.read_text())
    document["systems"].pop("trackers")
    file.write_text(json.dumps(document))
    with pytest.raises(SceneError, match=r"task/soccer/heading: no tracker reports a head"):
        load_checked_scene(file)
