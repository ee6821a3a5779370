"""What a random search finds is kept: tried first the next time, and shown in a line that brings it back."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

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


def search(folder: Path, *profile: str, red: bool = True) -> str:
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *profile, "."]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == int(red), done.stdout + done.stderr
    return done.stdout


def tried(folder: Path) -> list[int]:
    """The numbers of the last search, in order."""
    numbers = [int(line) for line in (folder / "tried").read_text().split()]
    (folder / "tried").unlink()
    return numbers


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "conftest.py").write_text((ROOT / "tests" / "conftest.py").read_text(encoding="utf-8"))
    return tmp_path


@pytest.mark.seconds
@pytest.mark.parametrize("profile", ["random", "nightly"])
def test_failure_of_a_random_search_is_kept_tried_first_and_reported_by_the_daily_one_too(
    folder: Path, profile: str
) -> None:
    (folder / "test_property.py").write_text(_PROPERTY)
    assert "@reproduce_failure" in search(folder, f"--hypothesis-profile={profile}")
    kept = sorted(file for file in (folder / "properties" / "found").rglob("*") if file.is_file())
    assert kept, "the folder that the docstring names"
    tried(folder)
    for daily in ((f"--hypothesis-profile={profile}",), ()):
        search(folder, *daily)
        assert tried(folder)[0] == 4711, "the smallest failure, found again before anything else"
    assert sorted(file for file in (folder / "properties" / "found").rglob("*") if file.is_file()) == kept


@pytest.mark.seconds
def test_the_daily_search_draws_the_same_and_a_random_one_does_not(folder: Path) -> None:
    (folder / "test_property.py").write_text(_PROPERTY.replace("number < 4711", "True"))
    for profile, same in (("same", True), ("random", False)):
        draws = []
        for _ in range(2):
            search(folder, f"--hypothesis-profile={profile}", red=False)
            draws.append(tried(folder))
        assert (draws[0] == draws[1]) is same, profile
    search(folder, red=False)
    assert not (folder / "properties").exists(), "what passes leaves nothing behind"
