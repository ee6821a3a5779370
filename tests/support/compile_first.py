"""Machine code that modules compile when they are imported, made on every processor before tests are collected.

Each worker of pytest imports every test module: with an empty cache all of them would compile all of it, at one time.
"""

from __future__ import annotations

import os
import re
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from importlib import import_module
from multiprocessing import get_context
from pathlib import Path

import pytest

from mimics_app.contracts.kernel_cache import sources_reached

__all__ = ["compile_first", "modules_to_import"]

ROOT = Path(__file__).resolve().parents[2]
OBJECTS = ROOT / "mimics_app" / "rendering" / "haptic" / "simulate.py"
TICK = OBJECTS.with_name("loop_tick.py")
_COMPILES = re.compile(r"^(?:@|\w.* = )typed_kernel\(", re.MULTILINE)


def modules_to_import() -> list[str]:
    """Names of the modules with a kernel of a fixed signature: the two largest parts, then what waits for neither.

    What imports the largest part comes last, when that has been compiled by another process.
    """
    files = [file for folder in ("mimics_app", "tests") for file in (ROOT / folder).rglob("*.py")]
    found = [file for file in sorted(files) if _COMPILES.search(file.read_text(encoding="utf-8"))]
    found.sort(key=lambda file: (file != OBJECTS, file != TICK, OBJECTS in sources_reached(file), file))
    return [".".join(file.relative_to(ROOT).with_suffix("").parts) for file in found]


def compile_first() -> None:
    """Import them all, in as many processes as there are processors; what cannot be imported is pytest's to tell."""
    with ProcessPoolExecutor(os.cpu_count() or 1, mp_context=get_context("spawn")) as pool:
        for _ in pool.map(_import, modules_to_import()):
            pass


def _import(name: str) -> None:
    with suppress(Exception, pytest.skip.Exception):
        import_module(name)
