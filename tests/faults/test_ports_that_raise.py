"""Whatever a source, tracker, vibrator or display raises, from any call: it is lost and told, the rest goes on."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mimics_app.app.session.watches import SignalWatch, TactileWatch
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.stage_messages import Experience, SignalBlock, TactileEvent
from mimics_app.contracts.ports.display_port import Display, FrameTiming
from mimics_app.contracts.ports.input_port import SignalSource, WindowFrame
from mimics_app.contracts.ports.tracker_port import TrackerSample, TrackerSink, TrackerSource
from mimics_app.dsp.channel_kinds import check_rate
from mimics_app.inputs.physio import sources
from mimics_app.inputs.physio.guarded_source import GuardedSource
from mimics_app.inputs.physio.sources import KINDS, open_source
from mimics_app.inputs.stage import Inputs
from mimics_app.inputs.trackers.hub import MountedTracker, TrackerHub
from mimics_app.inputs.trackers.polled_tracker import PolledTracker
from mimics_app.inputs.trackers.threaded_tracker import ThreadedTracker
from mimics_app.rendering.tactile.vibrators import GuardedVibrators, NoVibrators, Vibrators
from mimics_app.rendering.visual.displays.desktop import DesktopDisplay
from mimics_app.rendering.visual.presenting.presenter import Presenter

ERRORS = (RuntimeError("no answer"), DeviceError("the cable is out"), KeyError("x"), StopIteration())
PRIVATE = "_"


def calls_of(port: type) -> list[str]:
    """The public members of a port, methods and properties alike."""
    called = (name for name, member in vars(port).items() if callable(member) or isinstance(member, property))
    return [name for name in called if not name.startswith(PRIVATE)]


def raising(base: type, call: str, error: Exception) -> type:
    """A class like another whose one member raises."""

    def fail(*_: Any, **__: Any) -> Any:
        raise error

    member: Any = property(fail) if isinstance(vars(base).get(call), property) else fail
    return type("Raising", (base,), {call: member})


class _Sender(SignalSource):
    closed = False

    @property
    def lost(self) -> str:
        return ""

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        return (SignalBlock("gsr", 100.0, now_ns, np.ones(1)),)

    def take_experience(self, experience: Experience) -> None:
        pass

    def close(self) -> None:
        self.closed = True


class _Notes:
    """A recorder of journal lines."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, dict[str, Any]]] = []

    def journal(self, kind: str, line: dict[str, Any]) -> None:
        self.lines.append((kind, line))


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("call", calls_of(SignalSource))
def test_a_source(call: str, error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    """Opened by its address, as a built-in one, beside one that works."""
    monkeypatch.setitem(sources.KINDS, "sim", lambda rest, seed: raising(_Sender, call, error)())
    bad, good, told, notes = open_source("sim:", 1, check_rate), _Sender(), list[str](), _Notes()
    inputs = Inputs([], (bad, good))
    watch = SignalWatch(inputs.signals, notes, told.append)  # type: ignore[arg-type]
    for frame in range(3):
        assert inputs.poll(frame).signals, "the other one is heard"
        inputs.take_experience(Experience(frame))
        watch.check(frame)
    inputs.close()
    assert good.closed
    if call != "close":
        assert len(told) == 1 and told[0].startswith('body signals are lost: the source "sim:" raised')
        assert notes.lines[0][0] == "signal_source"


@pytest.mark.parametrize("kind", KINDS)
def test_every_built_in_source_is_guarded(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sources.KINDS, kind, lambda rest, seed: _Sender())
    assert isinstance(open_source(f"{kind}:x", 1), GuardedSource)


@pytest.mark.parametrize("rates", [(100.0, 50.0), (0.0,), (1e6,), (float("nan"),)])
def test_a_rate_that_changes_or_cannot_be_ends_the_source_alone(rates: tuple[float, ...]) -> None:
    sent = iter(rates)

    class Changing(_Sender):
        def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
            return (SignalBlock("gsr", next(sent, rates[-1]), now_ns, np.ones(1)),)

    source = GuardedSource(Changing(), "it", check_rate)
    for frame in range(3):
        source.read(frame)
    assert 'rate of the signal "gsr"' in source.lost
    assert source.read(4) == ()


class _Tracker(PolledTracker):
    def _report(self, now_ns: int, sink: TrackerSink) -> None:
        sink(TrackerSample("1", now_ns, (0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)))


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("call", calls_of(TrackerSource))
def test_a_tracker(call: str, error: Exception) -> None:
    bad = raising(_Tracker, call, error)("bad")
    hub = TrackerHub([MountedTracker(bad, {"1": "hand_left"}), MountedTracker(_Tracker("good"), {"1": "head"})])
    if call == "start":
        with pytest.raises(DeviceError):
            hub.start()
        return
    hub.start()
    told: list[str] = []
    hub.attach_display(list)
    for frame in range(3):
        hub.take_window(WindowFrame())
        hub.poll(frame)
        told += hub.take_problems()
    assert hub.head(2) is not None
    hub.stop()
    told += hub.take_problems()
    assert len(told) == 1 and told[0].startswith("tracker bad: it is lost: it raised")


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_a_tracker_whose_thread_raises_says_so(error: Exception) -> None:
    class Reader(ThreadedTracker):
        def _open(self) -> None:
            pass

        def _read(self, sink: TrackerSink) -> None:
            raise error

        def _close(self) -> None:
            pass

    hub = TrackerHub([MountedTracker(Reader("box", MonotonicClock()), {"1": "head"})])
    hub.start()
    hub.stop()
    (problem,) = hub.take_problems()
    assert problem.startswith("tracker box: it is lost: it raised")


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("call", calls_of(Vibrators))
def test_vibrators(call: str, error: Exception) -> None:
    driver, notes, told = GuardedVibrators(raising(NoVibrators, call, error)()), _Notes(), list[str]()
    watch = TactileWatch(notes, told.append)  # type: ignore[arg-type]
    for number in range(3):
        watch.take(driver.step((TactileEvent("back", 7, number=number),), number), number)
    driver.close()
    assert [line["number"] for _, line in notes.lines] == [0, 1, 2], "every tap is in the journal"
    assert len(told) == (call == "step")


def surface() -> Any:
    """A surface without a context: as large as its picture, so that nothing is composed."""
    shown = SimpleNamespace(backend="software", size=(8, 6), resize=lambda size: None, reset_status=lambda: "")
    shown.both_eyes = None
    return shown


class _Display(DesktopDisplay):
    leaving = False

    def begin_frame(self, now_ns: int) -> FrameTiming:
        return FrameTiming(now_ns)


CAMERA: Any = SimpleNamespace(world_from_eye=np.eye(4), vertical_fov=0.8, near=0.1, far=10.0)


def show_a_frame(presenter: Presenter, number: int) -> None:
    """Every call of a display that a session makes."""
    presenter.begin(number)
    presenter.tracked()
    assert presenter.views(CAMERA)
    presenter.present()
    presenter.begin(number)
    presenter.skip()
    presenter.take_pressed()
    assert not presenter.leaving
    presenter.renew()


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
@pytest.mark.parametrize("call", calls_of(Display))
def test_a_display(call: str, error: Exception) -> None:
    made = raising(_Display, call, error)
    presenter, told = Presenter(made(), surface()), list[str]()
    for number in range(2):
        show_a_frame(presenter, number)
        told += presenter.take_faults()
    presenter.release()
    if call != "close":
        assert len(told) == 1 and told[0].endswith("the picture is shown on the desktop")
