"""What is touched decides how a touch sounds: from the surfaces of a scene through the loop to the sounds played."""

from __future__ import annotations

from pathlib import Path

import mimics_app as mimics
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.recording.run import Run
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.director import SoundDirector
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.haptic.scene_objects import objects_of_scene
from tests.support.audio_scene import RATE, contact

SCENE = Path(__file__).resolve().parents[2] / "scenes/examples/surfaces.json"
MOST_S = 8.2  # by then the patient has touched the slippery and the round one


def test_each_surface_of_a_scene_sounds_as_its_material(tmp_path):
    with mimics.open(SCENE, seed=7, seconds=MOST_S, sound="file", runs=tmp_path) as session:
        session.run()
    run = Run.open(session.run_dir)
    header, samples = run.session["names"], run.haptic
    names = header["materials"]
    assert names == list(objects_of_scene(load_checked_scene(SCENE)).materials)
    begun = run.lines_of("loop", "contact_begin")
    entities = [header["shapes"][int(line["value"])] for line in begun]
    assert set(entities) == {"slippery", "round_edges"}
    assert [header["shapes"][int(samples["touched_shape"][line["tick"]])] for line in begun] == entities
    felt = samples["state"][[line["tick"] for line in begun]].astype(int)
    assert {header["state"][state] for state in felt} == {"ACTIVE"}
    touched = {line["tick"]: names[line["material_b"]] for line in begun}
    played = {line["tick"]: line["sound"].split("_")[0] for line in run.lines_of("app", "sound") if line["tick"] > 0}
    assert set(touched.values()) == {"glass", "steel"}
    assert played and set(played.values()) == {"glass", "steel"}
    assert all(touched[tick] == material for tick, material in played.items())
    names = [line["sound"] for line in run.lines_of("app", "sound") if line["tick"] > 0]
    assert all(":live:" in name for name in names), "what is struck sounds by the force of its contact"


def heard(events, **settings) -> list[str]:
    """Sounds that a director starts for events."""
    sounds = {name: SoundSpec(recipe="tick") for name in ("any", "wooden", "glassy")}
    triggers = {"contact": "any", "contact/wood": "wooden", "impact/glass": "glassy", "impact/wood": "wooden"}
    chosen = AudioSettings(sounds=sounds, triggers=triggers, scrape="", materials=("", "wood", "glass"), **settings)
    bank, clock = SoundBank(sounds, RATE), VirtualClock()
    mixer = open_mixer(chosen, bank, clock, latency=0, origin_ns=0)
    director = SoundDirector(SessionMemory(), mixer, bank, chosen, clock)
    for event in events:
        director.play_contacts(event)
    mixer.close()
    return [row.sound for row in director.rows]


def touch(kind: EventKind, step: int, a: int, b: int, number: int = 0):
    event = contact(50 * step * 1_000_000)  # further apart than the pause of a pair
    event["kind"], event["body_a"], event["body_b"], event["material_b"] = kind, a, b, number
    return event


def test_a_body_sounds_as_its_own_and_what_has_no_sound_of_its_own_as_all():
    begin, impact = EventKind.CONTACT_BEGIN, EventKind.IMPACT
    events = [
        touch(begin, 0, 0, -1, 1),  # the hand on wood of the static scene
        touch(begin, 1, 0, 2, 0),  # on body 1, glass: no sound of its own
        touch(begin, 2, 0, 1, 2),  # on body 0, wood, while glass is touched more deeply
        touch(begin, 3, 0, -1, 9),  # a number that nobody gave a name
        touch(impact, 4, 2, -1),  # body 1 on the static scene
        touch(impact, 5, 1, 2),  # body 0 on body 1: either has a sound, that of the second goes first
        touch(impact, 6, 3, -1),  # a body of no known material: impacts have no sound for all
    ]
    names = heard(events, body_materials=(1, 2, 0))
    assert names == ["wooden", "any", "wooden", "any", "glassy", "glassy"]
