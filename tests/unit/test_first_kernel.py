"""The page "your first kernel": its function compiles, and passes the tests that the page writes for it."""

from __future__ import annotations

import importlib.util
import inspect
from collections.abc import Callable
from pathlib import Path
from types import FunctionType

import pytest

from mimics_app.contracts.system.resources import root
from tests.support.guide import pieces, written_module

PIECES = {piece.purpose: piece for piece in pieces(root() / "docs" / "guide" / "first_kernel.md") if piece.purpose}


@pytest.fixture(scope="module")
def softening_spring(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., float]:
    spring: Callable[..., float] = written_module(tmp_path_factory.mktemp("page"), PIECES["kernel"]).softening_spring
    return spring


def test_the_page_s_tests_pass(softening_spring: Callable[..., float], tmp_path: Path) -> None:
    (tmp_path / "page_tests.py").write_text(PIECES["test"].text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("page_tests", tmp_path / "page_tests.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    tests = [each for name, each in vars(module).items() if name.startswith("test_") and isinstance(each, FunctionType)]
    assert len(tests) == 3
    for test in tests:
        assert list(inspect.signature(test).parameters) == ["softening_spring"]
        test(softening_spring)
