"""Pick and place on a serial robot and on a HapticMaster: apples are placed, and a pulled plug is a safe stop."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.play.pace import run_virtual
from mimics_app.app.play.result import summarise
from mimics_app.app.session.assembly import build_session
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.app.session.watches import DeviceWatch
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import VirtualClock
from mimics_app.contracts.loop.haptic import DeviceStatus, SafetyState, TripCause
from mimics_app.contracts.messages.window_input import GamepadState, InputEvent
from mimics_app.inputs.interaction.simulated_patient import SimulatedPatient
from mimics_app.inputs.stage import Inputs
from mimics_app.recording.run import Run
from tests.support.device_rig import Rig
from tests.support.market_play import SCENE
from tests.support.robot_play import Lockstep, advance_frame, market_rig

SECONDS = 20.0
"""More than enough for the first apple."""

FELT = 1.0
"""A force [N] that a hand in contact feels."""

AFTER = 300
"""Frames of a stop at most until something that should happen has happened."""


@pytest.mark.parametrize("name", [pytest.param("serial", marks=pytest.mark.slow), "hapticmaster"])
def test_apples_are_placed_through_the_line(name: str):
    with market_rig(name) as rig:
        result = advance_frame(rig, SECONDS, 1)
    assert result["placed"] >= 1
    assert (result["stops"], result["bruises"]) == (0, 0)


class Keys:
    """A window of which only the keyboard is there."""

    def __init__(self) -> None:
        self.gamepad = GamepadState()
        self._pressed: list[str] = []

    def press(self, name: str) -> None:
        self._pressed.append(name)

    def poll(self) -> list[InputEvent]:
        events = [InputEvent("key", name, pressed=True) for name in self._pressed]
        self._pressed.clear()
        return events


@contextmanager
def session_on(rig: Rig, runs: Path) -> Iterator[tuple[Session, Frames, Keys]]:
    """A whole session with its recorder on an emulated robot, in lockstep on the virtual clock."""
    settings = RunSettings(
        scene=SCENE, device=f"{rig.name}:{rig.emulator.address}", headless=True, runs=runs, sound="off", seconds=60.0
    )
    with rig.attended():
        session: Any = build_session(settings, live=False)
    with session:
        keys = Keys()
        session.clock, session.haptics = VirtualClock(), Lockstep(session.haptics, rig)
        session.inputs = Inputs([SimulatedPatient(intent=True, follows_path=False)], window=keys)
        yield session, Frames(session), keys


class Met(Exception):
    """What a run was to go on until."""


def run_until(met: Callable[[], bool], session: Session, frames: Frames) -> bool:
    """Frames until something is so; a stop, which ends a run, is waited out."""

    def look(_: Frames) -> None:
        if met():
            raise Met

    for _ in range(AFTER):
        try:
            run_virtual(session, frames, look)
        except Met:
            return True
    return False


def test_pulled_plug_in_contact_is_no_force_within_5_ticks_and_a_reset_goes_on(tmp_path: Path, capsys):
    with market_rig("serial") as rig, session_on(rig, tmp_path) as (session, frames, keys):
        watch = DeviceWatch(session.haptics.plugin, session.recorder)
        seen: Callable[[], Any] = lambda: frames.snapshot  # noqa: E731
        assert run_until(
            lambda: seen().held_body >= 0 and np.linalg.norm(seen().f_user_world) > FELT, session, frames
        ), "the apple is in the hand"
        rig.spoil("unplug")
        pulled = session.haptics.ticks
        assert run_until(lambda: watch.check() != "", session, frames), "the person is informed"
        rig.spoil("plug")
        assert run_until(lambda: watch.check() == "", session, frames), "the line is back"
        back = session.haptics.ticks
        keys.press("r")
        assert run_until(lambda: seen().ramp == 1.0, session, frames), "after a reset the task goes on"
        ended = session.haptics.ticks
        session.end_stages()
        session.finish(summarise(session, frames, None, 1.0))
    samples = Run.open(session.folder).haptic
    assert np.array_equal(samples["tick"], np.arange(ended)), "the recording went on"
    force = np.linalg.norm(samples["f_user_world"], axis=1)
    assert force[pulled - 1] > FELT
    assert (force[pulled + 5 : back] == 0.0).all()
    assert set(samples["cause"][pulled + 5 : back]) == {float(TripCause.DEVICE_FAULT)}
    assert (samples["status"][pulled + 5 : pulled + 20] == DeviceStatus.FAULT).all()
    assert (samples["state"][back:] == SafetyState.ACTIVE).sum() > 100, "after a reset it goes on"
    assert samples["ramp"][back:].max() == 1.0 and samples["status"][back + 1] == DeviceStatus.FRESH
    printed = capsys.readouterr().err
    assert "is gone: no force" in printed and "the device is back: press R to resume" in printed
    assert sum('"kind":"device"' in line for line in (session.folder / "events.jsonl").read_text().splitlines()) >= 2


@pytest.mark.slow
@pytest.mark.parametrize("name", ["serial", "hapticmaster"])
def test_three_apples_in_a_minute_with_processes_of_their_own(name: str, tmp_path: Path):
    """Real time: on a machine that has time for it."""
    program = [sys.executable, "-m", "mimics_app.app.cli"]
    emulate = [*program, "devices", "emulate", name, "--scene", str(SCENE), "--seconds", "600"]
    with subprocess.Popen(emulate, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as robot:
        assert robot.stdout is not None and robot.stdin is not None
        try:
            address = robot.stdout.readline().strip()
            options = ["--headless", "--seconds", "60", "--json", "--pictures", "0", "--runs", str(tmp_path)]
            done = subprocess.run(
                [*program, "run", str(SCENE), "--device", address, *options],
                capture_output=True,
                text=True,
                timeout=300,
                check=False,
            )
        finally:
            robot.stdin.write("quit\n")
            robot.stdin.flush()
    answer = json.loads(done.stdout)
    assert (done.returncode, answer["safety"]["stops"]) == (0, 0), done.stderr
    assert answer["task"]["placed"] >= 3
