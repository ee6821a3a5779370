"""How late the loop really wakes: from a short live run on this machine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts import ring
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.haptic import SAMPLE
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.haptic.scene_block import scene_from_components
from mimics_app.world.components.robot import Robot

__all__ = ["measure_lateness"]

Vec = NDArray[np.float64]


def measure_lateness(seconds: float) -> Vec:
    """Lateness [s] of every tick of the live loop with the simulated robot, for at most 8 s."""
    memory = SessionMemory()
    robot = Robot()
    engine = HapticEngine(memory, build_device(robot))
    engine.publish(scene_from_components(robot))
    clock = MonotonicClock()
    engine.start()
    clock.sleep_until_ns(clock.now_ns() + round(seconds * 1e9))
    engine.stop()
    out = np.zeros(memory.samples.shape[0], SAMPLE)
    count = ring.drain(memory.sample_words, memory.samples, out)
    return np.asarray(out["lateness_ns"][:count] * 1e-9)
