"""A real OpenXR loader with the test runtime below it: compiled once, scripted by each test."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

SOURCES = Path(__file__).parent / "openxr_runtime"
EPOCH_NS = 7_000_000_000_000
"""The runtime's time minus the monotonic clock's [ns]."""


@cache
def runtime_library() -> Path:
    """The compiled runtime; it stays loaded when the loader lets go of it, and with it what a script is at."""
    library = Path(mkdtemp(prefix="mimics_xr_")) / "libmimics_xr.so"
    flags = ["-shared", "-fPIC", "-O1", "-fvisibility=hidden", "-Wl,-z,nodelete"]
    sources = [str(SOURCES / name) for name in ("runtime.c", "frames.c")]
    subprocess.run(["cc", *flags, "-o", str(library), *sources, "-ldl", "-lm"], check=True)
    return library


def why_not() -> str:
    """Why the test runtime cannot be had here, "" where it can."""
    return "" if shutil.which("cc") else "no C compiler (cc) to build the test runtime with"


@dataclass(frozen=True)
class Headset:
    """One script of the runtime.

    Attributes:
        environment: What a process needs to find it.
    """

    folder: Path
    environment: dict[str, str]

    @property
    def log(self) -> list[str]:
        """What was called, a line each."""
        return (self.folder / "log").read_text().splitlines()

    def calls(self, name: str) -> list[str]:
        return [line for line in self.log if line.split()[0] == name]

    def errors(self) -> list[str]:
        """Calls that the runtime refused."""
        return [line for line in self.log if line.startswith("xr") and int(line.split()[1]) < 0]

    def frames(self, size: tuple[int, int]) -> list[np.ndarray]:
        """Both eyes as they arrived, a picture each frame: RGBA uint8 [height, width, 4], row 0 at the top."""
        files = sorted((self.folder / "dump").glob("*.rgba"))
        return [np.frombuffer(file.read_bytes(), np.uint8).reshape(size[1], size[0], 4)[::-1] for file in files]


def make_headset(folder: Path, *script: str) -> Headset:
    """Write a script; `Headset.environment` makes it the active runtime of a process."""
    (folder / "dump").mkdir(parents=True)
    manifest = {"file_format_version": "1.0.0", "runtime": {"library_path": str(runtime_library())}}
    (folder / "runtime.json").write_text(json.dumps(manifest))
    (folder / "script").write_text("\n".join([f"log {folder / 'log'}", f"dump {folder / 'dump'}", *script, ""]))
    (folder / "log").write_text("")
    return Headset(
        folder, {"XR_RUNTIME_JSON": str(folder / "runtime.json"), "MIMICS_XR_SCRIPT": str(folder / "script")}
    )


def in_environment(headset: Headset) -> dict[str, str]:
    return {**os.environ, **headset.environment}
