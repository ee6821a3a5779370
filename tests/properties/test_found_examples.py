"""What a random search finds is kept: tried first the next time, and told in a line that brings it back."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

_PROPERTY = """
from hypothesis import given, settings, strategies as st

TRIED = []

@settings(max_examples=300, deadline=None)
@given(st.integers(0, 10_000))
def test_small(number):
    with open("tried", "a") as file:
        file.write(f"{number}\\n")
    assert number < 4711
"""


def search(folder: Path) -> str:
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--hypothesis-profile=random", "."]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1, done.stdout + done.stderr
    return done.stdout


def test_failure_of_the_random_search_is_kept_tried_first_and_told(tmp_path):
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text(encoding="utf-8"))
    (tmp_path / "test_property.py").write_text(_PROPERTY)
    assert "@reproduce_failure" in search(tmp_path)
    kept = [file for file in (tmp_path / "properties" / "found").rglob("*") if file.is_file()]
    assert kept, "the folder that the docstring names"
    (tmp_path / "tried").unlink()
    search(tmp_path)
    first = int((tmp_path / "tried").read_text().split()[0])
    assert first == 4711, "the smallest failure, found again before anything else"
