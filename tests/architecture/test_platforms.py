"""Linux is tier 1; elsewhere the package at least imports, with what only Linux has, and every driver, taken away."""

from __future__ import annotations

import subprocess
import sys

from tests.architecture.sources import PACKAGE, ROOT, modules

LINUX_ONLY = (
    "SCHED_BATCH SCHED_FIFO SCHED_IDLE SCHED_OTHER eventfd fdatasync fork geteuid getpgid getuid killpg memfd_create "
    "mkfifo nice openpty posix_fallocate sched_getaffinity sched_param sched_setaffinity sched_setscheduler sendfile "
    "setpriority"
).split()
DRIVERS = "fcntl glfw grp moderngl openal pty pwd resource serial termios".split()

_SCRIPT = """
import importlib, multiprocessing.connection, multiprocessing.reduction, os, subprocess, sys, tempfile
import numba, numpy   # these bring their own answers for other systems: they are not what is tested

for name in LINUX_ONLY:
    if hasattr(os, name):
        delattr(os, name)

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in DRIVERS:
            raise ModuleNotFoundError(f"{name} was taken away", name=name)
        return None

for name in DRIVERS:
    sys.modules.pop(name, None)
sys.meta_path.insert(0, Absent())
for name in NAMES:
    try:
        importlib.import_module(name)
    except Exception as error:
        print(f"{name}: {type(error).__name__}: {error}")
"""


def _import_all(names: list[str]) -> str:
    """What could not be imported, one line each."""
    script = f"LINUX_ONLY = {LINUX_ONLY!r}\nDRIVERS = {DRIVERS!r}\nNAMES = {names!r}\n{_SCRIPT}"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_every_module_imports_without_linux_and_without_drivers() -> None:
    """Window, GL, sound and serial libraries, schedulers and memfd are looked for when they are used, not before."""
    paths = [path.removesuffix("/__init__.py").removesuffix(".py") for path in modules()]
    files = [path if path.startswith("assets/") else f"{PACKAGE.name}/{path}" for path in paths]
    names = [file.replace("/", ".") for file in files if not file.endswith(("/__init__", "/__main__"))]
    failed = _import_all(names)
    assert not failed, failed


def test_the_absence_is_real() -> None:
    """The test above can fail."""
    assert "taken away" in _import_all(["moderngl"])
    assert _import_all(["json"]) == ""
