"""Persons who speak: the mouth is open where the recording is loud, and shut where it is silent."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import soundfile

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.sound import open_sound
from mimics_app.contracts.messages.stage_messages import SoundTrigger, TaskOrders
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.world.files.scene.file import build_world

RATE, FRAME_S = 16_000, 1.0 / 60.0
SYLLABLES = ((0.2, 0.45), (0.7, 0.95), (1.2, 1.45))
"""Beginnings and ends of what is said [s]."""


def speaking_scene(folder: Path) -> Path:
    t = np.arange(int(1.7 * RATE)) / RATE
    said = sum(((t > begin) & (t < end)) * np.sin(2.0 * np.pi * 180.0 * t) for begin, end in SYLLABLES)
    soundfile.write(folder / "said.wav", 0.3 * said, RATE)
    person = {"mesh": {"source": "model"}, "avatar": {"blink": False}, "sound": {"asset": "said", "trigger": "goal"}}
    document = {
        "format": "mimics-scene",
        "version": 1,
        "scenario": "none",
        "assets": {"model": {"uri": "mimics:assets/models/avatars/therapist.glb"}, "said": {"uri": "said.wav"}},
        "entities": [{"id": "eye", "components": {"camera": {}}}, {"id": "person", "components": person}],
    }
    file = folder / "scene.json"
    file.write_text(json.dumps(document))
    return file


def test_the_mouth_opens_with_the_syllables(tmp_path: Path) -> None:
    scene = load_checked_scene(speaking_scene(tmp_path))
    world = build_world(scene)
    sound = open_sound(scene, "file", SessionMemory(), tmp_path, live=False)
    animator = world.motion.animators[world.find("person").index]
    jaw = animator.rig.morph_names.index("jaw")
    opened = []
    for frame in range(120):
        now_ns = round(frame * FRAME_S * 1e9)
        triggers = [SoundTrigger("goal", now_ns)] if frame == 12 else []
        sound.step(TaskOrders(), world, now_ns, triggers)
        world.motion.time = frame * FRAME_S
        world.motion.pose(world.transforms)
        opened.append(float(animator.pose.morphs[jaw]))
    sound.stop()
    since = (np.arange(120) - 12) * FRAME_S
    inside = np.zeros(120, bool)
    near = np.zeros(120, bool)
    for begin, end in SYLLABLES:
        inside |= (since > begin + 0.06) & (since < end - 0.06)
        near |= (since > begin - 0.06) & (since < end + 0.06)
    assert np.min(np.array(opened)[inside]) > 0.5
    assert np.max(np.array(opened)[~near]) < 1e-6
