"""A network full of streams, a sender at twenty times its rate, and markers of a megabyte: bounded, told, and over."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.contracts.shared_memory.shared_words import STOP_STRIDE
from mimics_app.inputs.commands.marker_stream import MarkerStream
from mimics_app.inputs.physio.lsl import LslSource
from tests.support.resident import resident_mb

pylsl = pytest.importorskip("pylsl")

RATE, FLOOD = 500.0, 10_000.0
MOST_MB = 80.0
"""Growth that the library's own buffers of a minute, and those of the streams beside it, may take."""
MEGABYTE = "x" * (1 << 20)


def outlet(name: str, rate: float, form: int) -> Any:
    info = pylsl.StreamInfo(name, "ECG" if rate else "Markers", 1, rate, form, f"flood {name}")
    if rate:
        channel = info.desc().append_child("channels").append_child("channel")
        channel.append_child_value("label", "ecg")
    return pylsl.StreamOutlet(info)


@contextmanager
def flooded(name: str, beside: int) -> Iterator[None]:
    """A stream that says 500 Hz, and others, all sending at 10 kHz."""
    outlets = [outlet(name, RATE, pylsl.cf_float32)]
    outlets += [outlet(f"{name} beside {i}", FLOOD, pylsl.cf_float32) for i in range(beside)]
    over = Event()

    def send() -> None:
        piece = np.zeros((round(FLOOD / 50), 1), np.float32).tolist()
        while not over.wait(0.02):
            for each in outlets:
                each.push_chunk(piece)

    sender = Thread(target=send, daemon=True)
    sender.start()
    try:
        yield
    finally:
        over.set()
        sender.join()


@pytest.mark.fault(id="F15")
@pytest.mark.parametrize(
    ("beside", "seconds"),
    [(8, 3.0), pytest.param(64, 60.0, marks=pytest.mark.slow)],
    ids=["short", "64 streams, 1 min"],
)
def test_a_sender_at_twenty_times_its_rate_takes_bounded_memory_and_is_told(beside: int, seconds: float) -> None:
    name = f"flood {time.monotonic_ns()}"
    with flooded(name, beside):
        source = LslSource(name)
        before, end, values = resident_mb(), time.monotonic() + seconds, 0
        while time.monotonic() < end:
            values += sum(len(block.values) for block in source.read(time.monotonic_ns()))
            time.sleep(1 / 60)
        grown = resident_mb() - before
        faults = source.faults["ecg"]
        source.close()
    assert values > RATE * seconds, "what comes is read"
    assert grown < MOST_MB
    assert faults.wrong_rate or faults.dropped or faults.clock_sets, faults


@pytest.mark.fault(id="F15")
@pytest.mark.parametrize("count", [20, pytest.param(500, marks=pytest.mark.slow)])
def test_a_stop_comes_through_markers_of_a_megabyte(count: int) -> None:
    name, memory, said = f"markers {time.monotonic_ns()}", SessionMemory(), list[str]()
    sender = outlet(name, 0.0, pylsl.cf_string)
    word = STOP_STRIDE * CommandSource.LSL
    before = int(memory.stop_words[word])
    markers = MarkerStream(memory, name, MonotonicClock(), said.append)
    assert sender.wait_for_consumers(20.0)
    for number in range(count):
        sender.push_sample([MEGABYTE if number % 2 else "{" + MEGABYTE])
    sender.push_sample(["stop"])
    end = time.monotonic() + 60.0
    while int(memory.stop_words[word]) == before and time.monotonic() < end:
        time.sleep(0.01)
    markers.close()
    assert int(memory.stop_words[word]) == before + 1
    assert len(said) >= count // 2 and max(map(len, said)) < 1000, "each that is no command is told in a line"
