"""Kinds of task, built in and of a package, by one conformance kit."""

from __future__ import annotations

import itertools
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import msgspec
import pytest

from mimics_app.contracts.messages.orders import HapticField
from mimics_app.contracts.system.resources import root
from mimics_app.tasks.kinds.carry import kind as carry
from mimics_app.tasks.kinds.registry import task_kinds
from tests.support.plugin_site import build_wheel
from tests.support.task_kind_kit import check_task_kind

SCENES = root() / "scenes"
TURN = itertools.count(1)
DAMPING = HapticField("virtual_damping")


def _scene_of(name: str) -> Path:
    """The shipped scene whose task names the kind; the tunnel needs no name."""
    named = (file for file in sorted(SCENES.glob("*.json")) if name in json.loads(file.read_text()).get("task", {}))
    return next(named, SCENES / "wavy_tunnel.json")


@pytest.mark.parametrize("kind", [kind.name for kind in task_kinds()])
def test_every_kind_keeps_the_contract(kind: str) -> None:
    check_task_kind(kind, _scene_of(kind))


def test_a_kind_of_a_package_keeps_it(tmp_path: Path) -> None:
    """The example's wheel, in a process whose structs are made with it; the lines of its page are run there, too."""
    example = root() / "examples" / "task_kind_plugin"
    path = os.pathsep.join((str(build_wheel(example, tmp_path)), str(root())))
    (lines,) = re.findall(r"```python\n(.*?)```", (example / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    code = (
        "import sys; from pathlib import Path; from tests.support.task_kind_kit import check_task_kind;"
        f"check_task_kind('reach', Path(sys.argv[1]))\n{lines}\nassert session.task['reached'] == 3"
    )
    command = [sys.executable, "-c", code, str(example / "reach.json")]
    environment = {**os.environ, "PYTHONPATH": path}
    done = subprocess.run(
        command, cwd=root(), env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_package_among_the_built_in_kinds_is_one(tmp_path: Path) -> None:
    """The example's module, put where the built-in kinds are: nothing else names it."""
    example = root() / "examples" / "task_kind_plugin"
    package = tmp_path / "reach"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "kind.py").write_text((example / "reach_targets.py").read_text())
    code = (
        "import sys; from pathlib import Path; from mimics_app.tasks import kinds; kinds.__path__.append(sys.argv[1]);"
        "from tests.support.task_kind_kit import check_task_kind; check_task_kind('reach', Path(sys.argv[2]))"
    )
    command = [sys.executable, "-c", code, str(tmp_path), str(example / "reach.json")]
    done = subprocess.run(command, cwd=root(), capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


def _measures(**values: Any) -> property:
    return property(lambda play: values)


@pytest.mark.parametrize(
    ("owner", "name", "value", "words"),
    [
        ("kind", "name", "car ry", "key of the task block"),
        ("kind", "measures", carry.KIND.measures * 2, "names of its own"),
        ("kind", "cards", ("time",), "no card of every task"),
        ("play", "measures", _measures(undeclared=1.0), "what it has declared"),
        ("play", "measures", _measures(**{carry.KIND.measures[0].column: float("nan")}), "finite, or None"),
        ("play", "cards", lambda play, seen, finished: {"unknown": None}, "cards that it has declared"),
        ("play", "orders", property(lambda play: {DAMPING: float(next(TURN))}), "does not change by asking"),
    ],
)
def test_a_fault_is_found(monkeypatch: pytest.MonkeyPatch, owner: str, name: str, value: Any, words: str) -> None:
    target = type(carry.KIND) if owner == "kind" else carry._CarryPlay
    called = "carry" if name != "name" else value
    monkeypatch.setattr(target, name, value)
    with pytest.raises(AssertionError, match=words):
        check_task_kind(called, SCENES / "pick_and_place.json", 1.0)


def test_a_journal_line_without_a_name_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    (kind,) = (each for each in task_kinds() if each.name == "avatar_cord")
    assert kind.journals
    monkeypatch.setattr(type(kind), "journals", ())
    with pytest.raises(AssertionError, match="a replay compares"):
        check_task_kind("avatar_cord", _scene_of("avatar_cord"))


def test_a_measure_needs_a_sentence_and_two_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    first = carry.KIND.measures[0]
    flat = msgspec.structs.replace(first.default, worst=first.default.best)
    for change, words in (({"what": "force"}, "in a sentence"), ({"default": flat}, "are different values")):
        fields = {name: getattr(first, name) for name in first.__slots__}
        monkeypatch.setattr(type(carry.KIND), "measures", (type(first)(**{**fields, **change}),))
        with pytest.raises(AssertionError, match=words):
            check_task_kind("carry", SCENES / "pick_and_place.json", 1.0)
