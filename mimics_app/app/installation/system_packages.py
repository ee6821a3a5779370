"""Requirements on the operating system, checked by the loader and PATH instead of a package manager.

The same table serves `mimics doctor` and, as a script of `.ci/dev.sh` before anything is installed, the set-up:

    python3 system_packages.py run      prints the apt packages missing for `make run`, one line, empty when complete

It imports only the standard library.
"""

from __future__ import annotations

import ctypes
import shutil
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from glob import glob

__all__ = ["NEEDS", "SystemNeed", "apt_line", "missing"]

_FOLDERS = ("/usr/lib/*/dri", "/usr/lib/dri", "/usr/lib64/dri", "/usr/lib/*", "/usr/lib64", "/usr/share/*")


@dataclass(frozen=True, slots=True)
class SystemNeed:
    """One library, file or program from a package of the operating system.

    Attributes:
        package: Name of the package in Debian and Ubuntu.
        purpose: Function that fails without it.
        kind: "run" (needed to run), "optional" (used where the distribution has it), "test" (needed by `make test`) or
            "test-optional" (tests are skipped without it; no package of a desktop is removed for it).
        libraries: Names for the loader; one of them is enough.
        files: File patterns in `_FOLDERS`, for parts without a loadable name; one of them is enough.
        program: Name of a program on PATH.
    """

    package: str
    purpose: str
    kind: str = "run"
    libraries: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    program: str = ""

    def found(self) -> str:
        """Return the library, file or program found, or "" where it is missing."""
        return self._library() or self._file() or (shutil.which(self.program) or "" if self.program else "")

    def _library(self) -> str:
        for name in self.libraries:
            try:
                ctypes.CDLL(name)
            except OSError:
                continue
            return name
        return ""

    def _file(self) -> str:
        patterns = [f"{folder}/{name}" for name in self.files for folder in _FOLDERS]
        return next((found for pattern in patterns for found in sorted(glob(pattern))), "")


NEEDS: tuple[SystemNeed, ...] = (
    SystemNeed("libegl1", "pictures without a display (EGL)", libraries=("libEGL.so.1",)),
    SystemNeed("libgl1", "OpenGL itself; EGL needs it too", libraries=("libGL.so.1",)),
    SystemNeed(
        "libgl1-mesa-dri",
        "the software renderer",
        files=("swrast_dri.so", "libgallium-*.so", "libgallium*.so", "libdril_dri.so"),
    ),
    SystemNeed("libopenal1", "sound", libraries=("libopenal.so.1",)),
    SystemNeed("libx11-6", "a window under X11", libraries=("libX11.so.6",)),
    SystemNeed("libxrandr2", "a window under X11 (screens)", libraries=("libXrandr.so.2",)),
    SystemNeed("libxinerama1", "a window under X11 (screens)", libraries=("libXinerama.so.1",)),
    SystemNeed("libxcursor1", "a window under X11 (pointer)", libraries=("libXcursor.so.1",)),
    SystemNeed("libxi6", "a window under X11 (pointer)", libraries=("libXi.so.6",)),
    SystemNeed(
        "libosmesa6", "pictures without EGL (OSMesa)", kind="optional", libraries=("libOSMesa.so.8", "libOSMesa.so.6")
    ),
    SystemNeed("xvfb", "tests with a real window", kind="test", program="Xvfb"),
    SystemNeed("xauth", "tests with a real window", kind="test", program="xauth"),
    SystemNeed("xdotool", "tests that move the pointer", kind="test", program="xdotool"),
    SystemNeed("pulseaudio", "tests that listen to a live sound server", kind="test-optional", program="pulseaudio"),
    SystemNeed("pulseaudio-utils", "tests that listen to a live sound server", kind="test-optional", program="parec"),
    SystemNeed(
        "libmysofa1",
        "tests against a measured head (MIT KEMAR, in SOFA)",
        kind="test-optional",
        files=("MIT_KEMAR_normal_pinna.sofa",),
    ),
    SystemNeed("chromium", "tests that use the operator's page", kind="test-optional", program="chromium"),
    SystemNeed("debootstrap", "bare systems for make fresh", kind="test-optional", program="debootstrap"),
    SystemNeed(
        "desktop-file-utils",
        "the test of the menu entry",
        kind="test-optional",
        program="desktop-file-validate",
    ),
    SystemNeed("gcc", "tests with an OpenXR runtime of their own", kind="test-optional", program="cc"),
    SystemNeed("libc6-dev", "tests with an OpenXR runtime of their own", kind="test-optional", files=("crt1.o",)),
)
"""All requirements in the order of the report."""


def missing(kinds: Iterable[str]) -> list[SystemNeed]:
    """Return the requirements of these kinds that were not found."""
    wanted = set(kinds)
    return [need for need in NEEDS if need.kind in wanted and not need.found()]


def apt_line(needs: Iterable[SystemNeed]) -> str:
    """Return the command line that installs these packages."""
    return "sudo apt-get install -y " + " ".join(need.package for need in needs)


if __name__ == "__main__":
    sys.stdout.write(" ".join(need.package for need in missing(sys.argv[1:])) + "\n")
