"""Sources of body signals of every kind, and of another package, by one conformance kit."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.contracts.system.resources import root
from mimics_app.inputs.physio.simulated.source import PRESETS
from mimics_app.inputs.physio.sources import KINDS, open_source
from mimics_app.inputs.stage import Movement
from tests.support.amplifier import AmplifierEmulator, opened
from tests.support.guide import pieces, written_module
from tests.support.plugin_site import write_package
from tests.support.signal_source_kit import FRAME_NS, check_signal_source, on_the_virtual_clock

RATE = 600
PER_FRAME = 10
BOX = '''
"""Boxes that send a ramp at 600 Hz, right and with a fault each."""
import numpy as np
from mimics_app.contracts.messages.stage_messages import SignalBlock

RATE = 600.0


class Box:
    def __init__(self, rest, seed):
        self.begun_ns, self.taken, self.lost = None, 0, ""  # no attribute of the class

    def read(self, now_ns):
        self.begun_ns = now_ns if self.begun_ns is None else self.begun_ns
        due = int((now_ns - self.begun_ns) * RATE / 1e9)
        t_ns, values = self.begun_ns + round(self.taken / RATE * 1e9), np.arange(self.taken, due, dtype=float)
        self.taken = due
        return (self.block(t_ns, values),) if len(values) else ()

    def block(self, t_ns, values):
        return SignalBlock("ecg", RATE, t_ns, values)

    def take_experience(self, experience):
        pass

    def close(self):
        pass


class Listed(Box):
    def read(self, now_ns):
        return list(super().read(now_ns))


class Early(Box):
    def block(self, t_ns, values):
        return SignalBlock("ecg", RATE, t_ns + 1_000_000_000, values)


class Again(Box):
    def read(self, now_ns):
        self.last = super().read(now_ns) or getattr(self, "last", ())
        return self.last


class Endless(Box):
    def block(self, t_ns, values):
        return SignalBlock("ecg", RATE, t_ns, np.where(values == 100.0, np.inf, values))


class Whole(Box):
    def block(self, t_ns, values):
        return SignalBlock("ecg", RATE, t_ns, values.astype(int))


class Wavering(Box):
    def block(self, t_ns, values):
        return SignalBlock("ecg", RATE + (t_ns % 7), t_ns, values)


class Shared(Box):
    kept = np.zeros(1000)

    def block(self, t_ns, values):
        self.kept[: len(values)] = values
        return SignalBlock("ecg", RATE, t_ns, self.kept[: len(values)])


class Sparse(Box):
    def block(self, t_ns, values):
        return SignalBlock("ecg", RATE, t_ns, values[:1])


class Silent(Box):
    def read(self, now_ns):
        return ()


class Gone(Box):
    def __init__(self, rest, seed):
        super().__init__(rest, seed)
        self.lost = "the box is off"


def bare(rest, seed):
    return object()
'''
FAULTS = {
    "Listed": "a tuple",
    "Early": "before its time",
    "Again": "each sample comes once",
    "Endless": "a missing sample is NaN",
    "Whole": "values are float64",
    "Wavering": "changed from",
    "Shared": "stays what it was",
    "Sparse": "keeps the pace",
    "Silent": "it delivers signals",
    "Gone": "the box is off",
}
GROUP = "[mimics_app.signal_sources]\n" + "".join(
    f"{name.lower()} = lab_of_boxes:{name}\n" for name in ("Box", "bare", *FAULTS)
)


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(write_package(tmp_path, "lab_of_boxes", BOX, GROUP)))


def file(folder: Path) -> SignalSource:
    """Two seconds of a table with a hole."""
    rows = [f"{10 + i / RATE:.6f},{i}" for i in range(2 * RATE) if not 100 <= i < 130]
    (folder / "a.csv").write_text("\n".join(["t_s,ecg", *rows]))
    return open_source(f"file:{folder / 'a.csv'}", 1)


def test_what_a_package_opens_is_a_source_or_refused(installed: None) -> None:
    with pytest.raises(
        DeviceError, match="lab_of_boxes:bare made an object of the type object, which lacks lost, read"
    ):
        open_source("bare:left", 3)


@pytest.mark.parametrize("address", [*(f"sim:{preset}" for preset in PRESETS), "box:left"])
def test_source_keeps_the_contract(address: str, installed: None) -> None:
    check_signal_source(open_source(address, 3))


def test_a_file_keeps_the_contract(tmp_path: Path) -> None:
    check_signal_source(file(tmp_path))


def test_the_movement_keeps_the_contract() -> None:
    check_signal_source(Movement())


@pytest.mark.parametrize("binary", [False, True])
def test_an_amplifier_keeps_the_contract(binary: bool) -> None:
    emulator = AmplifierEmulator(["ecg", "eda"], RATE, binary=binary)
    source = opened(emulator)

    def send(frame: int) -> int:
        emulator.send(np.full((PER_FRAME, 2), float(frame)))
        if frame == 30:
            emulator.skip(PER_FRAME)  # a gap
        return on_the_virtual_clock(frame + (frame > 30))

    check_signal_source(source, send)
    emulator.unplug()


def in_real_time(send: Callable[[], None]) -> Callable[[int], int]:
    def wait(frame: int) -> int:
        send()
        time.sleep(FRAME_NS * 1e-9)
        return time.monotonic_ns()

    return wait


def test_a_stream_of_lsl_keeps_the_contract() -> None:
    import pylsl

    name = f"mimics contract {time.monotonic_ns()}"
    info = pylsl.StreamInfo(name, "ECG", 1, RATE, "float32", name)
    outlet = pylsl.StreamOutlet(info)
    source = open_source(f"lsl:{name}", 1)
    source.read(time.monotonic_ns())  # opens the stream
    outlet.wait_for_consumers(10.0)
    begun, sent = pylsl.local_clock(), 0

    def send() -> None:
        nonlocal sent
        due = int((pylsl.local_clock() - begun) * RATE)
        for number in range(sent, due):
            outlet.push_sample([0.0], begun + number / RATE)
        sent = due

    check_signal_source(source, in_real_time(send))


def test_every_built_in_kind_is_here() -> None:
    """The board's is tested beside the board, whose library may be missing."""
    assert set(KINDS) == {"sim", "file", "lsl", "serial", "board"}


@pytest.mark.parametrize("name", FAULTS)
def test_a_faulty_source_is_found(name: str, installed: None) -> None:
    with pytest.raises(AssertionError, match=FAULTS[name]):
        check_signal_source(open_source(f"{name.lower()}:left", 1))


def test_the_source_of_the_guide_passes(tmp_path: Path) -> None:
    guide = root() / "docs" / "guide" / "physiology.md"
    module = written_module(tmp_path, next(piece for piece in pieces(guide) if piece.purpose == "source=metronome"))
    check_signal_source(module.metronome("200", 1))
