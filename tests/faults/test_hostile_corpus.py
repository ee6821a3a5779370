"""Every reader and every wire is attacked: each takes or refuses it soon and in little memory, and obeys nothing."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.support.hostile_readers import ATTACKS, READERS, WIRES

ROOT = Path(__file__).parents[2]
MOST_MB, MOST_S = 512, 2.0
FEWEST = 150


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What each reader did, in a process of its own whose memory and deeds are watched."""
    folder = tmp_path_factory.mktemp("attacked")
    command = [sys.executable, "-m", "tests.support.hostile_readers", str(folder)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return dict(json.loads(done.stdout))


def test_the_corpus_has_every_reader_and_every_wire(found: dict[str, Any]) -> None:
    assert len(READERS) >= 20 and len(WIRES) >= 12 and len(found["attacks"]) >= FEWEST
    taken = {name for name in (*READERS, *WIRES) if found["attacks"][f"{name}: as it is"]["ended"] == "read"}
    assert {*READERS, *WIRES} - taken <= {"C3D", "EDF"}, "attacks begin with what is taken"
    assert len(ATTACKS) * (len(READERS) + len(WIRES)) <= len(found["attacks"])


def test_each_is_read_or_refused_by_an_error_of_its_own(found: dict[str, Any]) -> None:
    wrong = {name: each["ended"] for name, each in found["attacks"].items() if each["ended"].startswith("raised")}
    assert wrong == {}


def test_each_is_over_soon_and_in_little_memory(found: dict[str, Any]) -> None:
    slow = {name: each["seconds"] for name, each in found["attacks"].items() if each["seconds"] > MOST_S}
    assert slow == {} and 0 < found["peak_mb"] <= MOST_MB


@pytest.mark.requirement("R33")
@pytest.mark.fault(id="F13")
def test_nothing_is_obeyed_opened_elsewhere_or_sent(found: dict[str, Any]) -> None:
    seen = {name: each["seen"] for name, each in found["attacks"].items() if each["seen"]}
    assert seen == {} and found["left"] == []
