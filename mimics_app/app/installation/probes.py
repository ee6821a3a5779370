"""Probes of this machine, in processes of their own: a crashing driver ends only its probe.

python -m mimics_app.app.installation.probes egl        prints one JSON object
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from mimics_app.contracts.errors import MimicsError

__all__ = ["PROBES", "probe", "probe_attached", "probe_graphics", "probe_headset", "probe_scheduler", "probe_sound"]

_PATIENCE_S = 60.0


def probe(name: str) -> dict[str, Any]:
    """Run one probe of `PROBES` in a child process.

    Returns:
        What it found, with `ok`; where it failed, crashed or hung also `error`, in one line.
    """
    command = [sys.executable, "-m", "mimics_app.app.installation.probes", name]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_PATIENCE_S, check=False)
    except subprocess.TimeoutExpired:
        return {"ok": False, "error": f"no answer within {_PATIENCE_S:.0f} s"}
    try:
        answer = json.loads(done.stdout.splitlines()[-1])
    except (IndexError, json.JSONDecodeError):
        return {"ok": False, "error": _last_words(done)}
    return dict(answer)


def _last_words(done: subprocess.CompletedProcess[str]) -> str:
    if done.returncode < 0:
        return f"the driver crashed (signal {-done.returncode})"
    lines = done.stderr.strip().splitlines()
    return lines[-1] if lines else f"the probe ended with code {done.returncode}"


def probe_graphics(backend: str) -> dict[str, Any]:
    """The OpenGL that a backend ("window", "egl", "osmesa") gives: version, renderer, vendor.

    Raises:
        DeviceError: It gives none.
    """
    from mimics_app.rendering.visual.surfaces.contexts import create_surface

    surface = create_surface(backend, (64, 64), vsync=False)
    try:
        info = surface.ctx.info
        return {"version": info["GL_VERSION"], "renderer": info["GL_RENDERER"], "vendor": info["GL_VENDOR"]}
    finally:
        surface.close()


def probe_sound() -> dict[str, Any]:
    """The OpenAL library found, and the sound output it opens ("" where there is none).

    Raises:
        DeviceError: There is no usable library.
    """
    from mimics_app.contracts.errors import DeviceError
    from mimics_app.rendering.audio.openal_context import OpenALContext
    from mimics_app.rendering.audio.openal_library import load_library
    from mimics_app.rendering.audio.settings import AudioSettings

    settings = AudioSettings()
    library = load_library(settings)
    loopback = OpenALContext(library, settings.rate, True, settings.voices, loopback=True)
    found: dict[str, Any] = {"library": library.path, "hrtf": loopback.hrtf, "device": ""}
    loopback.close()
    try:
        output = OpenALContext(library, settings.rate, True, settings.voices, loopback=False)
    except DeviceError:
        return found
    found["device"] = output.name
    output.close()
    return found


def probe_scheduler() -> dict[str, Any]:
    """Report the scheduling that the kernel grants to the 1 kHz loop for this user."""
    from mimics_app.rendering.haptic.scheduler import arrange_thread

    recipe = arrange_thread("auto").recipe
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return {"recipe": recipe, "fifo": recipe.startswith("fifo"), "cores": cores}


def probe_headset() -> dict[str, Any]:
    """Whether a headset's OpenXR runtime is there.

    Raises:
        DeviceError: There is none; says why.
    """
    from mimics_app.contracts.errors import DeviceError
    from mimics_app.rendering.visual.displays.openxr_runtime import no_runtime

    why = no_runtime()
    if why:
        raise DeviceError(why)
    return {"runtime": "OpenXR"}


def probe_attached() -> dict[str, Any]:
    """Displays and gamepads; needs a display server, so "ok" is false on a bare console."""
    from mimics_app.rendering.visual.drawing.attached import list_attached

    displays, gamepads = list_attached()
    return {"displays": [asdict(display) for display in displays], "gamepads": gamepads}


PROBES: Mapping[str, Callable[[], dict[str, Any]]] = {
    "window": lambda: probe_graphics("window"),
    "egl": lambda: probe_graphics("egl"),
    "osmesa": lambda: probe_graphics("osmesa"),
    "sound": probe_sound,
    "scheduler": probe_scheduler,
    "attached": probe_attached,
    "headset": probe_headset,
}
"""The probes by name."""


def _answer(name: str) -> dict[str, Any]:
    try:
        return {"ok": True, **PROBES[name]()}
    except MimicsError as error:
        return {"ok": False, "error": str(error).splitlines()[0]}
    except Exception as error:  # noqa: BLE001  whatever a driver's binding raises is the finding
        return {"ok": False, "error": f"{type(error).__name__}: {error}"}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(_answer(sys.argv[1])) + "\n")
