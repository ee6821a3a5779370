"""`mimics devices`: robots and simulators, displays, gamepads, serial ports and the sound output of this machine."""

from __future__ import annotations

import argparse
import inspect
import sys
from collections.abc import Iterator, Sequence
from typing import Any

__all__ = ["add_arguments", "find_all", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments: none of its own."""


def run(args: argparse.Namespace) -> int:
    """List what a scene can be run on; what cannot be asked here is said, not failed on."""
    found = find_all()
    if args.json:
        from mimics_app.app.output import write_object

        write_object("devices", found)
    else:
        sys.stdout.write("\n".join(_lines(found)) + "\n")
    return 0


def find_all() -> dict[str, Any]:
    """Everything found, as the object of `--json`.

    Displays, gamepads and the sound output are asked for in processes of their own: their drivers may crash.
    """
    from mimics_app.app.probes import probe

    attached, sound = probe("attached"), probe("sound")
    graphics = {backend: probe(backend) for backend in ("window", "egl", "osmesa")}
    return {
        "devices": [*_built_in(), *_plugged_in()],
        "displays": attached.get("displays", []),
        "gamepads": attached.get("gamepads", []),
        "graphics": [{"backend": name, "ok": answer["ok"]} for name, answer in graphics.items()],
        "serial_ports": _serial_ports(),
        "sound": sound.get("device", ""),
        "notes": [
            f"{name}: {found['error']}" for name, found in (("displays", attached), ("sound", sound)) if not found["ok"]
        ],
    }


def _built_in() -> Iterator[dict[str, Any]]:
    from mimics_app.rendering.haptic.devices.registry import BUILT_IN

    for name, builder in BUILT_IN.items():
        module = inspect.getmodule(builder)
        about = inspect.getdoc(module) or ""
        yield {"name": name, "about": about.splitlines()[0] if about else "", "package": "mimics_app", "error": ""}


def _plugged_in() -> Iterator[dict[str, Any]]:
    from mimics_app.app.plugins import list_plugins

    for plugin in list_plugins("mimics_app.devices"):
        about = inspect.getdoc(plugin.loaded) or "" if plugin.loaded is not None else ""
        yield {
            "name": plugin.name,
            "about": about.splitlines()[0] if about else plugin.target,
            "package": plugin.package,
            "error": plugin.error,
        }


def _serial_ports() -> list[dict[str, str]]:
    from serial.tools import list_ports

    ports = sorted(list_ports.comports(), key=lambda port: str(port.device))
    return [
        {"port": port.device, "about": port.description or "", "id": port.hwid or ""}
        for port in ports
        if port.hwid not in (None, "n/a")  # a board's bare sockets have nothing plugged in
    ]


def _lines(found: dict[str, Any]) -> list[str]:
    """The same for a person."""
    displays = [
        f"{one['name']}: {one['size_px'][0]} x {one['size_px'][1]} at {one['refresh_hz']} Hz"
        + (" (primary)" if one["primary"] else "")
        for one in found["displays"]
    ]
    graphics = [one["backend"] for one in found["graphics"] if one["ok"]]
    return [
        *_section("Robots and simulators (robot.device in a scene)", [_device_line(one) for one in found["devices"]]),
        *_section("Displays", displays),
        *_section("Pictures by (--backend)", graphics),
        *_section("Gamepads", found["gamepads"]),
        *_section("Serial ports", [f"{one['port']}: {one['about']} ({one['id']})" for one in found["serial_ports"]]),
        *_section("Sound output", [found["sound"]] if found["sound"] else []),
        *found["notes"],
    ]


def _section(title: str, rows: Sequence[str]) -> list[str]:
    return [title, *(f"  {row}" for row in rows or ["none"]), ""]


def _device_line(device: dict[str, Any]) -> str:
    line = f"{device['name']:<24} {device['about']}"
    return f"{line} [cannot be loaded: {device['error']}]" if device["error"] else line
