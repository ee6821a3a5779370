"""Wave files: valid after every block, read in every common form, refused with a clear error otherwise."""

from __future__ import annotations

import struct
import wave

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.audio.sound_file import read_sound
from mimics_app.rendering.audio.wav_file import WavWriter, soften_peaks

RATE = 48_000


def tone(seconds: float = 0.1, rate: int = RATE, frequency: float = 440.0) -> np.ndarray:
    return 0.5 * np.sin(2 * np.pi * frequency * np.arange(int(seconds * rate)) / rate)


def wav_bytes(kind: int, bits: int, channels: int, data: bytes, rate: int = RATE, extensible: bool = False) -> bytes:
    width = channels * bits // 8
    layout = struct.pack("<HHIIHH", 0xFFFE if extensible else kind, channels, rate, rate * width, width, bits)
    if extensible:
        layout += struct.pack("<HHIH", 22, bits, 0, kind) + b"\0\0\0\0\x10\0\x80\0\0\xaa\0\x38\x9b\x71"
    chunks = b"LIST" + struct.pack("<I", 3) + b"abc\0" + b"fmt " + struct.pack("<I", len(layout)) + layout
    chunks += b"data" + struct.pack("<I", len(data)) + data
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


def test_file_is_valid_after_every_block(tmp_path):
    writer = WavWriter(tmp_path / "a.wav", RATE)
    for blocks in range(1, 4):
        writer.append(np.full((240, 2), 0.25, np.float32))
        with wave.open(str(tmp_path / "a.wav")) as file:
            assert file.getnframes() == 240 * blocks
            assert np.all(np.frombuffer(file.readframes(9999), "<i2") == round(0.25 * 32767))
    writer.close()
    writer.close()


def test_a_block_behind_the_end_is_skipped(tmp_path):
    writer = WavWriter(tmp_path / "a.wav", RATE)
    writer.append(np.full((240, 2), 0.25, np.float32))
    writer.close()
    with (tmp_path / "a.wav").open("ab") as file:
        file.write(b"\x01" * 333)  # as after a kill between the samples and the header
    assert len(read_sound(tmp_path / "a.wav", RATE)) == 240


def test_peaks_are_bent_not_cut_and_counted():
    quiet = np.linspace(-0.85, 0.85, 101, dtype=np.float32).reshape(-1, 1)
    assert soften_peaks(quiet)[1] == 0
    np.testing.assert_array_equal(soften_peaks(quiet)[0], quiet)
    loud = np.linspace(0.86, 3.0, 50, dtype=np.float32).reshape(-1, 1)
    soft, count = soften_peaks(loud)
    assert count == 50
    assert np.all(np.diff(soft[:, 0]) >= 0.0)
    assert np.abs(soft).max() <= 1.0


@pytest.mark.parametrize("extensible", [False, True])
@pytest.mark.parametrize(("kind", "bits"), [(1, 8), (1, 16), (1, 24), (1, 32), (3, 32), (3, 64)])
def test_common_forms_are_read(tmp_path, kind, bits, extensible):
    mono = tone()
    both = np.repeat(mono, 2)
    if kind == 3:
        data = both.astype(f"<f{bits // 8}").tobytes()
    elif bits == 8:
        data = (np.rint(both * 127) + 128).astype(np.uint8).tobytes()
    else:
        whole = np.rint(both * (2 ** (bits - 1) - 1)).astype("<i4")
        data = b"".join(int(v).to_bytes(bits // 8, "little", signed=True) for v in whole)
    (tmp_path / "a.wav").write_bytes(wav_bytes(kind, bits, 2, data, extensible=extensible))
    tolerance = 2.0 / 2 ** (min(bits, 24) - 1)  # one step of rounding, one of scale; float32 has 24 bits
    np.testing.assert_allclose(read_sound(tmp_path / "a.wav", RATE).mean(axis=1), mono, atol=tolerance)


@pytest.mark.parametrize("rate", [44_100, 22_050, 96_000])
def test_other_rates_keep_pitch_and_level(tmp_path, rate):
    data = np.rint(tone(0.5, rate) * 32767).astype("<i2").tobytes()
    (tmp_path / "a.wav").write_bytes(wav_bytes(1, 16, 1, data, rate))
    read = read_sound(tmp_path / "a.wav", RATE).mean(axis=1)
    assert len(read) == RATE // 2
    inner = slice(RATE // 10, RATE * 4 // 10)
    # the ends ring where the tone begins and ends abruptly; inside, a band-limited tone is kept
    np.testing.assert_allclose(read[inner], tone(0.5)[inner], atol=2e-3)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"RIFF",
        b"ID3 an mp3",
        wav_bytes(1, 16, 1, b""),
        wav_bytes(2, 4, 1, b"\0" * 64),
        wav_bytes(1, 16, 0, b"\0" * 64),
        wav_bytes(3, 32, 1, np.array([np.nan], "<f4").tobytes()),
        wav_bytes(1, 16, 1, b"\0" * 64)[:30],
        wav_bytes(1, 16, 1, b"\0" * 64, rate=0),
    ],
    ids=["empty", "stump", "mp3", "no samples", "adpcm", "no channel", "nan", "cut header", "rate 0"],
)
def test_what_is_no_sound_is_refused_by_name(tmp_path, content):
    (tmp_path / "broken.wav").write_bytes(content)
    with pytest.raises(SceneError, match=r"broken\.wav"):
        read_sound(tmp_path / "broken.wav", RATE)


def test_missing_file_is_named(tmp_path):
    with pytest.raises(SceneError, match=r"missing\.wav.*cannot be read"):
        read_sound(tmp_path / "missing.wav", RATE)
