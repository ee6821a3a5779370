"""The sounds of D2.1 Table 1: each plays at its event, from its place, in a scene of its kind."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mimics_app.app.cues.sound_stage import SoundStage
from mimics_app.app.cues.sound_surroundings import SoundSurroundings
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.messages.stage_messages import SoundTrigger, TaskOrders
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.rendering.audio.offline import OfflineAudio
from mimics_app.rendering.audio.scene_sounds import settings_from_components
from mimics_app.world.components.visible import Sound, SoundEmitter
from mimics_app.world.files.scene.file import build_world
from tests.support.audio_scene import RATE, contact, push
from tests.verification.test_sound_onset import read_file

FRAME_NS = 16_666_667


def emitter(sound: str, place: list[float]) -> dict:
    return {"transform": {"translation": place}, "components": {"sound_emitter": {"sound": sound}}}


# Column of the table -> sounds of its scenario: entity, recipe, trigger, material.
SCENARIOS = {
    "soccer": [
        ("own_step", "step_grass", "step", "grass"),
        ("kick", "kick", "kick", ""),
        ("score", "score", "score", ""),
        ("crowd", "crowd", None, ""),
        ("foot", "stub_kerb", "contact", ""),
    ],
    "street": [("avatar_step", "step_asphalt", "step", "asphalt"), ("foot", "stub_wall", "contact", "")],
    "canyon": [("own_step", "step_earth", "step", "earth"), ("wind", "wind", None, "")],
    "kitchen": [("cup", "cup", "contact", ""), ("table", "table", "impact", "")],
}
CELLS = [
    (scenario, name, trigger, material)
    for scenario, sounds in SCENARIOS.items()
    for name, _, trigger, material in sounds
    if trigger not in (None, "contact", "impact")
]


def play(folder, scenario: str, triggers=(), events=(), seconds: float = 1.5):
    """The scene of a scenario, its frames, and what is heard."""
    entities = [{"id": "eye", "components": {"camera": {}}}]
    for name, recipe, trigger, material in SCENARIOS[scenario]:
        sound = {"synth": recipe, "material": material} | ({"trigger": trigger} if trigger else {})
        entities.append({"id": name, "components": {"sound": sound}})
        if trigger is None:
            entities.append({"id": f"{name}_place", **emitter(name, [0.0, 2.0, -10.0])})
    file = folder / "scene.json"
    document = {"format": "mimics-scene", "version": 1, "name": "table1", "scenario": "none", "entities": entities}
    file.write_text(json.dumps(document))
    scene = load_checked_scene(file)
    world, memory = build_world(scene), SessionMemory()
    world.update()
    settings = settings_from_components(
        scene.components(Sound),
        scene.components(SoundEmitter),
        scene.assets,
        str(file),
        sink="file",
        file=folder / "heard.wav",
        mixer="spectral",
    )
    output = OfflineAudio(memory, settings)
    output.start()
    stage = SoundStage(output, memory, settings, SoundSurroundings(scene, len(settings.emitters)), 1.0)
    waiting = list(triggers)
    for frame in range(1, round(seconds * 60)):
        now = frame * FRAME_NS
        for event in [each for each in events if now - FRAME_NS <= int(each["t_ns"][0]) < now]:
            assert push(memory, event)
        due = [each for each in waiting if each.t_ns < now]
        waiting = [each for each in waiting if each.t_ns >= now]
        stage.step(TaskOrders(), world, now, due)
    return stage.stop()


@pytest.mark.parametrize(("scenario", "name", "kind", "material"), CELLS)
def test_the_sound_plays_at_its_event(tmp_path, scenario, name, kind, material):
    times = [312_345_678, 700_000_001]
    place = (1.0, 0.0, -1.0)
    report = play(tmp_path, scenario, [SoundTrigger(kind, t, place, material) for t in times])
    rows = [row for row in report.rows if row.sound.split(":")[0] == name]
    assert [row.t_ns for row in rows] == times
    constant = {row.onset_sample - (row.t_ns * RATE + 500_000_000) // 1_000_000_000 for row in rows}
    assert len(constant) == 1 and max(row.latency_ms for row in rows) < 20.0
    mix = read_file(report.file)
    for row in rows:
        heard = np.abs(mix[row.onset_sample - 20 : row.onset_sample + 4800]).max(axis=0)
        assert heard[1] > heard[0] > 0.005, "it is to the right"


@pytest.mark.parametrize(("scenario", "name"), [("soccer", "crowd"), ("canyon", "wind")])
def test_what_is_always_there_is_heard_from_its_place_all_the_time(tmp_path, scenario, name):
    report = play(tmp_path, scenario)
    assert report.rows == ()
    mix = read_file(report.file)
    levels = np.sqrt(np.mean(mix[RATE // 2 : 2 * RATE].reshape(-1, 1200, 2) ** 2, axis=(1, 2)))
    assert levels.min() > 0.001, name
    assert np.abs(mix[-48:]).max() < 1e-4, "the file ends in silence"


@pytest.mark.parametrize(("scenario", "name"), [("soccer", "foot"), ("street", "foot"), ("kitchen", "cup")])
def test_a_touch_sounds_at_its_tick(tmp_path, scenario, name):
    """4.3's own example: the foot against something hard, from the event of the 1 kHz loop."""
    times = [400_000_000, 900_000_000]
    report = play(tmp_path, scenario, events=[contact(t, speed=0.8, position=(0.0, -1.0, -0.3)) for t in times])
    rows = [row for row in report.rows if row.cause == "contact"]
    assert [row.t_ns for row in rows] == times
    assert all(row.sound.startswith(f"{name}:") and row.latency_ms < 20.0 for row in rows)


def test_a_step_on_another_ground_is_not_that_of_this_one(tmp_path):
    report = play(tmp_path, "soccer", [SoundTrigger("step", 300_000_000, None, "wood")])
    assert report.rows == ()
