"""`mimics devices`: list the devices of this machine, check one, or emulate one.

mimics devices                                      robots, displays, gamepads, serial ports, sound
mimics devices check NAME[:ADDRESS]                 the conformance kit; exit 4 when a check fails
mimics devices emulate serial|hapticmaster|lokomat  an emulated robot; the first line printed is its address
mimics devices emulate fastrak|flock|vrpn|osc       an emulated tracker on a simulated person; likewise
"""

from __future__ import annotations

import argparse
import inspect
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.settings import PATIENTS
from mimics_app.app.terminal.arguments import display_forms, positive_time, random_seed, whole_number
from mimics_app.app.terminal.output import answer
from mimics_app.contracts.errors import DeviceError, UsageError

if TYPE_CHECKING:
    from mimics_app.app.installation.plugins import PluginReport

__all__ = ["add_arguments", "find_all", "run"]

_NAMES_FROM = {
    "check": "mimics devices lists them",
    "emulate": "serial, hapticmaster, lokomat, fastrak, flock, vrpn or osc",
}
"""Where the names of devices are found, by action."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `mimics devices`."""
    actions = ("list", "check", "emulate")
    parser.add_argument(
        "action",
        nargs="?",
        choices=actions,
        default="list",
        help="list: what is found here; check: run the conformance kit on a device; emulate: start an emulated device",
    )
    parser.add_argument(
        "device",
        nargs="?",
        default="",
        help="check: NAME[:ADDRESS]; emulate: serial, hapticmaster, lokomat, fastrak, flock, vrpn or osc",
    )
    parser.add_argument("--recording", type=Path, metavar="RUN", help="with check replay: run folder to play back")
    parser.add_argument("--scene", type=Path, help="with emulate: scene whose path and robot the simulated person uses")
    parser.add_argument(
        "--patient",
        choices=PATIENTS,
        default="",
        help="with emulate: impairment of the simulated person",
    )
    parser.add_argument(
        "--seed", type=random_seed, default=1, help="with emulate: seed of the simulated person and sensors"
    )
    parser.add_argument(
        "--port",
        type=whole_number("port", range(65536)),
        default=0,
        help="with emulate: port on which hapticmaster or vrpn listens (0: any), or to which osc sends (0: 9000); "
        "of lokomat: UDP port, instead of a serial line",
    )
    parser.add_argument(
        "--delay",
        type=whole_number("number of milliseconds", range(201)),
        default=0,
        metavar="MS",
        help="with emulate hapticmaster: delay of its answers [ms]",
    )
    parser.add_argument(
        "--seconds", type=positive_time, help="end the emulation after this time [s] (default: at Ctrl-C)"
    )


def run(args: argparse.Namespace) -> int:
    """Do what was requested."""
    if args.action == "list":
        return _list(args)
    if not args.device:
        raise UsageError(f"mimics devices {args.action} needs the name of a device", _NAMES_FROM[args.action])
    return _check(args) if args.action == "check" else _emulate(args)


def _check(args: argparse.Namespace) -> int:
    """Run the conformance kit on one device."""
    from mimics_app.rendering.haptic.devices.device_names import check_device_name

    check_device_name(args.device)
    from mimics_app.app.devices.check import check_by_name

    findings = check_by_name(args.device, args.recording)
    passed = all(one.verdict != "failed" for one in findings)
    rows = [{"check": one.check, "verdict": one.verdict, "what": one.what} for one in findings]
    lines = [f"{one.verdict:14} {one.check}{': ' if one.what else ''}{one.what}" for one in findings]
    answer(args, {"device": args.device, "passed": passed, "checks": rows}, lines)
    return 0 if passed else DeviceError.exit_code


def _emulate(args: argparse.Namespace) -> int:
    """Emulate a robot or a tracker until it is stopped."""
    from mimics_app.app.devices.emulated_trackers import TRACKERS, check_emulated, open_tracker, report_on

    check_emulated(args.device)
    if args.device in TRACKERS:
        with open_tracker(args.device, args.seed, args.port) as (address, report):
            _say_address(args, address)
            report_on(report, args.seconds)
        return 0
    from mimics_app.app.devices.emulator import EmulatorSettings, open_emulator, serve
    from mimics_app.app.terminal.first_start import say_if_cold

    say_if_cold()
    settings = EmulatorSettings(args.scene, args.patient, args.seed, args.port, args.delay)
    with open_emulator(args.device, settings) as emulator:
        _say_address(args, emulator.address)
        serve(emulator, args.seconds)
    return 0


def _say_address(args: argparse.Namespace, at: str) -> None:
    """Print the first line: name and address of the emulated device."""
    address = f"{args.device}:{at}"
    answer(args, {"address": address}, [address])
    sys.stdout.flush()


def _list(args: argparse.Namespace) -> int:
    """Print the devices a scene can run on; a failed query becomes a note."""
    found = find_all()
    answer(args, found, _lines(found))
    return 0


def find_all() -> dict[str, Any]:
    """Return everything found, as the object of `--json`.

    Displays, gamepads and the sound output are queried in processes of their own: their drivers may crash.
    """
    from mimics_app.app.installation.display_files import find_display_files
    from mimics_app.app.installation.probes import probe
    from mimics_app.app.installation.serial_ports import list_serial_ports

    attached, sound, headset = probe("attached"), probe("sound"), probe("headset")
    graphics = {backend: probe(backend) for backend in ("window", "egl", "osmesa")}
    return {
        "devices": [*_built_in(), *_plugged_in()],
        "displays": attached.get("displays", []),
        "display_kinds": _display_kinds(headset),
        "display_files": find_display_files(Path.cwd()),
        "gamepads": attached.get("gamepads", []),
        "graphics": [{"backend": name, "ok": answer["ok"]} for name, answer in graphics.items()],
        "serial_ports": list_serial_ports(),
        "sound": sound.get("device", ""),
        "notes": [
            f"{name}: {found['error']}" for name, found in (("displays", attached), ("sound", sound)) if not found["ok"]
        ],
    }


def _display_kinds(headset: dict[str, Any]) -> list[dict[str, str]]:
    """Return every kind of --display, and why it is missing here."""
    from mimics_app.app.installation.plugins import report_group
    from mimics_app.contracts.ports.display_choice import DISPLAY_KINDS, PLUGINS

    known = {name: (kind.caption, "") for name, kind in DISPLAY_KINDS.items()}
    known["openxr"] = (known["openxr"][0], "" if headset["ok"] else str(headset["error"]))
    known = {plugin.name: (_about(plugin), plugin.error) for plugin in report_group(PLUGINS)} | known
    return [
        {"name": name, "about": known[name][0], "write": written, "error": known[name][1]}
        for name, written in display_forms().items()
    ]


def _built_in() -> Iterator[dict[str, Any]]:
    from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, load_built_in

    for name in BUILT_IN:
        yield {"name": name, "about": load_built_in(name).about, "package": "mimics_app", "error": ""}


def _plugged_in() -> Iterator[dict[str, Any]]:
    from mimics_app.app.installation.plugins import report_group
    from mimics_app.rendering.haptic.devices.device_names import PLUGINS

    for plugin in report_group(PLUGINS):
        yield {"name": plugin.name, "about": _about(plugin), "package": plugin.package, "error": plugin.error}


def _about(plugin: PluginReport) -> str:
    """Return the first line of a plug-in's docstring; its address without one."""
    about = inspect.getdoc(plugin.loaded) or "" if plugin.loaded is not None else ""
    return about.splitlines()[0] if about else plugin.target


def _file_line(one: dict[str, str]) -> str:
    return f"--display {one['write']}" + (f": {one['error']}" if one["error"] else "")


def _lines(found: dict[str, Any]) -> list[str]:
    """Return the findings as lines of text."""
    robots = [_line(one["name"], one) for one in found["devices"]]
    displays = [
        f"{one['name']}: {one['size_px'][0]} x {one['size_px'][1]} at {one['refresh_hz']} Hz"
        + (" (primary)" if one["primary"] else "")
        for one in found["displays"]
    ]
    graphics = [one["backend"] for one in found["graphics"] if one["ok"]]
    return [
        *_section("Robots and simulators (robot.device in a scene)", robots),
        *_section("Monitors", displays),
        *_section("Displays (--display)", [_line(one["write"], one) for one in found["display_kinds"]]),
        *_section("Walls and headsets in this folder", [_file_line(one) for one in found["display_files"]]),
        *_section("Pictures by (--backend)", graphics),
        *_section("Gamepads", found["gamepads"]),
        *_section("Serial ports", [f"{one['port']}: {one['about']} ({one['id']})" for one in found["serial_ports"]]),
        *_section("Sound output", [found["sound"]] if found["sound"] else []),
        *found["notes"],
    ]


def _section(title: str, rows: Sequence[str]) -> list[str]:
    return [title, *(f"  {row}" for row in rows or ["none"]), ""]


def _line(name: str, row: Mapping[str, Any]) -> str:
    return f"{name:<24} {row['about']}" + (f" [{row['error']}]" if row["error"] else "")
