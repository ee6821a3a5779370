"""Sounds too long to be held: read while they play, and heard as they would be if they were held as a whole."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import soundfile

from mimics_app.contracts.clock import MonotonicClock, VirtualClock
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.stage_messages import SoundEvent
from mimics_app.rendering.audio import sound_file
from mimics_app.rendering.audio.bank import STREAM_FRAMES, SoundBank
from mimics_app.rendering.audio.engine import open_mixer
from mimics_app.rendering.audio.long_sounds import LongSounds
from mimics_app.rendering.audio.offline import render_offline
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.sound_file import check_sound_file

RATE = 48_000
SECONDS = 14.0
"""Longer than the ring, which therefore is written more than once."""

needs_a_round = pytest.mark.skipif(SECONDS * RATE < 1.2 * STREAM_FRAMES, reason="the ring is not written twice")


@pytest.fixture
def music(tmp_path: Path) -> Path:
    """Noise of two channels, no second of which is like another."""
    samples = np.random.default_rng(32).uniform(-0.3, 0.3, (round(SECONDS * RATE), 2)).astype(np.float32)
    soundfile.write(tmp_path / "music.wav", samples, RATE, subtype="FLOAT")
    return tmp_path / "music.wav"


def heard(music: Path, mixer: str, *, spatial: bool, loop: bool) -> np.ndarray:
    """The mix of a sound that starts at 0.1 s, for a second longer than it lasts."""
    sounds = {"music": SoundSpec(file=music, spatial=spatial, loop=loop)}
    event = SoundEvent(t_ns=100_000_000, sound="music", position_world=(1.0, 0.0, -1.0), gain=0.5)
    return render_offline([event], sounds, SECONDS + 1.1, mixer=mixer)[0]


@needs_a_round
@pytest.mark.parametrize("mixer", ["openal", "spectral"])
@pytest.mark.parametrize(("spatial", "loop"), [(True, True), (False, False)])
def test_it_is_heard_as_if_it_were_held(music: Path, monkeypatch: pytest.MonkeyPatch, mixer: str, spatial, loop):
    whole = heard(music, mixer, spatial=spatial, loop=loop)
    monkeypatch.setattr(sound_file, "_HELD_S", 1.0)
    assert SoundBank({"music": SoundSpec(file=music)}, RATE).streams
    np.testing.assert_allclose(heard(music, mixer, spatial=spatial, loop=loop), whole, atol=1e-6)
    assert np.abs(whole[round(12.5 * RATE) : round(14.0 * RATE)]).max() > 0.05


class Player:
    """A mixer that plays one long sound, in steps of 10 ms."""

    def __init__(self, file: Path, *, in_step: bool, **fields: object) -> None:
        sounds = {"music": SoundSpec(file=file, spatial=False, **fields)}
        bank, clock = SoundBank(sounds, RATE), VirtualClock() if in_step else MonotonicClock()
        self.mixer = open_mixer(
            AudioSettings(sounds=sounds, triggers={}, scrape=""), bank, clock, latency=0, origin_ns=0
        )
        self.long = LongSounds(self.mixer, bank, clock, in_step=in_step)

    def start(self) -> None:
        self.long.begin("music", self.mixer.start("music", 0, None, 1.0))

    def play(self, seconds: float) -> np.ndarray:
        blocks = []
        for _ in range(round(100 * seconds)):
            self.long.advance()
            blocks.append(self.mixer.render(RATE // 100))
        return np.concatenate(blocks)

    def close(self) -> None:
        self.long.close()
        self.mixer.close()


def test_two_hours_of_it_take_a_few_megabytes(tmp_path: Path):
    """Of the file as of the check; held as a whole it would take 1.4 GB."""
    path = tmp_path / "hours.flac"
    with soundfile.SoundFile(path, "w", 4_000, 1, format="FLAC") as file:
        for _ in range(120):
            file.write(np.zeros(60 * 4_000, np.int16))
    tracemalloc.start()
    try:
        check_sound_file(path, None, whole=False)
        player = Player(path, in_step=True)
        player.start()
        player.play(1.0)
        assert tracemalloc.get_traced_memory()[1] < 48 << 20
        player.close()
    finally:
        tracemalloc.stop()


def test_it_begins_anew_where_it_is_started_again_and_a_thread_that_decodes_keeps_up(
    music: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(sound_file, "_HELD_S", 1.0)
    player = Player(music, in_step=False)
    played = []
    for _ in range(2):
        player.start()
        played.append(player.play(0.5)[RATE // 10 :])
    player.close()
    np.testing.assert_allclose(played[1], played[0], atol=1e-6)
    assert np.abs(played[0]).max() > 0.1


def test_a_damaged_part_ends_it_and_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sound_file, "_HELD_S", 1.0)
    samples = np.full(round(SECONDS * RATE), 0.2, np.float32)
    samples[9 * RATE] = np.nan
    soundfile.write(tmp_path / "bad.wav", samples, RATE, subtype="FLOAT")
    player = Player(tmp_path / "bad.wav", in_step=True)
    player.start()
    assert np.abs(player.play(1.0)[-RATE // 2 :]).min() > 0.1 and not player.long.problem
    assert np.abs(player.play(8.0)[-RATE // 2 :]).max() == 0.0
    assert "bad.wav" in player.long.problem and "not finite" in player.long.problem
    player.close()


def test_one_that_is_cut_off_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sound_file, "_HELD_S", 1.0)
    soundfile.write(tmp_path / "cut.flac", np.zeros(3 * RATE), RATE)
    content = (tmp_path / "cut.flac").read_bytes()
    (tmp_path / "cut.flac").write_bytes(content[: len(content) // 2])
    with pytest.raises(SceneError, match=r"cut\.flac"):
        check_sound_file(tmp_path / "cut.flac", None, whole=False)
