"""What workers of pytest would each make for themselves, made before they start, on every processor.

Each of them imports every test module: with an empty cache all of them would compile all machine code that is made on
import, and rewrite the assertions of every file, at one time.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from _pytest.assertion import rewrite

from mimics_app.app.commands.warmup import PARTS, compile_beside
from mimics_app.compiled.cache_folder import cache_folder
from mimics_app.compiled.kernel_sources import source_key, sources_reached
from tests.support.command import mimics

__all__ = ["compile_first", "modules_to_import", "rewrite_assertions"]

ROOT = Path(__file__).resolve().parents[2]
SUPPORT = ROOT / "tests" / "support"
OBJECTS = ROOT / "mimics_app" / "rendering" / "haptic" / "simulate.py"
_COMPILES = re.compile(r"^(?:@|\w.* = )typed_kernel\(", re.MULTILINE)
_TEXTS = re.compile(r"""("{3}|'{3}).*?\1""", re.DOTALL)
"""Modules that a test writes stand in texts."""


def modules_to_import(folders: Sequence[Path]) -> tuple[list[str], list[str]]:
    """Names of the modules, not compiled yet, with a kernel of a fixed signature that tests in `folders` may import.

    What imports the objects' part stands apart: it comes when another process has compiled that.
    """
    files = {file for folder in (ROOT / "mimics_app", SUPPORT, *folders) for file in folder.rglob("*.py")}
    found = [file for file in sorted(files) if _compiles(file) and not _is_compiled(file)]
    late = [_name(file) for file in found if OBJECTS in sources_reached(file)]
    return [name for name in map(_name, found) if name not in late], late


def _compiles(file: Path) -> bool:
    text = file.read_text(encoding="utf-8")
    return "typed_kernel" in text and _COMPILES.search(_TEXTS.sub("", text)) is not None


def _is_compiled(file: Path) -> bool:
    """Whether machine code of the file as it is was stored."""
    return cache_folder is not None and (cache_folder / f"{_name(file)}-{source_key(file)}").exists()


def _name(file: Path) -> str:
    return ".".join(file.relative_to(ROOT).with_suffix("").parts)


def compile_first(folders: Sequence[Path]) -> None:
    """Compile for the tests in `folders`, in as many processes as there are processors.

    The large parts come first. Two are commands, as their kernels are compiled when they are called.
    """
    early, late = modules_to_import(folders)
    tasks: dict[str, Callable[[], None]] = {}
    if early or late:
        tasks |= {**PARTS, "signals": _find_signals, **{name: partial(_import, name) for name in early}}
        if ROOT / "tests" in folders:
            tasks["session"] = _play
        tasks |= {name: partial(_import, name) for name in late}
    for _ in compile_beside({"assertions": partial(rewrite_assertions, folders), **tasks}):
        pass


def _find_signals() -> None:
    mimics("physio", "sim", "--seconds", 30, "--json")


def _play() -> None:
    with TemporaryDirectory() as folder:
        mimics("run", "wavy_tunnel", "--headless", "--seconds", 2, "--pictures", 3, "--runs", folder)


def rewrite_assertions(folders: Sequence[Path]) -> None:
    """Lay pytest's byte code of every test file in `folders`, with its assertions rewritten, where pytest looks for it.

    pytest has no public word for that; what it finds wrong or does not find it makes itself.
    """
    for file in (file for folder in folders for file in folder.rglob("test_*.py")):
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
