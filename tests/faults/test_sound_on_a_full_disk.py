"""A disk that takes no more ends the sound with one clear line, gives the recording room, and not the session."""

from __future__ import annotations

import wave
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.shared_memory.session_memory import Capacities, SessionMemory
from mimics_app.rendering.audio.offline import OfflineAudio
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.wav_file import WavWriter
from tests.support.full_disk import largest_file

RATE = 48_000
LIMIT = 3 << 20


def test_wave_file_on_a_full_disk_stays_valid_and_gives_room_back(tmp_path: Path) -> None:
    writer = WavWriter(tmp_path / "a.wav", RATE)
    block = np.full((RATE, 2), 0.25, np.float32)
    with largest_file(LIMIT), pytest.raises(OSError):
        while True:
            writer.append(block)
    assert (tmp_path / "a.wav").stat().st_size <= LIMIT - (1 << 20)
    with wave.open(str(tmp_path / "a.wav")) as file:
        assert file.getnframes() == writer.frames > 0
    writer.close()


def test_session_goes_on_without_sound_when_the_disk_is_full(tmp_path: Path) -> None:
    tick = {"tick": SoundSpec(recipe="tick")}
    settings = AudioSettings(
        sounds=tick, triggers={"contact": "tick"}, scrape="", sink="file", file=tmp_path / "sound.wav"
    )
    audio = OfflineAudio(SessionMemory(Capacities()), settings)
    audio.start()
    with largest_file(LIMIT):
        for second in range(1, 40):
            audio.advance(second * 1_000_000_000)
        report = audio.stop()
    assert audio.ready is not None and "the rest of the sound is dropped" in audio.ready.notice
    assert report.file == str(tmp_path / "sound.wav")
    with wave.open(report.file) as file:
        assert file.getnframes() > RATE
