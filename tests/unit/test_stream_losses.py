"""Losses, repetitions and set clocks of live signals: each is told from the others, and counted."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest

from mimics_app.contracts.errors import DeviceError
from mimics_app.inputs.physio.integrity import Grid
from mimics_app.inputs.physio.sources import open_source
from tests.support.amplifier import AmplifierEmulator, opened

SECOND = 1_000_000_000


def whole(blocks: list[Any]) -> np.ndarray:
    return np.concatenate([block.values for block in blocks if block is not None])


@pytest.mark.parametrize("rate", [100.0, 1000.0])
@pytest.mark.parametrize("block", [1, 5, 20])
def test_counted_losses_of_any_length_are_counted(rate: float, block: int) -> None:
    """Two samples in a hundred are lost: not one of them is taken for a drift of the clock."""
    rng, grid, blocks, lost = np.random.default_rng(1), Grid("ecg", rate, counted=True), [], 0
    for number in range(0, 4000, block):
        if number and number < 3900 and rng.random() < 0.02:
            lost += block
            continue
        t_ns = round(number / rate * SECOND)
        blocks.append(grid.take(t_ns, np.arange(number, number + block, dtype=float)))
    values = whole(blocks)
    assert lost > 0
    assert (grid.faults.lost, grid.faults.dropped) == (lost, 0)
    assert abs(grid.faults.drift_ppm) < 1.0
    good = np.isfinite(values)
    np.testing.assert_array_equal(values[good], np.flatnonzero(good))


@pytest.mark.parametrize("loss_ms", [8, 20, 35])
@pytest.mark.parametrize("jitter_ms", [0.0, 0.5])
def test_short_losses_of_a_stamped_stream_are_counted(loss_ms: int, jitter_ms: float) -> None:
    rng, grid, number = np.random.default_rng(2), Grid("ecg", 1000.0), 0
    for i in range(900):
        if i in (300, 500, 700):
            number += loss_ms
        stamp = number / 1000.0 + 1e-3 * jitter_ms * rng.standard_normal()
        grid.take(round(stamp * SECOND), np.zeros(10))
        number += 10
    assert grid.faults.gaps == 3
    assert grid.faults.lost == pytest.approx(3 * loss_ms, abs=6)
    assert abs(grid.faults.drift_ppm) < 200.0


def test_stamps_that_vary_are_no_losses() -> None:
    """A sender that is held up for some 30 ms now and then, and catches up."""
    rng, grid = np.random.default_rng(3), Grid("ecg", 500.0)
    for i in range(3000):
        held = 0.03 * rng.random() if rng.random() < 0.1 else 0.002 * rng.random()
        grid.take(round((i * 0.02 + held) * SECOND), np.zeros(10))
    assert (grid.faults.gaps, grid.faults.repeats) == (0, 0)


@pytest.mark.parametrize("jump_s", [-1.5, -20.0, -59.0, -3600.0, 5.0, 40.0, 3600.0])
@pytest.mark.fault(id="F16")
def test_a_clock_that_is_set_loses_nothing(jump_s: float) -> None:
    """Arrival goes on every 100 ms; only the stamps jump, and later back."""
    grid, blocks = Grid("ecg", 250.0), []
    for i in range(900):
        now_ns = 100 * SECOND + i * SECOND // 10
        stamp_ns = now_ns + round((jump_s if 200 <= i < 500 else 0.0) * SECOND)
        blocks.append(grid.take(stamp_ns, np.full(25, float(i)), now_ns))
    np.testing.assert_array_equal(whole(blocks), np.repeat(np.arange(900.0), 25))
    assert (grid.faults.clock_sets, grid.faults.dropped, grid.faults.lost) == (2, 0, 0)
    times = np.array([block.t_ns for block in blocks if block is not None])
    np.testing.assert_allclose(np.diff(times), SECOND / 10, atol=1e6)
    assert not grid.faults.wrong_rate


def test_lines_that_are_lost_on_a_wire_are_counted() -> None:
    """As an amplifier sends them: two lines in a hundred are missing."""
    emulator = AmplifierEmulator(["ecg"], 500.0, binary=False)
    source, rng, lost, values = opened(emulator), np.random.default_rng(4), 0, []
    for number in range(1000):
        if 0 < number < 990 and rng.random() < 0.02:
            emulator.skip(1)
            lost += 1
        else:
            emulator.send(np.full((1, 1), float(number)))
        if number % 50 == 49:
            time.sleep(0.01)
            values += [block.values for block in source.read(time.monotonic_ns())]
    end = time.monotonic() + 10.0
    while sum(map(len, values)) < 1000 and time.monotonic() < end:
        values += [block.values for block in source.read(time.monotonic_ns())]
    found = np.concatenate(values)
    np.testing.assert_array_equal(found[np.isfinite(found)], np.flatnonzero(np.isfinite(found)))
    assert (len(found), source.faults["ecg"].lost) == (1000, lost)
    source.close()
    emulator.unplug()


def outlet_of(name: str, form: str, source_id: str) -> Any:
    import pylsl

    info = pylsl.StreamInfo(name, "ECG", 1, 250.0, form, source_id)
    return pylsl.StreamOutlet(info)


def test_a_stream_of_texts_is_refused() -> None:
    name = f"mimics texts {time.monotonic_ns()}"
    outlet = outlet_of(name, "string", name)
    with pytest.raises(DeviceError, match="are text"):
        open_source(f"lsl:{name}", 1)
    del outlet


def test_a_name_with_a_quote_is_found() -> None:
    name = f"O'Brien {time.monotonic_ns()}"
    outlet = outlet_of(name, "float32", name)
    source = open_source(f"lsl:{name}", 1)
    assert source.lost == ""
    source.close()
    del outlet


def test_a_stream_without_a_source_id_that_ends_is_lost() -> None:
    name = f"mimics ends {time.monotonic_ns()}"
    outlet = outlet_of(name, "float32", "")
    source = open_source(f"lsl:{name}", 1)
    source.read(time.monotonic_ns())
    assert outlet.wait_for_consumers(10.0)
    outlet.push_chunk([[0.0]] * 50)
    del outlet
    end = time.monotonic() + 15.0
    while "has ended" not in source.lost and time.monotonic() < end:
        source.read(time.monotonic_ns())
        time.sleep(0.05)
    assert "has ended" in source.lost
    assert source.read(time.monotonic_ns()) == ()
    source.close()
