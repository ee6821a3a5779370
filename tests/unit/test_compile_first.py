"""What is made before pytest's workers start is what they would make themselves."""

from __future__ import annotations

from importlib.util import module_from_spec
from pathlib import Path

import pytest
from _pytest.assertion import rewrite

from tests.support.compile_first import rewrite_assertions


def test_pytest_finds_the_assertions_rewritten(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "test_planted.py").write_text("def planted(x):\n    assert abs(x) == 3\n")
    rewrite_assertions([tmp_path])
    monkeypatch.setattr(rewrite, "_rewrite_test", None)
    hook = request.config.pluginmanager.rewrite_hook
    assert isinstance(hook, rewrite.AssertionRewritingHook)
    spec = hook.find_spec("test_planted", [str(tmp_path)])
    assert spec is not None
    module = module_from_spec(spec)
    hook.exec_module(module)
    with pytest.raises(AssertionError, match=r"where 2 = abs\(-2\)"):
        module.planted(-2)
