"""`mimics doctor`: report what this machine has and lacks, and the command that installs it."""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import sys
from pathlib import Path
from typing import Any

from mimics_app.app.installation import system_packages
from mimics_app.app.terminal.output import answer, applicable
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.version import __version__

__all__ = ["add_arguments", "examine", "run"]

_GIGABYTE = 1e9
_MEGABYTE = 1e6
_HOUR_S = 3600.0
_FIFO_ADVICE = (
    'for real-time priority: echo "$USER - rtprio 60" | sudo tee /etc/security/limits.d/mimics.conf; log in again'
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--runs",
        type=Path,
        default=Path("runs"),
        metavar="DIR",
        help="folder for run folders: its free space is checked",
    )


def run(args: argparse.Namespace) -> int:
    """Examine the machine; 0 when scenes can run here, 4 when something they need is missing."""
    findings = examine(args.runs)
    answer(args, applicable(findings), _lines(findings))
    return 0 if findings["ready"] else DeviceError.exit_code


def examine(runs: Path) -> dict[str, Any]:
    """Return everything found, as the object of `--json`; None where something does not apply.

    Args:
        runs: Parent of the run folders.
    """
    from mimics_app.app.installation.plugins import list_plugins
    from mimics_app.app.installation.probes import probe

    found = [(need, need.found()) for need in system_packages.NEEDS]
    lacking = [need for need, place in found if not place and _is_linux()]
    graphics = {backend: probe(backend) for backend in ("window", "egl", "osmesa")}
    versions = _versions()
    plugins = list_plugins()
    return {
        "ready": any(answer["ok"] for answer in graphics.values()) and all(versions.values()),
        "versions": versions,
        "machine": _machine(),
        "system": [_system_row(need, place) for need, place in found],
        "missing": [need.package for need in lacking],
        "apt": _apt_line(lacking),
        "gl": graphics,
        "al": probe("sound"),
        "headset": probe("headset"),
        "displays": _displays(),
        "scheduler": probe("scheduler"),
        "kernel_cache": _kernel_cache(),
        "runs": _runs_folder(runs),
        "data": _data_folder(),
        "plugins": [
            {"group": p.group, "name": p.name, "target": p.target, "package": p.package, "error": p.error}
            for p in plugins
        ],
    }


def _is_linux() -> bool:
    return sys.platform.startswith("linux")


def _apt_line(lacking: list[system_packages.SystemNeed]) -> str | None:
    """Return the apt command, without the tests' sound server: apt might remove a desktop's own for it."""
    needs = [need for need in lacking if need.kind != "test-optional"]
    return system_packages.apt_line(needs) if needs else None


def _system_row(need: system_packages.SystemNeed, found: str) -> dict[str, str]:
    return {"package": need.package, "kind": need.kind, "purpose": need.purpose, "found": found}


def _versions() -> dict[str, str]:
    """Return the versions of the packages that a run needs, "" where one is missing; llvmlite is numba's."""
    from importlib.metadata import PackageNotFoundError, requires, version

    lines = [line for line in requires("mimics_app") or () if "extra ==" not in line]
    versions = {"mimics_app": __version__, "python": platform.python_version()}
    for package in (*(re.split(r"[^\w.-]", line)[0] for line in lines), "llvmlite"):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            versions[package] = ""
    return versions


def _machine() -> dict[str, Any]:
    return {
        "system": f"{platform.system()} {platform.release()}",
        "architecture": platform.machine(),
        "cores": os.cpu_count(),
        "display": os.environ.get("WAYLAND_DISPLAY") or os.environ.get("DISPLAY") or "",
    }


def _kernel_cache() -> dict[str, Any]:
    try:
        from mimics_app.compiled.cache_folder import KNOWN_SERIES, cache_folder, is_known_series
        from mimics_app.compiled.kernel_sweep import cache_bytes
    except ImportError as error:
        return {"folder": None, "compiled": 0, "bytes": 0, "fix": str(error)}
    if not is_known_series():
        advice = f"each start compiles again: install numba {KNOWN_SERIES}, whose series this version knows"
        return {"folder": None, "compiled": 0, "bytes": 0, "fix": advice}
    if cache_folder is None:
        advice = "make the home folder writable, or set NUMBA_CACHE_DIR"
        return {"folder": None, "compiled": 0, "bytes": 0, "fix": advice}
    compiled = sum(1 for _ in cache_folder.rglob("*.nbc"))
    return {"folder": cache_folder, "compiled": compiled, "bytes": cache_bytes(cache_folder.parent), "fix": ""}


def _runs_folder(runs: Path) -> dict[str, Any]:
    from mimics_app.recording.run_folder import BYTES_PER_SECOND

    existing = next(folder for folder in (runs.absolute(), *runs.absolute().parents) if folder.exists())
    free = shutil.disk_usage(existing).free / _GIGABYTE
    return {
        "folder": runs.absolute(),
        "writable": os.access(existing, os.W_OK | os.X_OK),
        "free_gb": round(free, 1),
        "gb_an_hour": BYTES_PER_SECOND * _HOUR_S / _GIGABYTE,
    }


def _displays() -> dict[str, Any]:
    """Return the monitors, and the files of walls and headsets in the current folder."""
    from mimics_app.app.installation.display_files import find_display_files
    from mimics_app.app.installation.probes import probe

    attached = probe("attached")
    monitors = [f"{one['name']} {one['size_px'][0]} x {one['size_px'][1]}" for one in attached.get("displays", [])]
    files = [one["write"] for one in find_display_files(Path.cwd())]
    return {"monitors": monitors, "files": files, "error": attached.get("error", "")}


def _displays_text(displays: dict[str, Any]) -> str:
    found = [*displays["monitors"], *(f"--display {file}" for file in displays["files"])]
    return ", ".join(found) if found else displays["error"] or "none"


def _data_folder() -> dict[str, Any]:
    from mimics_app.contracts.errors import MimicsError
    from mimics_app.contracts.system.resources import root

    try:
        return {"folder": root(), "error": ""}
    except MimicsError as error:
        return {"folder": None, "error": str(error)}


def _lines(findings: dict[str, Any]) -> list[str]:
    """Return the findings as lines: "ok" present, "-" missing and optional, "x" missing and required."""
    lines = [f"mimics {__version__} on {findings['machine']['system']}, {findings['machine']['cores']} cores"]
    lines += ["", "Python packages"]
    lines += [_line(bool(version), name, version or "missing") for name, version in findings["versions"].items()]
    lines += ["", "System packages"]
    lines += [_system_line(row) for row in findings["system"]]
    if findings["apt"]:
        lines += ["", "  To install what is missing:", f"  {findings['apt']}"]
    lines += ["", "Picture, sound, real time"]
    for backend, found in findings["gl"].items():
        lines.append(_line(found["ok"], backend, _graphics_text(found), optional=backend != "egl"))
    lines.append(_line(findings["al"]["ok"], "sound", _sound_text(findings["al"]), optional=True))
    headset = findings["headset"]
    lines.append(_line(headset["ok"], "headset", headset.get("error") or headset["runtime"], optional=True))
    displays = findings["displays"]
    some = bool(displays["monitors"] or displays["files"])
    lines.append(_line(some, "displays", _displays_text(displays), optional=True))
    scheduler = findings["scheduler"]
    lines.append(_line(scheduler.get("fifo", False), "scheduler", _scheduler_text(scheduler), optional=True))
    lines += ["", "Folders", *_folder_lines(findings)]
    lines += ["", "Plug-ins", *([_plugin_line(plugin) for plugin in findings["plugins"]] or ["      none installed"])]
    lines += [
        "",
        "Scenes can run here." if findings["ready"] else "Scenes cannot run here yet: see the lines marked x.",
    ]
    return [line.rstrip() for line in lines]


def _line(good: bool, name: str, text: str, *, optional: bool = False) -> str:
    mark = "ok" if good else "-" if optional else "x"
    return f"  {mark:>2}  {name:<16} {text}"


def _system_line(row: dict[str, str]) -> str:
    needed = row["kind"] == "run"
    text = row["found"] or f"missing: {row['purpose']}" + ("" if needed else f" ({row['kind']})")
    return _line(bool(row["found"]), row["package"], text, optional=not needed)


def _plugin_line(plugin: dict[str, str]) -> str:
    return _line(not plugin["error"], plugin["name"], f"{plugin['group']} {plugin['target']} {plugin['error']}")


def _folder_lines(findings: dict[str, Any]) -> list[str]:
    cache, runs, data = findings["kernel_cache"], findings["runs"], findings["data"]
    kernels = f"{cache['compiled']} compiled; {cache['bytes'] / _MEGABYTE:.0f} MB with those of other versions"
    return [
        _line(bool(cache["folder"]), "kernels", f"{cache['folder'] or cache['fix']} ({kernels})"),
        _line(runs["writable"], "runs", _room_text(runs)),
        _line(not data["error"], "data", str(data["folder"] or data["error"])),
    ]


def _room_text(runs: dict[str, Any]) -> str:
    hours, rate = runs["free_gb"] / runs["gb_an_hour"], f"{runs['gb_an_hour']:.1f} GB an hour"
    return f"{runs['folder']} ({runs['free_gb']} GB free; a session takes {rate}: room for {hours:.0f} h)"


def _graphics_text(found: dict[str, Any]) -> str:
    return f"{found['version']}, {found['renderer']}" if found["ok"] else str(found["error"])


def _sound_text(found: dict[str, Any]) -> str:
    if not found["ok"]:
        return str(found["error"])
    output = found["device"] or "no sound output: --sound file writes the sound to a file"
    return f"{found['library']}, HRTF {'on' if found['hrtf'] else 'off'}, {output}"


def _scheduler_text(found: dict[str, Any]) -> str:
    if not found["ok"]:
        return str(found["error"])
    recipe = f"{found['recipe']} on {found['cores']} cores"
    return recipe if found["fifo"] else f"{recipe}; {_FIFO_ADVICE}"
