"""Pick and place on an emulated robot, over its line and protocol, in lockstep: a tick, then a step of the robot."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import msgspec

from mimics_app.app.devices.emulator import EmulatorSettings, open_emulator
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.touch.bare_play import BarePlay
from mimics_app.world.components.robot import Patient, Robot
from tests.support.device_rig import Rig
from tests.support.market_play import SCENE

__all__ = ["Lockstep", "market_rig", "play_on"]


class Lockstep:
    """A haptic engine whose emulated robot moves with it: nobody waits for anybody, and ticks can be counted."""

    def __init__(self, engine: Any, rig: Rig) -> None:
        self._engine = engine
        self._rig = rig

    def advance(self, ticks: int) -> None:
        for _ in range(ticks):
            self._engine.advance(1)
            self._rig.step()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._engine, name)


@contextmanager
def market_rig(name: str) -> Iterator[Rig]:
    """The robot of pick and place with its person, as `mimics devices emulate NAME --scene` has them."""
    with open_emulator(name, EmulatorSettings(SCENE, seed=7)) as emulator:
        yield Rig(emulator, name)


def play_on(rig: Rig, seconds: float, wanted: int) -> dict[str, Any]:
    """`task` of a session of pick and place on that robot, until so many apples are placed or its time is over."""
    scene = load_checked_scene(SCENE)
    robot = msgspec.structs.replace(scene.one(Robot)[1], device=f"{rig.name}:{rig.emulator.address}")
    with rig.attended():
        play: Any = BarePlay(scene, scene.sections["task"], robot, scene.one(Patient)[1], 7)
    play.haptics = Lockstep(play.haptics, rig)
    try:
        while play.now_ns < seconds * 1e9 and play.tasks.result()["placed"] < wanted:
            play.step()
        play.tasks.end_session(play.now_ns)
        stops = play.haptics.histogram().stops
    finally:
        play.haptics.stop()
    return {**play.tasks.result(), "stops": stops}
