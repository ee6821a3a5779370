"""What this machine can do, tried in processes of their own: a driver that crashes takes only its probe with it.

python -m mimics_app.app.probes egl        prints one JSON object
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from typing import Any

from mimics_app.contracts.errors import MimicsError

__all__ = ["PROBES", "probe", "probe_graphics", "probe_scheduler", "probe_sound"]

_PATIENCE_S = 60.0
_FIFO_PRIORITY = 50
_PR_SET_TIMERSLACK = 29
_PR_GET_TIMERSLACK = 30
_RLIMIT_NICE_NEUTRAL = 20


def probe(name: str) -> dict[str, Any]:
    """Run one probe of `PROBES` in a child process.

    Returns:
        What it found, with `ok`; where it failed, crashed or hung also `error`, in one line.
    """
    command = [sys.executable, "-m", "mimics_app.app.probes", name]
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
    from mimics_app.rendering.visual.contexts import create_surface

    surface = create_surface(backend, (64, 64), vsync=False)
    try:
        info = surface.ctx.info
        return {"version": info["GL_VERSION"], "renderer": info["GL_RENDERER"], "vendor": info["GL_VENDOR"]}
    finally:
        surface.close()


def probe_sound() -> dict[str, Any]:
    """The OpenAL library found, and the sound output it opens ("" where there is none: sound then goes to a file).

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
    """What the 1 kHz loop may ask of the kernel, and the recipe that follows from it."""
    fifo = _may_use_fifo()
    return {
        "recipe": "fifo" if fifo else "nice",
        "fifo": fifo,
        "negative_nice": _may_raise_priority(),
        "timer_slack_ns": _smallest_timer_slack(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1,
    }


def _may_use_fifo() -> bool:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_FIFO_PRIORITY))
    except (AttributeError, OSError):
        return False
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    return True


def _may_raise_priority() -> bool:
    try:
        import resource

        if os.geteuid() == 0:
            os.nice(-1)
            return True
        return resource.getrlimit(resource.RLIMIT_NICE)[0] > _RLIMIT_NICE_NEUTRAL
    except (ImportError, AttributeError, OSError):
        return False


def _smallest_timer_slack() -> int | None:
    """The timer slack [ns] after asking for 1 ns; None where the system has none."""
    import ctypes

    try:
        prctl = ctypes.CDLL(None, use_errno=True).prctl
    except (AttributeError, OSError, TypeError):
        return None
    if prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0) != 0:
        return None
    return int(prctl(_PR_GET_TIMERSLACK, 0, 0, 0, 0))


PROBES: Mapping[str, Callable[[], dict[str, Any]]] = {
    "window": lambda: probe_graphics("window"),
    "egl": lambda: probe_graphics("egl"),
    "osmesa": lambda: probe_graphics("osmesa"),
    "sound": probe_sound,
    "scheduler": probe_scheduler,
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
