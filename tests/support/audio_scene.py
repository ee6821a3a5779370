"""What the sound tests share: contact records, and where a sound begins in a mix."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.loop.contact_force import CONTACT_FORCE
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.shared_memory import ring, triple_buffer
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.sound_scene import SOUND_SCENE, fill_defaults

RATE = 48_000


def contact(
    t_ns: int, *, speed: float = 0.5, force: float = 5.0, body: int = 0, position=(0.0, 0.0, -1.0)
) -> np.ndarray:
    """One CONTACT_BEGIN record, shape [1]."""
    event = np.zeros(1, EVENT)
    event["kind"], event["t_ns"], event["tick"] = EventKind.CONTACT_BEGIN, t_ns, t_ns // 1_000_000
    event["body_a"], event["body_b"] = body, -1
    event["speed"], event["force"], event["position_world"] = speed, force, position
    return event


def push(memory: SessionMemory, event: np.ndarray) -> bool:
    """Do what the haptic loop does with an event."""
    return bool(ring.push(memory.audio_event_words, memory.audio_events, event))


def push_forces(memory: SessionMemory, t_ns: int, forces: np.ndarray, body: int = 0) -> None:
    """Forces [N] of the contact of `contact(t_ns, body=body)` in the ticks after its event, as published."""
    row = np.zeros(1, CONTACT_FORCE)
    for k, force in enumerate(forces, 1):
        row["t_ns"], row["body_a"], row["body_b"], row["force"] = t_ns + k * 1_000_000, body, -1, force
        assert ring.push(memory.audio_force_words, memory.audio_forces, row)


def first_sounding(mix: np.ndarray, begin: int) -> int:
    """Frame of the first sample that is not exactly zero, from `begin` on; -1: none."""
    sounding = np.flatnonzero(np.abs(mix[begin:]).max(axis=1) > 0.0)
    return begin + int(sounding[0]) if len(sounding) else -1


def place(memory: SessionMemory, t_ns: int, emitters=(), **head) -> None:
    """Do what the frame does with head and emitters, (place, gain) each; `head` names fields of SOUND_SCENE."""
    scene = np.zeros(1, SOUND_SCENE)
    fill_defaults(scene)
    scene["t_ns"] = t_ns
    for name, value in head.items():
        scene[name] = value
    for row, (position, gain) in enumerate(emitters):
        scene["position"][0, row], scene["gain"][0, row] = position, gain
    slot = triple_buffer.back_slot(memory.sound_scene_words)
    memory.sound_scenes[slot : slot + 1] = scene
    triple_buffer.publish(memory.sound_scene_words)
