"""When the pictures of a headless run are kept."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from mimics_app.app.play.album import Album
from mimics_app.contracts.trial_state import TaskView, TrialState


def kept(views: list[TaskView], wanted: int, seconds: float | None = None) -> list[int]:
    """Frames of which pictures are kept, of as many as there are views."""
    settings = SimpleNamespace(pictures=wanted, seconds=seconds, video=None)
    album = Album(SimpleNamespace(folder=Path("run"), settings=settings))
    numbers = []

    def draw(frames, *, keep: bool) -> None:
        numbers.append(frames.number)
        album._kept += keep

    album._draw = draw
    for number, view in enumerate(views):
        album.look(SimpleNamespace(number=number, orders=SimpleNamespace(view=view)))
    return numbers


def session(first: int = 1, last: int = 3) -> list[TaskView]:
    """Frames of trials of 100 frames each, with a rest of 20 before each, of three."""
    views = []
    for trial in range(first, last + 1):
        views += [TaskView(TrialState.APPROACH, 0.0, trial, 3)] * 20
        views += [TaskView(TrialState.TRAVEL, k / 100, trial, 3) for k in range(100)]
    return views


def test_pictures_are_spread_over_all_trials() -> None:
    assert kept(session(), 6) == [20 + 25, 20 + 75, 140 + 25, 140 + 75, 260 + 25, 260 + 75]


def test_they_are_spread_over_the_trials_that_are_played() -> None:
    assert kept(session(first=3), 2) == [20 + 25, 20 + 75]


@pytest.mark.parametrize(("seconds", "frames"), [(4.0, [60, 180]), (60.0, [20 + 75, 260 + 25])])
def test_of_a_run_of_a_given_length_time_counts_where_it_is_farther(seconds: float, frames: list[int]) -> None:
    assert kept(session(), 2, seconds) == frames
