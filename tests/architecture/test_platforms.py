"""Linux is tier 1; elsewhere the package at least imports, with what only Linux has, and every driver, taken away."""

from __future__ import annotations

import subprocess
import sys

from tests.architecture.sources import PACKAGE, ROOT, modules

_TAKE_AWAY = """
import os, sys, types

# What Windows does not have, or macOS does not have. (numba and multiprocessing bring their own answers.)
for name in ("memfd_create", "sched_setscheduler", "sched_getaffinity", "sched_setaffinity", "sched_param", "SCHED_FIFO",
             "SCHED_OTHER", "SCHED_IDLE", "SCHED_BATCH", "getuid", "geteuid", "nice", "setpriority", "fork", "killpg",
             "posix_fallocate", "fdatasync", "mkfifo", "openpty", "getpgid", "eventfd", "sendfile"):
    if hasattr(os, name):
        delattr(os, name)

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ABSENT:
            raise ModuleNotFoundError(f"{name} was taken away by the test", name=name)
        return None

ABSENT = {"moderngl", "glfw", "openal", "serial", "fcntl", "termios", "pty", "resource", "grp", "pwd"}
"""

_IMPORT_ALL = """
import importlib
import multiprocessing.reduction, multiprocessing.connection, tempfile, subprocess, numpy, numba
sys.meta_path.insert(0, Absent())
for name in ABSENT:
    sys.modules.pop(name, None)
failed = []
for name in NAMES:
    try:
        importlib.import_module(name)
    except Exception as error:
        failed.append(f"{name}: {type(error).__name__}: {error}")
print("\\n".join(failed))
"""


def _names() -> list[str]:
    paths = [path.removesuffix("/__init__.py").removesuffix(".py") for path in modules()]
    return [f"{PACKAGE.name}.{path.replace('/', '.')}" for path in paths if path not in {"__init__", "__main__"}]


def _import_all(names: list[str]) -> str:
    # numba and multiprocessing are loaded before anything is taken away: they are not what is tested.
    take_away, absent = _TAKE_AWAY.split("class Absent", 1)
    script = "\n".join(
        [
            "import multiprocessing.reduction, multiprocessing.connection, tempfile, subprocess, numpy, numba",
            take_away + "class Absent" + absent,
            f"NAMES = {names!r}",
            _IMPORT_ALL,
        ]
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_every_module_imports_without_linux_and_without_drivers() -> None:
    """Window, GL, sound and serial libraries, schedulers and memfd are looked for when they are used, not before."""
    assert _import_all(_names()) == ""


def test_the_absence_is_real() -> None:
    """The test above can fail."""
    assert "taken away" in _import_all(["moderngl"])
    assert _import_all(["os"]) == ""
