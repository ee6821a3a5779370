"""Pick and place on an emulated robot, over its line and protocol, in lockstep: a tick, then a step of the robot."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from mimics_app.app.devices.emulator import EmulatorSettings, open_emulator
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import VirtualClock
from tests.support.core_play import change_component
from tests.support.device_rig import Rig
from tests.support.market_play import SCENE

__all__ = ["Lockstep", "advance_frame", "market_rig"]


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


def advance_frame(rig: Rig, seconds: float, wanted: int) -> dict[str, Any]:
    """`task` of a session of pick and place on that robot, until so many apples are placed or its time is over."""
    scene = load_checked_scene(SCENE)
    change_component(scene, "robot", device=f"{rig.name}:{rig.emulator.address}")
    with rig.attended():
        core: Any = open_core(prepare_scene(scene, RunSettings(SCENE, seed=7)))
    core.clock, core.haptics = VirtualClock(), Lockstep(core.haptics, rig)
    with core:
        frames = Frames(core)
        while core.clock.now_ns() < seconds * 1e9 and core.tasks.result()["placed"] < wanted:
            frames.advance_frame()
        stops = core.haptics.histogram().stops
    return {**core.tasks.result(), "stops": stops}
