"""Delay of the next frame: it is prepared just before a software driver has drawn the one before."""

from __future__ import annotations

import pytest

from mimics_app.app.picture.start_delay import StartDelay

MS = 1_000_000


def play(delay: StartDelay, drawing_ms: float, preparing_ms: float, frames: int) -> None:
    """Draw frames that a driver takes some time for; each next one begins after the delay."""
    for _ in range(frames):
        begun = delay.ns / MS
        if drawing_ms <= begun:
            delay.note_drawn(round(drawing_ms * MS))
            continue
        prepared = begun + preparing_ms
        delay.note_prepared(round(preparing_ms * MS))
        delay.note_drawn(round(max(drawing_ms, prepared) * MS), latest=prepared >= drawing_ms)


@pytest.mark.parametrize(("drawing_ms", "preparing_ms"), [(12.0, 2.5), (5.0, 4.0), (30.0, 1.0)])
def test_a_frame_is_prepared_shortly_before_it_can_be_drawn(drawing_ms, preparing_ms):
    delay = StartDelay()
    play(delay, drawing_ms, preparing_ms, 30)
    assert delay.ns / MS == pytest.approx(drawing_ms - preparing_ms - 0.7, abs=0.2)


def test_a_driver_that_is_done_early_is_not_given_any_time():
    delay = StartDelay()
    play(delay, 2.0, 3.0, 30)
    assert delay.ns == 0


def test_the_delay_follows_a_driver_that_takes_less_and_more():
    delay = StartDelay()
    play(delay, 20.0, 2.0, 30)
    play(delay, 6.0, 2.0, 40)
    assert delay.ns / MS == pytest.approx(3.3, abs=0.5)
    play(delay, 12.0, 2.0, 40)
    assert delay.ns / MS == pytest.approx(9.3, abs=0.5)
