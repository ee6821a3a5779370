"""When the pictures of a headless run are kept."""

from __future__ import annotations

import errno
from pathlib import Path
from types import SimpleNamespace

import pytest

from mimics_app.app.play.album import Album
from mimics_app.app.play.play import play
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.arrays import U1
from mimics_app.contracts.errors import PartialDataError
from mimics_app.contracts.messages.trial_state import TaskView, TrialState
from mimics_app.rendering.visual.surfaces import headless


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
        album.update(SimpleNamespace(number=number, orders=SimpleNamespace(view=view)))
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


@pytest.mark.seconds
def test_a_last_picture_that_cannot_be_written_costs_only_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    real, written = headless.write_png, []

    def fill(pixels: U1, file: Path) -> None:
        if written:
            raise OSError(errno.ENOSPC, "No space left on device", str(file))
        real(pixels, file)
        written.append(file)

    monkeypatch.setattr(headless, "write_png", fill)
    settings = RunSettings(
        Path("wavy_tunnel"), seconds=0.5, runs=tmp_path, headless=True, sound="off", pictures=2, size=(64, 36)
    )
    assert play(settings, as_json=False) == PartialDataError.exit_code
    said = capsys.readouterr()
    lost = [line for line in said.err.splitlines() if "No space left" in line]
    assert len(lost) == 1
    assert lost[0].endswith("the recording is complete without it")
    assert "broken off" not in said.err
    assert f"picture   {written[0]}" in said.out
    assert (written[0].parents[1] / "report.html").exists()
