"""Probes of this machine, each in a process of its own, so that a crashing driver ends only its probe.

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

__all__ = ["probe"]

_PATIENCE_S = 60.0
"""Time-out of a probe [s]."""


def probe(name: str) -> dict[str, Any]:
    """Run one probe of `_PROBES` in a child process.

    Returns:
        The result with `ok`; where the probe failed, crashed or timed out also `error`, one line.
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


def _probe_graphics(backend: str) -> dict[str, Any]:
    """Return version, renderer and vendor of the OpenGL context of a backend ("window", "egl", "osmesa").

    Raises:
        DeviceError: It creates no context.
    """
    from mimics_app.rendering.visual.surfaces.contexts import create_surface

    surface = create_surface(backend, (64, 64), vsync=False)
    try:
        info = surface.ctx.info
        return {"version": info["GL_VERSION"], "renderer": info["GL_RENDERER"], "vendor": info["GL_VENDOR"]}
    finally:
        surface.close()


def _probe_sound() -> dict[str, Any]:
    """Return the OpenAL library, and the sound output that it opens ("" for none).

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


def _probe_scheduler() -> dict[str, Any]:
    """Return the scheduling that the operating system grants to the 1 kHz loop for this user."""
    from mimics_app.rendering.haptic.scheduler import arrange_thread

    recipe = arrange_thread("auto").recipe
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return {"recipe": recipe, "fifo": recipe.startswith("fifo"), "cores": cores}


def _probe_headset() -> dict[str, Any]:
    """Check that an OpenXR runtime is available.

    Raises:
        DeviceError: It is not; with the reason.
    """
    from mimics_app.contracts.errors import DeviceError
    from mimics_app.rendering.visual.displays.openxr_runtime import no_runtime

    why = no_runtime()
    if why:
        raise DeviceError(why)
    return {"runtime": "OpenXR"}


def _probe_attached() -> dict[str, Any]:
    """Return monitors and gamepads; it needs a display server."""
    from mimics_app.rendering.visual.drawing.attached import list_attached

    displays, gamepads = list_attached()
    return {"displays": [asdict(display) for display in displays], "gamepads": gamepads}


_PROBES: Mapping[str, Callable[[], dict[str, Any]]] = {
    "window": lambda: _probe_graphics("window"),
    "egl": lambda: _probe_graphics("egl"),
    "osmesa": lambda: _probe_graphics("osmesa"),
    "sound": _probe_sound,
    "scheduler": _probe_scheduler,
    "attached": _probe_attached,
    "headset": _probe_headset,
}
"""The probes by name."""


def _answer(name: str) -> dict[str, Any]:
    try:
        return {"ok": True, **_PROBES[name]()}
    except MimicsError as error:
        return {"ok": False, "error": str(error).splitlines()[0]}
    except Exception as error:  # noqa: BLE001  any error of a driver is the result
        return {"ok": False, "error": f"{type(error).__name__}: {error}"}


if __name__ == "__main__":
    sys.stdout.write(json.dumps(_answer(sys.argv[1])) + "\n")
