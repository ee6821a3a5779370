"""One assembly and one frame: what is wired once acts in a run, a still, a sweep and a bench alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mimics_app as mimics
from mimics_app.app.bench import realtime_load
from mimics_app.app.picture.picture import Picture
from mimics_app.app.play.stills import draw_stills
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.session.body import Body, NullDsp
from mimics_app.app.session.core import open_core
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.preparation import prepare_scene
from mimics_app.app.settings import RunSettings
from mimics_app.app.sweep.patient import travel
from mimics_app.contracts.errors import DeviceError, UsageError
from mimics_app.contracts.messages.stage_messages import FeatureFrame, SignalBlock, TaskAction
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.haptic.engine import HapticEngine

TUNNEL = root() / "scenes" / "wavy_tunnel.json"
MARKET = root() / "scenes" / "pick_and_place.json"


class CountingDsp(NullDsp):
    """Counts its frames."""

    frames = 0

    def process(self, signals: Any, now_ns: int) -> FeatureFrame:
        CountingDsp.frames += 1
        return super().process(signals, now_ns)


def run(folder: Path) -> None:
    with mimics.open("wavy_tunnel", seconds=0.2, runs=folder) as session:
        session.run()


def render(folder: Path) -> None:
    try:
        draw_stills(RunSettings(TUNNEL, size=(64, 36)), folder)
    except DeviceError as error:
        pytest.skip(str(error))


def sweep(folder: Path) -> None:
    travel(load_checked_scene(TUNNEL), "", 1, {}, profile="training", seconds=0.2)


def bench(folder: Path) -> None:
    try:
        realtime_load.main("unprivileged", TUNNEL, 0.2)
    except DeviceError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize("way", [run, render, sweep, bench])
def test_a_stage_of_the_core_acts_whoever_plays(way: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mimics_app.app.session.body.NullDsp", CountingDsp)
    monkeypatch.setattr(realtime_load, "_SIZE", (64, 36))
    monkeypatch.setattr(CountingDsp, "frames", 0)
    way(tmp_path)
    assert CountingDsp.frames > 0


class Chooser:
    """A learning system that chooses another action after every frame."""

    def __init__(self, log: list[str]) -> None:
        self._log = log
        self._chosen = 0

    def choose(self, state: Any, result: Any, reward: float | None, now_ns: int) -> TaskAction:
        self._chosen += 1
        self._log.append(f"choose {self._chosen}")
        return TaskAction({"number": float(self._chosen)})


def test_learning_chooses_after_the_task_and_for_the_next_frame() -> None:
    log: list[str] = []
    parts = prepare_scene(load_checked_scene(TUNNEL), RunSettings(TUNNEL))
    with open_core(replace(parts, body=Body(learning=Chooser(log)))) as core:
        task = core.tasks.step

        def step(vr: Any, action: TaskAction, *rest: Any) -> Any:
            log.append(f"task {action.values['number']:g}")
            return task(vr, None, *rest)

        core.tasks.step = step  # type: ignore[method-assign,assignment]
        frames = Frames(core)
        frames.advance_frame()
        frames.advance_frame()
    assert log == ["choose 1", "task 1", "choose 2", "task 2", "choose 3"]


def test_a_still_shows_the_board_of_the_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    boards: list[Any] = []
    monkeypatch.setattr(Picture, "lay_out", lambda self, board, views: boards.append(board))
    try:
        draw_stills(RunSettings(MARKET, size=(64, 36)), tmp_path, frames=2, seconds=0.5)
    except DeviceError as error:
        pytest.skip(str(error))
    assert {"placed", "drops", "time", "margin"} <= set(boards[-1].cards)
    assert boards[-1].cards["time"].text == "0.5 s", "the time of the trial, not of its start"
    assert boards[-1].message


def test_a_still_of_a_trial_is_the_frame_a_run_has_there(tmp_path: Path) -> None:
    """The same seed: where the hand is some frames into the trial does not depend on who plays."""
    with open_core(prepare_scene(load_checked_scene(TUNNEL), RunSettings(TUNNEL, seed=3))) as core:
        frames = Frames(core)
        frames.play_to_start()
        drawn = frames.number
        still = frames.snapshot
    with mimics.open("wavy_tunnel", seed=3, runs=tmp_path) as session:
        session.step(drawn / 60)
        same = session.state
    assert still is not None
    assert (still.tick, still.hip_world.tobytes()) == (same["tick"][0], same["hip_world"].tobytes())


def test_a_session_that_has_ended_plays_no_further_frame() -> None:
    with open_core(prepare_scene(load_checked_scene(TUNNEL), RunSettings(TUNNEL))) as core:
        frames = Frames(core)
        frames.advance_frame()
        core.stop()  # once more at the end of the block: nothing happens
        for play in (frames.step, frames.advance_frame, frames.play_to_start, Frames(core).step):
            with pytest.raises(UsageError, match="session is closed"):
                play()
        assert frames.number == 1


class Closing(SignalSource):
    """A source of a block a frame; the first one fails as it is closed."""

    def __init__(self, log: list[str], name: str) -> None:
        self._log, self._name = log, name

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        return (SignalBlock(self._name, 60.0, now_ns, np.zeros(1)),)

    def close(self) -> None:
        self._log.append(self._name)
        if self._name == "first":
            raise DeviceError("the amplifier is gone")


def test_a_device_that_fails_at_the_end_keeps_no_other_open_and_costs_no_signal(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    log: list[str] = []
    sources = Closing(log, "first"), Closing(log, "second")
    monkeypatch.setattr(HapticEngine, "stop", lambda self: (_ for _ in ()).throw(DeviceError("the loop ended")))
    parts = prepare_scene(load_checked_scene(TUNNEL), RunSettings(TUNNEL))
    core = open_core(replace(parts, body=Body(sources=sources)))
    monkeypatch.setattr(core.recorder, "signals", lambda rows: log.extend(row.block.name for row in rows))
    Frames(core).advance_frame()
    with pytest.raises(DeviceError):
        core.stop()
    assert log == ["first", "second", "first", "second"], "closed, then sent to the recorder"
    assert core.ended
    parts.plugin.close()


def test_a_device_that_does_not_say_its_values_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(*_: object) -> None:
        raise DeviceError("the line is gone")

    log: list[str] = []
    parts = prepare_scene(load_checked_scene(TUNNEL), RunSettings(TUNNEL))
    monkeypatch.setattr("mimics_app.app.session.core.device_values", lost)
    with pytest.raises(DeviceError, match="line is gone"):
        open_core(replace(parts, plugin=replace(parts.plugin, close=lambda: log.append("closed"))))
    assert log == ["closed"]
