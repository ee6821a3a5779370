"""Frames of a mirror: whole by themselves, in order, interpolated, whatever is lost, late, doubled or the first."""

from __future__ import annotations

import random

import numpy as np
import pytest

from mimics_app.app.mirror.mirror_buffer import MirrorBuffer
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.messages.mirror_frame import MirrorFrame, SoundNote, read_frame, write_frame

FRAME = 16_666_667
DELAY = 100_000_000
AWAY = 5_000_000_000_000
"""Difference of the clocks of both computers [ns]."""


def frame(number: int, **changes: object) -> MirrorFrame:
    """Node 3 goes along x with 1 m/s and turns around z with 1 rad/s."""
    t_s = number * FRAME / 1e9
    rows, visible = np.array([3], np.uint32), np.ones(1, np.uint8)
    place, turn = np.array([[t_s, 0, 0]], np.float32), np.array([[0, 0, np.sin(t_s / 2), np.cos(t_s / 2)]], np.float32)
    made = {"rows": rows, "translations": place, "rotations": turn, "scales": np.ones((1, 3), np.float32)}
    return MirrorFrame(number, number * FRAME, **{**made, "visible": visible, **changes})  # type: ignore[arg-type]


def test_a_frame_is_read_as_it_was_written_and_half_a_one_is_none() -> None:
    wanted = frame(7, board=Board(message="Go"), state="travel", trial=2, sounds=(SoundNote(1, 5, "goal"),))
    written = write_frame(wanted)
    found = read_frame(written)
    assert (found.number, found.t_ns, found.board.message, found.state) == (7, 7 * FRAME, "Go", "travel")
    assert found.sounds == wanted.sounds
    for name in ("rows", "translations", "rotations", "scales", "visible"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name))
    for end in (0, 10, len(written) // 2, len(written) - 1):
        with pytest.raises(ValueError):
            read_frame(written[:end])
    with pytest.raises(ValueError):
        read_frame(write_frame(frame(1, translations=np.full((1, 3), np.nan, np.float32))))


@pytest.mark.parametrize("seed", range(5))
def test_loss_lateness_and_doubles_do_not_show(seed: int) -> None:
    """A fifth is lost, each of the others is up to 80 ms late, so that many overtake each other."""
    chance, buffer = random.Random(seed), MirrorBuffer(DELAY)
    arrivals = [
        (number * FRAME + chance.randrange(80_000_000), number)
        for number in range(300)
        if chance.random() > 0.2 or number == 0
        for _ in range(chance.choice((1, 1, 2)))
    ]
    first = arrivals[0][0]
    arrivals.sort()
    shown = []
    for now in range(first, 290 * FRAME, FRAME // 2):
        while arrivals and arrivals[0][0] <= now:
            at, number = arrivals.pop(0)
            buffer.put(frame(number), AWAY + at)
        if (found := buffer.at(AWAY + now)) is not None:
            angle = 2 * np.arctan2(found.rotations[0, 2], found.rotations[0, 3])
            shown.append((now / 1e9, float(found.translations[0, 0]), float(angle)))
    times, places, angles = np.array(shown).T
    assert (np.diff(places) > -1e-6).all(), "it never goes back"
    late = times - places
    settled = times > 1.0
    assert np.ptp(late[settled]) < 2.0 * FRAME / 1e9, "it goes on evenly: it waits for two frames at most"
    assert 0.05 < late[settled].mean() < 0.2
    np.testing.assert_allclose(angles, places, atol=1e-3)


def test_who_joins_late_sees_the_whole_scene_and_hears_nothing_of_before() -> None:
    buffer, old = MirrorBuffer(DELAY), SoundNote(4, 0, "kick")
    assert buffer.at(AWAY) is None
    buffer.put(frame(500, sounds=(old,)), AWAY)
    seen = buffer.at(AWAY + DELAY)
    assert seen is not None and seen.rows.tolist() == [3] and buffer.take_sounds(seen) == []
    new = SoundNote(5, 1, "goal")
    for number in (501, 503):  # the one between, too, had it
        buffer.put(frame(number, sounds=(old, new)), AWAY + (number - 500) * FRAME)
    seen = buffer.at(AWAY + 3 * FRAME + DELAY)
    assert seen is not None and buffer.take_sounds(seen) == [new] and buffer.take_sounds(seen) == []


def test_a_row_that_only_one_of_two_frames_has_is_kept() -> None:
    buffer = MirrorBuffer(DELAY)
    two = {"rows": np.array([1, 3], np.uint32), "visible": np.ones(2, np.uint8), "scales": np.ones((2, 3), np.float32)}
    two |= {"translations": np.array([[9, 9, 9], [0, 0, 0]], np.float32)}
    two |= {"rotations": np.array([[0, 0, 0, 1]] * 2, np.float32)}
    buffer.put(frame(0, **two), AWAY)
    buffer.put(frame(1), AWAY + FRAME)
    seen = buffer.at(AWAY + DELAY + FRAME // 2)
    assert seen is not None and seen.rows.tolist() == [1, 3]
    np.testing.assert_allclose(seen.translations, [[9, 9, 9], [FRAME / 2e9, 0, 0]], atol=1e-6)
