"""Table 1 of D2.1: each of its sounds in its own scene, from its true direction and by the law of distance."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.api.opened import Opened
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.messages.orders import VisualOrder
from mimics_app.contracts.messages.stage_messages import SoundEvent, TaskOrders
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.audio.offline import render_offline
from mimics_app.rendering.audio.scene_sounds import settings_from_components
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.tasks.kinds.canyon_walk.kind import WIND, CanyonWalkPlay, CanyonWalkSpec, SectionSpec
from mimics_app.tasks.kinds.soccer.kind import SoccerPlay, SoccerSpec
from mimics_app.world.components.visible import Sound, SoundEmitter
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

SCENES = root() / "scenes"
CELLS = {
    "city_walk": {"steps": ("person", "companion", "neighbour", "stroller")},
    "canyon_walk": {"steps_on_beam": ("person",), "gust": ()},
    "soccer": {"steps": ("person",), "opponent_steps": ("opponent",), "kick": ("ball",)},
}
"""Sounds that an event starts, and who may cause each."""
ASIDE = 0.35  # [rad] off the middle of the head, from which on one ear is the nearer one
SECTIONS: Mapping[str, Mapping[str, object]] = {
    "city_walk": {},
    "canyon_walk": {"sections": {"begin": {"begin": 40.0, "end": 70.0}}},
    "soccer": {"skill": 1.0},
}


class Ears:
    """What is heard: sound, place in the frame of the ears [m], and of all who may be its cause."""

    def __init__(self, world: World, sounds: Mapping[str, str], causes: Mapping[str, tuple[str, ...]]) -> None:
        self._world, self._sounds, self._causes = world, sounds, causes
        self.heard: list[tuple[str, np.ndarray, list[np.ndarray]]] = []

    def listen(self, orders: TaskOrders) -> None:
        """Take the newest frame."""
        world = self._world
        for index, event in world.motion.happened:
            place = world.find(f"{world.graph.name(index)}/{event.node}").world_matrix()[:3, 3].copy()
            self._hear(f"{event.kind}/{event.material}", place)
        for cue in orders.audio.cues:
            self._hear(cue.kind, np.array(cue.position_world))

    def _hear(self, trigger: str, place: np.ndarray) -> None:
        sound = self._sounds.get(trigger) or self._sounds.get(trigger.partition("/")[0], "")
        if sound in self._causes:
            there = [self._local(self._world.find(each).world_matrix()[:3, 3]) for each in self._causes[sound]]
            self.heard.append((sound, self._local(place), there))

    def _local(self, place: np.ndarray) -> np.ndarray:
        ears = self._world.find("ego").world_matrix()
        return np.asarray(np.linalg.inv(ears) @ np.append(place, 1.0))[:3]


def _settings_of(scene: Scene) -> AudioSettings:
    settings = settings_from_components(
        scene.components(Sound), scene.components(SoundEmitter), scene.assets, str(scene.path)
    )
    assert settings is not None
    return settings


def _sounds_of(name: str) -> Mapping[str, SoundSpec]:
    return _settings_of(load_checked_scene(SCENES / f"{name}.json")).sounds


def _sides_db(sound: str, place: np.ndarray, specs: Mapping[str, SoundSpec]) -> float:
    """Level of the right ear over the left one [dB], in the mix of the library."""
    x, y, z = place.tolist()
    mix, _ = render_offline([SoundEvent(sound, 0, (x, y, z))], specs, 0.4)
    left, right = np.sum(mix.astype(np.float64) ** 2, axis=0)
    return float(10.0 * math.log10(right / left))


@pytest.mark.parametrize("name", CELLS)
def test_each_sound_of_table_1_comes_from_where_its_cause_is(tmp_path: Path, name: str) -> None:
    """Direction of the sound and of its cause agree on the ground, and the nearer ear has more of it."""
    document = json.loads((SCENES / f"{name}.json").read_text())
    document["task"][name] |= SECTIONS[name]
    file = tmp_path / f"{name}.json"
    file.write_text(json.dumps(document))
    with mimics.open(file, record=False) as session:
        settings = _settings_of(session.scene)
        ears = Ears(session.world, settings.triggers, CELLS[name])

        def all_heard(session: Opened) -> bool:
            ears.listen(session.orders)
            return {each for each, _, _ in ears.heard} >= set(CELLS[name]) and len(ears.heard) > 6

        session.step_until(all_heard, 20.0)
    for sound in CELLS[name]:
        events = [(place, there) for each, place, there in ears.heard if each == sound]
        assert events, (sound, "is never heard")
        for place, causes in events:  # a foot is before or behind who takes a step, and the eyes before the node
            far = [math.hypot(place[0] - there[0], place[2] - there[2]) for there in causes]
            assert min(far, default=0.0) < 0.9, (sound, place, far)
        beside = [place for place, _ in events if abs(place[0]) > math.tan(ASIDE) * abs(place[2]) + 0.04]
        if beside:
            side = beside[0]
            assert _sides_db(sound, side, settings.sounds) * side[0] > 0.0, (sound, side)


@pytest.mark.parametrize(("scored", "cheer"), [("goal", "cheer"), ("opponent_goal", "applause")])
def test_a_goal_and_the_crowd_sound_from_its_end_of_the_pitch_at_once(scored: str, cheer: str) -> None:
    """Both in the frame of the goal; the crowd is beside itself for the person's goal only."""
    play = SoccerPlay(SoccerSpec("person", "ball", middle=(0.0, 0.02, 60.0)), 1, advises=False)
    seen = SimpleNamespace(hip_world=(0.0, 0.0, 0.0), grasp=0.0, pressed=(), now_ns=16_000_000, q=())
    play.start_attempt(seen)  # type: ignore[arg-type]
    ahead = -1.0 if scored == "goal" else 1.0
    play._match.ball.put(0.3, 8.05 * ahead)
    play._match.ball.velocity = np.array([0.0, 0.0, 9.0 * ahead])
    play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
    sounds = {each.kind: each for each in play.take_sounds()}
    kind = {"goal": "scored", "opponent_goal": "opponent_scored"}[scored]
    assert {kind, cheer} <= set(sounds)
    assert {each.t_ns for each in sounds.values()} == {seen.now_ns}
    for each in (kind, cheer):
        assert sounds[each].position_world[2] == pytest.approx(60.0 + 8.2 * ahead, abs=0.1)
    specs = _sounds_of("soccer")
    assert specs["cheer"].arousal > specs["gasp"].arousal > specs["applause"].arousal > specs["crowd"].arousal


def test_the_steps_of_who_comes_from_behind_grow_with_closeness() -> None:
    """As one over the distance, within a quarter of a decibel; on the side on which they come."""
    specs = {"opponent_steps": replace(_sounds_of("soccer")["opponent_steps"], recipe="step_grass")}

    def level_db(distance: float) -> float:
        event = SoundEvent("opponent_steps", 0, (0.0, 0.0, distance))
        mix, _ = render_offline([event], specs, 0.4, hrtf=False)
        return float(10.0 * math.log10(np.mean(mix.astype(np.float64) ** 2)))

    near = level_db(1.0)
    for distance in (1.5, 2.0, 4.0, 8.0, 16.0):
        assert level_db(distance) - near == pytest.approx(-20.0 * math.log10(distance), abs=0.25)
    assert _sides_db("opponent_steps", np.array([-1.5, -1.6, 1.5]), specs) < -2.0
    assert _sides_db("opponent_steps", np.array([1.5, -1.6, 1.5]), specs) > 2.0


def test_a_gust_comes_from_the_side_from_which_it_pushes() -> None:
    play = CanyonWalkPlay(CanyonWalkSpec("person", "beam", sections={"begin": SectionSpec(60.0, 200.0)}), 1)
    play.begin_trial("begin", 1)
    seen = SimpleNamespace(hip_world=(0.0, 0.0, 0.0), grasp=0.0, pressed=(), now_ns=0, q=())
    play.start_attempt(seen)  # type: ignore[arg-type]
    sides: list[float] = []
    while len(sides) < 8:
        play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
        for sound in play.take_sounds():
            if sound.kind == "gust":
                assert sound.position_world is not None
                x = sound.position_world[0] - play._crossing.walker.pose().x
                for _ in range(60):
                    play.travel(seen, 1.0 / 60.0)  # type: ignore[arg-type]
                assert x * play._crossing.wind.push < 0.0
                sides.append(math.copysign(1.0, x))
    assert set(sides) == {-1.0, 1.0}


def test_the_wind_is_nearer_the_more_exposed_somebody_is() -> None:
    """Its place is that of `wind_place`, to the left of the person; nearer is louder by the law above."""
    distances = {}
    with mimics.open("canyon_walk", record=False) as session:
        session.step_until(lambda s: s.orders.person_may_act)
        core, find = session._begun, session.world.find
        for strength in (0.0, 0.35, 1.0):
            orders = SimpleNamespace(visual=VisualOrder({WIND: strength}), view=session.orders.view)
            core.scenario.apply(orders, core.haptics.snapshot())  # type: ignore[arg-type]
            core.world.update()
            place = np.linalg.inv(find("ego").world_matrix()) @ find("wind_place").world_matrix()[:, 3]
            distances[strength] = float(np.linalg.norm(place[:3]))
            assert place[0] < -0.9 and abs(place[2]) < 0.6 * distances[strength]
    assert distances[0.0] > distances[0.35] > distances[1.0]
    assert 20.0 * math.log10(distances[0.0] / distances[1.0]) > 12.0
