"""Where body signals come from: files, amplifiers at a line, LSL streams; what is wrong with them is reported."""

from __future__ import annotations

import json
import re
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar
from unittest.mock import MagicMock

import edfio
import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.physio.watch import Watch
from mimics_app.app.session.frame import experience_of
from mimics_app.app.session.watches import SignalWatch
from mimics_app.contracts.errors import DeviceError, SceneError, UsageError
from mimics_app.contracts.messages.stage_messages import Experience, SignalBlock, TaskOrders
from mimics_app.contracts.ports.plugins import PluginGroup
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.inputs.physio import sources
from mimics_app.inputs.physio.amplifier_frames import AmplifierReader
from mimics_app.inputs.physio.channel_names import unit_factor
from mimics_app.inputs.physio.guarded_source import GuardedSource
from mimics_app.inputs.physio.integrity import Faults, Grid
from mimics_app.inputs.physio.recording import FileSource, read_signal_file
from mimics_app.inputs.physio.serial_amplifier import SerialAmplifier
from mimics_app.inputs.physio.simulated.source import SimulatedBody
from mimics_app.inputs.physio.sources import find_source, open_source
from mimics_app.inputs.stage import Movement
from mimics_app.maths.poses import rotation_from_vector
from tests.support.amplifier import AmplifierEmulator, binary_header, binary_samples, opened
from tests.support.body_signals import body
from tests.support.command import mimics
from tests.support.task_play import make_snapshot

SECOND = 1_000_000_000


def write_csv(path: Path, times: Any, **columns: Any) -> Path:
    rows = np.column_stack([times, *columns.values()])
    head = ",".join(["t_s", *columns])
    np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.6f")
    return path


def test_a_table_is_read_on_its_grid_with_holes_where_rows_are_missing(tmp_path: Path) -> None:
    times = np.arange(1000) / 360.0
    keep = np.ones(1000, bool)
    keep[400:420] = False
    (signal,) = read_signal_file(write_csv(tmp_path / "a.csv", times[keep], ECG=np.sin(times[keep])))
    assert (signal.name, signal.rate, len(signal.values)) == ("ecg", 360.0, 1000)
    assert np.isnan(signal.values[400:420]).all()
    assert np.isfinite(np.delete(signal.values, np.arange(400, 420))).all()
    np.testing.assert_allclose(signal.values[keep], np.sin(times[keep]), atol=1e-6)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("t_s,height\n0,1\n1,2\n", 'none of its columns is a body signal: "t_s", "height"'),
        ("ecg\n1\n2\n", "holds the time"),
        ("t_s,ecg\n0,1\n1,2\n0.5,3\n", "backwards"),
        ("t_s,ecg\n0,1\n", "fewer than two rows"),
        ("t_s,ecg\n0,1\n1,many\n", "is not a number"),
        ("t_s,ecg\n0,1\n1e-9,2\n2e-9,2\n100,3\n", "1e-09 s apart over 100 s"),
        ("t_s,ecg\n0,1\n1e-300,2\n2e-300,2\n1,3\n", "1e-300 s apart"),
    ],
)
def test_a_table_that_is_wrong_says_how(text: str, what: str, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(SceneError, match=what):
        read_signal_file(path)


def test_a_column_that_is_there_twice_counts_once(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t_s,ecg,ECG\n0,1,9\n1,2,9\n3,3,9\n")
    (signal,) = read_signal_file(path)
    np.testing.assert_array_equal(signal.values, [1.0, 2.0, 3.0])


def test_edf_is_read_by_its_library(tmp_path: Path) -> None:
    path, wave = tmp_path / "a.edf", np.sin(np.arange(2000) / 30.0)
    edfio.Edf([edfio.EdfSignal(wave, 200, label="ECG II", physical_range=(-2, 2))]).write(path)
    (signal,) = read_signal_file(path)
    assert (signal.name, signal.rate) == ("ecg", 200.0)
    np.testing.assert_allclose(signal.values, wave, atol=1e-3)


def test_edf_in_microvolts_is_read_in_millivolts(tmp_path: Path) -> None:
    path, wave = tmp_path / "a.edf", 900.0 * np.sin(np.arange(2000) / 30.0)
    options = {"physical_dimension": "uV", "physical_range": (-1000, 1000)}
    edfio.Edf([edfio.EdfSignal(wave, 1000, label=label, **options) for label in ("EMG biceps", "Resp")]).write(path)
    emg, breath = read_signal_file(path)
    np.testing.assert_allclose(emg.values, 1e-3 * wave, atol=1e-4)
    np.testing.assert_allclose(breath.values, wave, atol=0.1)  # breath has no unit of its own


def _edf(path: Path) -> bytes:
    edfio.Edf([edfio.EdfSignal(np.sin(np.arange(2000) / 30.0), 200, label="ECG")]).write(path)
    return path.read_bytes()


@pytest.mark.parametrize(
    ("at", "text", "what"),
    [
        (192, b"EDF+D", "gaps between its records"),
        (244, b"0       ", "cannot be read"),  # duration of a record
        (244, b"-1      ", "cannot be read"),
        (244, b"soon    ", "cannot be read"),
        (236, b"99999999", "cannot be read"),  # number of records
        (252, b"9999", "cannot be read"),  # number of signals
        (184, b"2       ", "cannot be read"),  # length of the header
        (0, b"\xff" * 256, "cannot be read"),
    ],
)
def test_a_damaged_edf_is_refused_in_one_line(at: int, text: bytes, what: str, tmp_path: Path) -> None:
    path = tmp_path / "a.edf"
    whole = _edf(path)
    path.write_bytes(whole[:at] + text + whole[at + len(text) :])
    with pytest.raises(SceneError, match=what):
        read_signal_file(path)


@pytest.mark.parametrize("length", [0, 100, 256, 511, 600, 4000])
def test_a_cut_off_edf_is_refused(length: int, tmp_path: Path) -> None:
    path = tmp_path / "a.edf"
    path.write_bytes(_edf(path)[:length])
    with pytest.raises(SceneError, match="cannot be read"):
        read_signal_file(path)


@pytest.mark.parametrize(
    ("name", "unit", "factor"),
    [
        ("ecg", "mV", 1.0),
        ("ecg", " \u00b5V ", 1e-3),
        ("emg", "microvolts", 1e-3),
        ("emg", "V", 1e3),
        ("gsr", "uS", 1.0),
        ("gsr", "\u03bcS", 1.0),
        ("gsr", "nS", 1e-3),
        ("gsr", "siemens", 1e6),
        ("gsr", "kOhm", 1.0),
        ("ecg", "", 1.0),
        ("resp", "V", 1.0),
    ],
)
def test_units_of_voltage_and_conductance_are_converted(name: str, unit: str, factor: float) -> None:
    assert unit_factor(name, unit) == pytest.approx(factor, rel=1e-12)


def test_a_file_comes_at_the_pace_of_the_session(tmp_path: Path) -> None:
    times = np.arange(2000) / 1000.0
    source = FileSource(read_signal_file(write_csv(tmp_path / "a.csv", times, ecg=times)))
    source.read(5 * SECOND)
    taken = [block for i in range(1, 200) for block in source.read(5 * SECOND + i * SECOND // 60)]
    np.testing.assert_allclose(np.concatenate([block.values for block in taken]), times, atol=1e-6)
    for block in taken:
        assert block.t_ns == pytest.approx(5 * SECOND + block.values[0] * SECOND, abs=1e4)


def test_a_gap_is_not_filled_and_what_comes_twice_is_dropped() -> None:
    grid, values = Grid("ecg", 1000.0), np.arange(100.0)
    taken = [grid.take(0, values), grid.take(100_000_000, values)]
    taken.append(grid.take(500_000_000, values))  # 300 samples were lost
    taken.append(grid.take(500_000_000, values))  # the same again
    whole = np.concatenate([block.values for block in taken if block is not None])
    assert (grid.faults.gaps, grid.faults.lost) == (1, 300)
    assert (grid.faults.repeats, grid.faults.dropped) == (1, 100)
    assert np.isnan(whole[200:500]).all()
    np.testing.assert_array_equal(whole[500:], values)


def test_of_a_block_that_comes_half_again_the_new_half_is_kept() -> None:
    grid, values = Grid("ecg", 1000.0), np.arange(150.0)
    blocks = [grid.take(0, values[:100]), grid.take(50_000_000, values[50:])]
    np.testing.assert_array_equal(np.concatenate([block.values for block in blocks if block is not None]), values)
    assert (grid.faults.repeats, grid.faults.dropped) == (1, 50)


@pytest.mark.parametrize("hours", [1, -1])
def test_a_source_whose_clock_is_set_goes_on(hours: int) -> None:
    grid = Grid("ecg", 1000.0)
    blocks = [grid.take(hour * 3600 * SECOND + i * SECOND // 10, np.ones(100)) for hour in (0, hours) for i in range(9)]
    assert all(block is not None and len(block.values) == 100 for block in blocks)


@pytest.mark.parametrize("ppm", [100.0, -100.0])
def test_a_clock_that_drifts_is_followed_and_reported(ppm: float) -> None:
    grid = Grid("ecg", 1000.0)
    for i in range(60_00):
        grid.take(round(i * 10_000_000 * (1.0 - 1e-6 * ppm)), np.zeros(10))
    assert (grid.faults.gaps, grid.faults.repeats) == (0, 0)
    assert grid.faults.drift_ppm == pytest.approx(ppm, rel=0.2)


def test_a_stream_at_another_rate_than_it_says_is_reported() -> None:
    grid = Grid("ecg", 1000.0)
    for i in range(5000):
        grid.take(i * 10_000_000, np.zeros(9))
    assert grid.faults.wrong_rate


def test_a_long_loss_is_no_other_rate() -> None:
    grid = Grid("ecg", 1000.0)
    for i in range(6000):
        grid.take((10 * i + (5000 if i > 1000 else 0) + (90_000 if i > 2000 else 0)) * 1_000_000, np.zeros(10))
    assert (grid.faults.gaps, grid.faults.lost) == (2, 5000)
    assert not grid.faults.wrong_rate


def test_a_slow_signal_that_is_less_than_half_a_sample_late_has_no_gap() -> None:
    grid = Grid("gsr", 8.0)
    for i in range(40):
        grid.take(i * 125_000_000 + (50_000_000 if i > 5 else 0), np.zeros(1))
    assert (grid.faults.gaps, grid.faults.repeats) == (0, 0)


def until(source: Any, wanted: int, give_up_s: float = 20.0) -> list[Any]:
    """Blocks of the first signal until so many samples came."""
    blocks: list[Any] = []
    end = time.monotonic() + give_up_s
    while sum(len(block.values) for block in blocks) < wanted and time.monotonic() < end:
        blocks += [block for block in source.read(time.monotonic_ns()) if block.name == "ecg"]
        time.sleep(0.005)
    return blocks


@pytest.mark.parametrize("binary", [False, True])
def test_an_amplifier_at_a_line(binary: bool) -> None:
    wave = np.column_stack([np.arange(400.0), np.full(400, 5.0)])
    emulator = AmplifierEmulator(["ECG1", "eda"], 1000.0, binary=binary)
    source = opened(emulator)
    emulator.send(wave[:100])
    emulator.babble(b"\x01\xa5\x5a\xffnoise" + (b"" if binary else b"\n"))
    emulator.skip(150)
    emulator.send(wave[250:])
    values = np.concatenate([block.values for block in until(source, 400)])
    np.testing.assert_allclose(values[:100], wave[:100, 0])
    assert np.isnan(values[100:250]).all()
    np.testing.assert_allclose(values[250:], wave[250:, 0])
    assert (source.faults["ecg"].gaps, source.faults["ecg"].lost) == (1, 150)
    assert source.damaged > 0
    source.close()
    emulator.unplug()


def test_an_amplifier_that_counts_from_the_beginning_again_is_heard() -> None:
    emulator = AmplifierEmulator(["ecg"], 100.0, binary=True)
    emulator.skip(100_000)
    source = opened(emulator)
    emulator.send(np.ones((50, 1)))
    until(source, 50)
    emulator.skip(-emulator._number)
    emulator.send(np.full((200, 1), 2.0))  # faster than it measures: some overlap what was there
    values = np.concatenate([block.values for block in until(source, 100)])
    np.testing.assert_array_equal(values[np.isfinite(values)][:100], np.full(100, 2.0))
    source.close()
    emulator.unplug()


def test_a_count_or_a_header_that_lost_bytes_changes_nothing() -> None:
    emulator = AmplifierEmulator(["ecg", "eda"], 100.0, binary=False)
    source = opened(emulator)
    emulator.send(np.ones((50, 2)))
    emulator.babble(b"3000000000,9,9\n# rate=10 channels=ecg\n7\n")
    emulator.send(np.ones((50, 2)))
    values = np.concatenate([block.values for block in until(source, 100)])
    np.testing.assert_array_equal(values, np.ones(100))
    assert source.faults["ecg"].gaps == source.faults["ecg"].repeats == 0
    assert not source.lost
    source.close()
    emulator.unplug()


def test_an_amplifier_that_states_other_channels_ends_and_says_so() -> None:
    emulator = AmplifierEmulator(["ecg", "eda"], 100.0, binary=False)
    source = opened(emulator)
    emulator.send(np.ones((50, 2)))
    until(source, 50)
    emulator.babble(b"# rate=100 channels=ecg\n# rate=100 channels=ecg\n7,1\n")
    end = time.monotonic() + 20.0
    while not source.lost and time.monotonic() < end:
        assert source.read(time.monotonic_ns()) == ()
        time.sleep(0.005)
    assert "other channels" in source.lost
    source.close()
    emulator.unplug()


def test_an_amplifier_that_is_unplugged_ends_and_says_so() -> None:
    emulator = AmplifierEmulator(["ecg"], 500.0, binary=True)
    source = opened(emulator)
    emulator.send(np.zeros((50, 1)))
    until(source, 50)
    emulator.unplug()
    end = time.monotonic() + 20.0
    while not source.lost and time.monotonic() < end:
        source.read(time.monotonic_ns())
        time.sleep(0.005)
    assert source.lost
    assert source.read(time.monotonic_ns()) == ()
    source.close()


def test_a_port_without_an_amplifier_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DeviceError, match="cannot be opened"):
        SerialAmplifier(str(tmp_path / "nothing"))


def test_every_damaged_byte_of_a_frame_is_noticed() -> None:
    frame = binary_samples(7, np.arange(6.0).reshape(3, 2))
    for place in range(len(frame)):
        reader = AmplifierReader()
        reader.feed(binary_header(100.0, ("ecg", "gsr")))
        broken = bytearray(frame)
        broken[place] ^= 0x10
        found = reader.feed(bytes(broken) + frame)
        assert [samples.number for samples in found] in ([7], []), place
        for samples in found:
            np.testing.assert_array_equal(samples.values, np.arange(6.0).reshape(3, 2))


def test_a_stream_of_lsl() -> None:
    import pylsl

    from mimics_app.inputs.physio.lsl import LslSource

    name = f"mimics test {time.monotonic_ns()}"
    info = pylsl.StreamInfo(name, "ExG", 2, 1000.0, "float32", name)
    channels = info.desc().append_child("channels")
    for label, unit in (("ECG", "microvolts"), ("EDA", "uS")):
        channels.append_child("channel").append_child_value("label", label).append_child_value("unit", unit)
    outlet = pylsl.StreamOutlet(info)
    source = LslSource(name)
    source.read(time.monotonic_ns())  # opens the stream
    outlet.wait_for_consumers(10.0)
    end = time.monotonic() + 20.0
    blocks: list[Any] = []
    sent = 0
    while sum(np.isfinite(block.values).sum() for block in blocks) < 400 and time.monotonic() < end:
        outlet.push_chunk([[1e3 * i, 5.0] for i in range(sent, sent + 20)])
        sent += 20
        time.sleep(0.02)
        blocks += [block for block in source.read(time.monotonic_ns()) if block.name == "ecg"]
    values = np.concatenate([block.values for block in blocks])
    assert {block.rate for block in blocks} == {1000.0}
    good = values[np.isfinite(values)]
    assert len(good) >= 400
    assert (np.diff(good) > 0.0).all()
    np.testing.assert_allclose(good, np.round(good), atol=1e-6)  # millivolts
    assert good[-1] < sent
    assert source.clock_offset_s == pytest.approx(0.0, abs=1e-3), "one computer has one clock"
    journal = MagicMock()
    SignalWatch((GuardedSource(source, "the stream"),), journal, print).check(7)
    journal.journal.assert_called_once_with(
        "clock_offset", {"t_ns": 7, "signal_source": 0, "offset_s": source.clock_offset_s}
    )
    assert source.lost == ""
    while source.read(time.monotonic_ns()):
        pass
    source.read(time.monotonic_ns() + 3 * SECOND)
    assert source.lost == f'the LSL stream "{name}" is silent'
    outlet.push_chunk([[0.0, 5.0]] * 20)
    while source.lost and time.monotonic() < end:
        source.read(time.monotonic_ns())
    assert source.lost == "", "and is back"
    source.close()


def test_a_stream_that_is_not_there_is_reported() -> None:
    said: list[str] = []
    with pytest.raises(DeviceError, match="no LSL stream"):
        find_source("lsl:nobody sends this", said.append)
    assert said == ['waiting up to 3 s for the LSL stream "nobody sends this"']


@pytest.mark.parametrize("address", ["", "sims", "sim:nobody", "file", "lsl:"])
def test_an_address_that_names_nothing_is_refused(address: str) -> None:
    with pytest.raises(UsageError):
        open_source(address, 1)


def test_a_simulated_body_is_the_same_for_the_same_seed_whatever_the_frames() -> None:
    one, other = SimulatedBody("severe", 4), SimulatedBody("severe", 4)
    a = [block for i in range(61) for block in one.read(i * SECOND // 20) if block.name == "ecg"]
    b = [block for i in range(7) for block in other.read(i * SECOND // 2) if block.name == "ecg"]
    np.testing.assert_array_equal(
        np.concatenate([block.values for block in a]), np.concatenate([block.values for block in b])
    )


def test_the_movement_is_a_signal() -> None:
    movement = Movement()
    assert movement.read(0) == ()
    movement.take_experience(Experience(0, speed=0.2, power=0.5))
    speed, power = movement.read(16_000_000)
    assert (speed.name, speed.values.tolist(), power.name, power.values.tolist()) == ("speed", [0.2], "power", [0.5])


def test_legs_on_a_treadmill_have_the_speed_of_the_belt_and_the_power_of_their_joints() -> None:
    """Two frames, 0.1 s apart: 20 N m that bend by 0.5 rad/s, and 4 N m that yield to 1 rad/s."""
    walk = {"gait_state": 1, "v_world": np.ones(3), "f_user_world": np.ones(3)}
    before = make_snapshot(0, q=np.zeros(4), torque_meas=np.zeros(4), **walk)
    torques, q = np.array([20.0, -4.0, 0.0, 5.0]), np.array([0.05, 0.1, 0.3, 0.0])
    now = make_snapshot(SECOND // 10, q=q, torque_meas=torques, belt_travel=0.04, **walk)
    seen = experience_of(TaskOrders(), before, now, None, SECOND // 10)
    assert (seen.speed, seen.power) == pytest.approx((0.4, 6.0))
    movement = Movement()
    movement.take_experience(seen)
    assert [block.name for block in movement.read(0)] == ["speed", "leg_power"]


@pytest.mark.parametrize("turn", [0.02, 2.5])
def test_a_turning_head_becomes_features_and_a_lost_one_is_not_still(turn: float) -> None:
    """Constant angular speed about a tilted axis, then three seconds without tracking."""
    movement, dsp, frames = Movement(), PhysioDsp(), []
    for frame in range(780):
        t_ns, pose = round(frame * SECOND / 60), np.eye(4)
        pose[:3, :3] = rotation_from_vector(turn * frame / 60 * np.array([0.36, 0.48, 0.8]))
        movement.take_experience(Experience(t_ns, head=pose if frame < 600 else None))
        frames.append(dsp.process(movement.read(t_ns), t_ns))
    tracked, lost = frames[599], frames[-1]
    assert tracked.values["head_speed"] == pytest.approx(turn, rel=1e-6)
    assert ("head_evenness" in tracked.values) == (turn > 0.05), "a head at rest has no smoothness"
    assert tracked.quality["head"] > 0.9
    assert lost.quality["head"] == 0.0
    assert not any(name.startswith("head") for name in lost.values)
    assert "hand_speed" in lost.values
    assert all(np.isfinite(value) for frame in frames for value in frame.values.values())


def test_the_command_writes_events_a_page_and_features(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    signals, truth = body(30)
    path = write_csv(tmp_path / "a.csv", 100.0 + np.arange(30_000) / 1000.0, **signals)
    files = [tmp_path / name for name in ("events.csv", "page.html", "features.csv")]
    words = ["--events", str(files[0]), "--page", str(files[1]), "--features", str(files[2])]
    assert main(["physio", str(path), *words]) == 0
    lines = files[0].read_text().splitlines()
    assert lines[0] == "t_s,known_s,kind,value,quality"
    rows = [line.split(",") for line in lines[1:]]
    found = np.array([float(row[0]) for row in rows if row[2] == "r_peak"])
    beats = 100.0 + np.array([t for t in truth.beats if t < 29.7])
    assert np.abs(found[: len(beats)] - beats).max() < 0.02
    assert all(float(row[1]) >= float(row[0]) for row in rows)
    assert files[1].read_text().count("<svg") > 4
    assert "heart_rate" in files[2].read_text().splitlines()[0]


@pytest.mark.parametrize("seconds", [4.0, 2.5])
def test_the_command_reads_as_many_seconds_as_it_is_asked_for(
    seconds: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_csv(tmp_path / "a.csv", np.arange(9000) / 1000.0, ecg=body(9)[0]["ecg"])
    for source in (str(path), "sim:moderate"):
        assert main(["physio", source, "--seconds", str(seconds), "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["signals"]["ecg"]["seconds"] == seconds


def test_the_command_reads_a_file_to_its_last_sample(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_csv(tmp_path / "a.csv", np.arange(1234) / 360.0, ecg=np.sin(np.arange(1234) / 9.0))
    assert main(["physio", str(path), "--json"]) == 0
    ecg = json.loads(capsys.readouterr().out)["signals"]["ecg"]
    assert round(ecg["seconds"] * ecg["rate"]) == 1234


def test_the_check_finds_a_loose_electrode(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["physio", "sim:moderate", "--check"]) == 0
    assert main(["physio", "sim:loose", "--check", "--seconds", "120"]) == 6
    assert "check its electrodes" in capsys.readouterr().out


def test_a_source_of_an_installed_package_is_watched_as_a_live_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[tuple[str, int]] = []

    def open_box(rest: str, seed: int) -> SimulatedBody:
        opened.append((rest, seed))
        return SimulatedBody("healthy", seed)

    point = SimpleNamespace(name="mybox", value="mybox:open_box", load=lambda: open_box)
    monkeypatch.setattr(PluginGroup, "points", lambda group: [point] if group is sources.PLUGINS else [])
    assert main(["physio", "mybox:left", "--seconds", "0.2", "--seed", "3", "--json"]) == 0
    assert opened == [("left", 3)]
    assert set(json.loads(capsys.readouterr().out)["signals"]) == {"ecg", "gsr", "emg", "resp"}


class _Box(SimulatedBody):
    """A source of a package that delivers for three reads."""

    reads = 0

    def read(self, now_ns: int) -> Any:
        self.reads += 1
        if self.reads > 3:
            raise OSError("no answer")
        return (7,) if self.seed == 7 else super().read(now_ns)


def _box(preset: str, seed: int) -> Any:
    if preset == "none":
        return object()
    if preset == "torn":
        raise ValueError("no port")
    box = _Box(preset, seed)
    box.seed = seed
    return box


@pytest.fixture
def box(monkeypatch: pytest.MonkeyPatch) -> None:
    point = SimpleNamespace(name="mybox", value="mybox:open_box", load=lambda: _box)
    monkeypatch.setattr(PluginGroup, "points", lambda group: [point] if group is sources.PLUGINS else [])


@pytest.mark.parametrize(
    ("address", "why"),
    [
        ("mybox:torn", r"raised ValueError: no port \(test_signal_sources.py, line"),
        (
            "mybox:none",
            "made an object of the type object, which lacks lost, read, take_experience, close; see "
            "mimics_app.contracts.ports",
        ),
    ],
)
def test_a_source_of_a_package_that_cannot_be_opened_says_why(box: None, address: str, why: str) -> None:
    with pytest.raises(DeviceError, match=why):
        open_source(address, 1)


@pytest.mark.parametrize(
    ("seed", "why"), [(1, r"its plug-in raised OSError: no answer \(test_signal"), (7, "returned something other than")]
)
def test_a_source_of_a_package_that_fails_is_lost_and_ends_nothing(box: None, seed: int, why: str) -> None:
    source = open_source("mybox:healthy", seed)
    for frame in range(6):
        source.read(frame * 16_666_667)
        source.take_experience(Experience(frame * 16_666_667, speed=0.1, power=0.2, demand=0.5, acting=True))
    assert source.lost and re.search(why, source.lost)
    assert source.read(10**9) == ()
    source.close()


def test_a_misspelt_source_is_told_from_a_missing_file(box: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["physio", "mybx:3"]) == 2
    assert 'did you mean "mybox"' in capsys.readouterr().err
    assert main(["physio", "nothing.csv"]) == 3


def test_features_have_a_row_for_each_second_from_the_first_sample() -> None:
    watch = Watch()
    for frame in range(200):
        now_ns = 71_362_118_267_435 + frame * 20_000_000
        watch.take((SignalBlock("gsr", 50.0, now_ns, np.full(1, 5.0)),), now_ns + 20_000_000)
    assert [int(row["t_s"]) for row in watch.features] == [0, 1, 2, 3]


def test_a_check_says_why_a_source_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """An amplifier that is unplugged is no matter of electrodes alone."""

    class Unplugged:
        lost = "the amplifier is gone: Input/output error"

        def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
            return (SignalBlock("ecg", 250.0, now_ns, np.zeros(5)),)

        def close(self) -> None:
            """Nothing is open."""

    monkeypatch.setattr("mimics_app.inputs.physio.sources.open_source", lambda *_: Unplugged())
    done = mimics("physio", "serial:nowhere", "--seconds", "0.1", "--check", "--json")
    assert done.returncode == 6
    assert json.loads(done.stdout)["advice"][0].startswith(Unplugged.lost)
    assert f"body signals are lost: {Unplugged.lost}" in done.stderr


def test_a_check_says_one_gap_of_one_and_nothing_of_none(monkeypatch: pytest.MonkeyPatch) -> None:
    class Halting:
        lost = ""
        faults: ClassVar[dict[str, Faults]] = {"ecg": Faults(gaps=1, lost=115, clock_sets=1, dropped=1)}

        def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
            return (SignalBlock("ecg", 250.0, now_ns, np.zeros(5)),)

        def close(self) -> None:
            """Nothing is open."""

    monkeypatch.setattr("mimics_app.inputs.physio.sources.open_source", lambda *_: Halting())
    said = mimics("physio", "serial:nowhere", "--seconds", "0.1", "--check").stdout
    assert "115 samples lost in 1 gap:" in said and "clock was set 1 time:" in said and "1 sample left out" in said
    assert "found  nothing" in said and "last   nothing" in said
