"""Machine code that modules compile when they are imported, made on every processor before tests are collected.

Each worker of pytest imports every test module: with an empty cache all of them would compile all of it, at one time.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path

import pytest

from mimics_app.app.commands.warmup import PARTS, compile_beside
from mimics_app.contracts.kernel_sources import sources_reached

__all__ = ["compile_first", "modules_to_import"]

ROOT = Path(__file__).resolve().parents[2]
OBJECTS = ROOT / "mimics_app" / "rendering" / "haptic" / "simulate.py"
_COMPILES = re.compile(r"^(?:@|\w.* = )typed_kernel\(", re.MULTILINE)


def modules_to_import() -> list[str]:
    """Names of the modules with a kernel of a fixed signature.

    What imports the objects' part comes last, when another process has compiled that.
    """
    files = [file for folder in ("mimics_app", "tests") for file in (ROOT / folder).rglob("*.py")]
    found = [file for file in files if _COMPILES.search(file.read_text(encoding="utf-8"))]
    found.sort(key=lambda file: (OBJECTS in sources_reached(file), file))
    return [".".join(file.relative_to(ROOT).with_suffix("").parts) for file in found]


def compile_first() -> None:
    """Compile the large parts, then import them all, in as many processes as there are processors."""
    tasks: dict[str, Callable[[], None]] = {name: partial(_import, name) for name in modules_to_import()}
    for _ in compile_beside({**PARTS, **tasks}):
        pass


def _import(name: str) -> None:
    """What cannot be imported is pytest's to tell."""
    with suppress(Exception, pytest.skip.Exception):
        import_module(name)
