"""What workers of pytest would each make for themselves, made before they start, on every processor.

Each of them imports every test module: with an empty cache all of them would compile all machine code that is made on
import, and rewrite the assertions of every file, at one time.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path

import pytest
from _pytest.assertion import rewrite

from mimics_app.app.commands.warmup import PARTS, compile_beside
from mimics_app.compiled.kernel_sources import sources_reached

__all__ = ["compile_first", "modules_to_import", "rewrite_assertions"]

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
    for _ in compile_beside({**PARTS, "assertions": rewrite_assertions, **tasks}):
        pass


def rewrite_assertions(folder: Path = ROOT / "tests") -> None:
    """Lay pytest's byte code of every test file in `folder`, with its assertions rewritten, where pytest looks for it.

    pytest has no public word for that; what it finds wrong or does not find it makes itself.
    """
    for file in folder.rglob("test_*.py"):
        kept = rewrite.get_cache_dir(file) / f"{file.stem}{rewrite.PYC_TAIL}"
        kept.parent.mkdir(exist_ok=True)
        if rewrite._read_pyc(file, kept) is None:
            source_hash, code = rewrite._rewrite_test(file, None)  # type: ignore[arg-type]
            made = kept.with_suffix(f".{os.getpid()}")
            with made.open("wb") as bytecode:
                rewrite._write_pyc_fp(bytecode, source_hash, code)
            made.replace(kept)


def _import(name: str) -> None:
    """What cannot be imported is pytest's to report."""
    with suppress(Exception, pytest.skip.Exception):
        import_module(name)
