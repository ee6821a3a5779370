"""A private PipeWire server with one null sink, for sound by PulseAudio's protocol."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from mimics_app.rendering.audio.worker import FIFO_PRIORITY

__all__ = ["pipewire_missing", "private_pipewire_server"]

_PROGRAMS = ("pipewire", "wireplumber", "pipewire-pulse")
_WITH_A_BUS = ("dbus-run-session", "--")
"""The session manager does not start without a message bus."""

_PATIENCE_S = 20.0


def pipewire_missing() -> str:
    """Why there is no such server here, "" where there is."""
    missing = [name for name in (*_PROGRAMS, _WITH_A_BUS[0], "pactl", "parec") if shutil.which(name) is None]
    wanted = "pipewire-pulse wireplumber dbus pulseaudio-utils"
    return f"no {' and '.join(missing)}: apt-get install {wanted}" if missing else ""


@contextmanager
def private_pipewire_server(rate: int, positions: Sequence[str]) -> Iterator[dict[str, str]]:
    """Run the server, its session manager and its PulseAudio side; yield the environment variables of its clients.

    Args:
        rate: Frames per second of the sink, and of the server.
        positions: PulseAudio's names of the positions of its channels.
    """
    with (
        tempfile.TemporaryDirectory(prefix="mimics-pipewire-", ignore_cleanup_errors=True) as folder,
        ExitStack() as stack,
    ):
        homes = ("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME", "PIPEWIRE_RUNTIME_DIR")
        own = {**dict.fromkeys(homes, folder), "PULSE_SERVER": f"unix:{folder}/pulse/native"}
        own["PULSE_RUNTIME_PATH"] = f"{folder}/pulse"
        drop_in = Path(folder) / "pipewire" / "pipewire.conf.d" / "rate.conf"
        drop_in.parent.mkdir(parents=True)
        drop_in.write_text(f"context.properties = {{ default.clock.rate = {rate} }}\n")
        for name, awaited in zip(_PROGRAMS, ("pipewire-0", "pipewire-0", "pulse/native"), strict=True):
            command = (*_WITH_A_BUS, name) if name == "wireplumber" else (name,)
            stack.enter_context(_running(command, {**os.environ, **own}))
            _wait_for(Path(folder) / awaited)
        layout = (f"rate={rate}", f"channels={len(positions)}", f"channel_map={','.join(positions)}")
        load = ["pactl", "load-module", "module-null-sink", "sink_name=mimics", *layout]
        subprocess.run(load, env={**os.environ, **own}, check=True, timeout=_PATIENCE_S, stdout=subprocess.DEVNULL)
        yield own


def _may_prefer() -> bool:
    """Whether it may have real-time priority, threads included: it stands for a sound card, which no load delays."""
    if shutil.which("chrt") is None:
        return False
    return subprocess.run(["chrt", "--rr", "1", "true"], check=False, capture_output=True).returncode == 0


@contextmanager
def _running(command: Sequence[str], environment: dict[str, str]) -> Iterator[None]:
    command = ("chrt", "--rr", str(FIFO_PRIORITY + 1), *command) if _may_prefer() else command
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait_for(socket: Path) -> None:
    end = time.monotonic() + _PATIENCE_S
    while not socket.exists():
        assert time.monotonic() < end, f"{socket.name} did not come"
        time.sleep(0.02)
