"""`mimics devices check` and `mimics devices emulate`, and a headless run on a robot with a time of its own."""

from __future__ import annotations

import json
import os
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.app.devices.emulated_trackers import open_tracker, report_on
from mimics_app.app.devices.emulator import EmulatorSettings, open_emulator, serve
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.haptic import DeviceStatus
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.devices.emulators.faults import Faults, apply_order
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.world.components.robot import Robot


def test_check_says_each_finding_and_the_exit_code(capsys):
    assert main(["devices", "check", "pointer", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["passed"] and len(answer["checks"]) >= 25
    assert {one["verdict"] for one in answer["checks"]} == {"passed", "not applicable"}
    assert main(["devices", "check", "pointr"]) == 4
    assert 'did you mean "pointer"' in capsys.readouterr().err
    assert main(["devices", "check"]) == 2
    assert main(["devices", "emulate", "seriel"]) == 2
    assert 'did you mean "serial"' in capsys.readouterr().err


@pytest.fixture
def stdin(monkeypatch: pytest.MonkeyPatch):
    reader, writer = os.pipe()
    with os.fdopen(reader) as stream, os.fdopen(writer, "w", buffering=1) as orders:
        monkeypatch.setattr("sys.stdin", stream)
        yield orders


def test_an_emulator_serves_until_it_is_reported_to_quit_and_takes_orders(stdin, capsys):
    with open_emulator("serial", EmulatorSettings()) as emulator:
        assert Path(emulator.address).is_symlink()
        thread = threading.Thread(target=serve, args=(emulator, None))
        thread.start()
        plugin = build_device(Robot(device=f"serial:{emulator.address}"))
        plugin.close()
        stdin.write("nonsense\ngarbage many\ngarbage 3\ndrop 0.5\ndeaf\nunplug\nquit\n")
        thread.join(60.0)
        assert not thread.is_alive()
        faults = emulator.faults
        assert (faults.garbage, faults.drop, faults.deaf, faults.plugged) == (3, 0.5, True, False)
    assert not Path(emulator.address).exists()
    assert 'no order "nonsense"' in capsys.readouterr().err


def test_the_line_of_an_emulated_robot_is_its_users_alone():
    """Whatever the umask: the folder of the link, and the terminal it leads to."""
    before = os.umask(0)
    try:
        with open_emulator("serial", EmulatorSettings()) as emulator:
            link = Path(emulator.address)
            assert link.parent.stat().st_mode & 0o777 == 0o700
            assert link.resolve().stat().st_mode & 0o777 == 0o600
    finally:
        os.umask(before)


def test_an_emulated_hapticmaster_is_found_at_its_address(stdin):
    with open_emulator("hapticmaster", EmulatorSettings(delay_ms=2)) as emulator:
        thread = threading.Thread(target=serve, args=(emulator, None))
        thread.start()
        build_device(Robot(device=f"hapticmaster:{emulator.address}")).close()
        stdin.write("quit\n")
        thread.join(60.0)
        assert not thread.is_alive()


def test_orders_are_understood_or_refused_with_the_nearest():
    faults = Faults()
    for order in ("silence", "deaf", "garbage 7", "drop 0.1", "unplug"):
        apply_order(faults, order)
    assert faults == Faults(silence=True, garbage=7, drop=0.1, deaf=True, plugged=False)
    for order in ("silence off", "deaf off", "garbage 0", "drop 0", "plug"):
        apply_order(faults, order)
    assert faults == Faults()
    with pytest.raises(UsageError, match='did you mean "unplug"'):
        apply_order(faults, "unplg")
    with pytest.raises(UsageError, match="is not a number"):
        apply_order(faults, "drop half")


def _unplug_after(emulator: Any, commands: int) -> None:
    clock = MonotonicClock()
    while emulator.commands < commands:
        clock.sleep_until_ns(clock.now_ns() + 10_000_000)
    emulator.faults.plugged = False


@pytest.mark.seconds
def test_a_headless_run_on_a_robot_with_a_time_of_its_own_is_live(stdin, tmp_path: Path, capsys):
    """The robot is unplugged under way: the run goes on recording to its end, in a latched stop."""
    quiet = ["--headless", "--pictures", "0", "--sound", "off", "--json", "--runs", str(tmp_path)]
    main(["run", "scenes/wavy_tunnel.json", "--seconds", "0.02", *quiet])  # compiles what would stop the robot's thread
    capsys.readouterr()
    with open_emulator("serial", EmulatorSettings()) as emulator:
        thread = threading.Thread(target=serve, args=(emulator, None))
        thread.start()
        try:
            threading.Thread(target=_unplug_after, args=(emulator, 100), daemon=True).start()
            device = ["--device", f"serial:{emulator.address}", "--seconds", "5"]
            code = main(["run", "scenes/wavy_tunnel.json", *device, *quiet])
        finally:
            stdin.write("quit\n")
            thread.join(60.0)
    printed = capsys.readouterr()
    answer = json.loads(printed.out)
    assert code == 5 and answer["safety"]["state"] == "SAFE_STOP"
    # The emulator shares this process: where that stalls for 20 ms, it stops for stale data before it is unplugged.
    assert answer["safety"]["stops"] == 1 and answer["safety"]["cause"] in ("DEVICE_FAULT", "STALE_DEVICE")
    if answer["safety"]["cause"] == "DEVICE_FAULT":
        assert "safety stop: the device reports a fault, is gone, or takes no command; check" in printed.err
    assert answer["recipe"] != "virtual"
    samples = Run.open(Path(answer["run_dir"])).haptic
    assert np.count_nonzero(samples["status"] == DeviceStatus.FAULT) > 200
    assert np.array_equal(samples["tick"], np.arange(len(samples)))
    assert "is gone: no force" in printed.err
    events = (Path(answer["run_dir"]) / "events.jsonl").read_text(encoding="utf-8")
    assert '"kind":"device"' in events
    assert main(["replay", answer["run_dir"]]) == 0


@pytest.mark.parametrize("kind", ["fastrak", "flock", "vrpn", "osc"])
def test_a_tracker_that_is_emulated_is_heard_by_the_tracker_of_its_kind(kind: str) -> None:
    from mimics_app.inputs.trackers.osc import OscTracker
    from mimics_app.inputs.trackers.serial_tracker import fastrak, flock_of_birds
    from mimics_app.inputs.trackers.vrpn import VrpnTracker

    listener = OscTracker("osc", "0") if kind == "osc" else None
    heard: dict[str, object] = {}
    if listener is not None:
        listener.start(lambda sample: heard.setdefault(sample.sensor, sample))
    try:
        with open_tracker(kind, 3, 0 if listener is None else listener.port) as (address, report):
            if listener is None:
                make = {"fastrak": fastrak, "flock": flock_of_birds}.get(kind)
                listener = VrpnTracker(kind, address) if make is None else make(kind, address, 115200)
                listener.start(lambda sample: heard.setdefault(sample.sensor, sample))
            wanted = 1 if kind == "flock" else 4
            for _ in range(100):
                report_on(report, 0.05)
                if len(heard) == wanted:
                    break
            assert len(heard) == wanted, listener.problem
    finally:
        assert listener is not None
        listener.stop()


def test_the_first_line_of_an_emulated_tracker_is_its_address(capsys) -> None:
    assert main(["devices", "emulate", "vrpn", "--seconds", "0.05"]) == 0
    assert capsys.readouterr().out.startswith("vrpn:person@127.0.0.1:")
    assert main(["devices", "emulate", "fastrek"]) == 2
    assert 'did you mean "fastrak"' in capsys.readouterr().err
