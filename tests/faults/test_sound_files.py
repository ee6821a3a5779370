"""Heads and sounds that cannot be used are refused with the file and the reason, and nothing else happens."""

from __future__ import annotations

import json
import os
import tracemalloc

import numpy as np
import pytest
import soundfile

from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.system import read_budget
from mimics_app.rendering.audio import sound_file
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.settings import SoundSpec
from mimics_app.rendering.audio.sound_file import check_sound_file, read_sound
from mimics_app.rendering.audio.spectral.sofa import read_sofa
from tests.support.heads import some_head, write_sofa

HEAD = some_head(44_100, 40)


@pytest.mark.parametrize(
    ("changes", "reported"),
    [
        ({"Data_SamplingRate": np.array([0.0])}, "sampling rate of 0 Hz"),
        ({"Data_SamplingRate": np.array([np.nan])}, "sampling rate of nan"),
        ({"Data_SamplingRate": None}, "has no Data.SamplingRate"),
        ({"Data_IR": None}, "no impulse responses"),
        ({"Data_IR": HEAD.responses[:, :1]}, "has the shape"),
        ({"Data_IR": HEAD.responses[:5]}, "5 responses for"),
        ({"Data_IR": HEAD.responses[:, :, :8]}, "8 samples"),
        ({"Data_IR": np.where(HEAD.responses > 0, HEAD.responses, np.nan)}, "not finite"),
        ({"Data_IR": HEAD.responses * np.array([1.0, 0.0])[:, None]}, "silent in an ear"),
        ({"SourcePosition": np.full((len(HEAD.responses), 3), np.inf)}, "three finite numbers"),
        ({"SourcePosition": np.tile([0.0, 0.0, 1.4], (len(HEAD.responses), 1))}, "no direction near"),
        ({"convention": "GeneralTF"}, '"GeneralTF"'),
    ],
)
def test_a_head_that_cannot_be_used_is_refused_by_reason(tmp_path, changes, reported):
    with pytest.raises(SceneError) as caught:
        read_sofa(write_sofa(tmp_path / "head.sofa", HEAD, **changes))
    (issue,) = caught.value.issues
    assert reported in issue.what and issue.file.endswith("head.sofa") and issue.fix


def test_a_truncated_head_one_that_is_no_file_and_one_of_text_are_refused(tmp_path):
    whole = write_sofa(tmp_path / "whole.sofa", HEAD).read_bytes()
    for name, content in (("half.sofa", whole[: len(whole) // 2]), ("text.sofa", b"SOFA\n" * 100), ("none.sofa", None)):
        if content is not None:
            (tmp_path / name).write_bytes(content)
        with pytest.raises(SceneError, match=name):
            read_sofa(tmp_path / name)


def faults_of(folder, **audio) -> list[tuple[str, str]]:
    """Pointer and fault of each fault that the check of a scene finds in its `systems.audio`."""
    entities = [{"id": "hum", "components": {"sound": {"synth": "wind"}}}]
    document = {"format": "mimics-scene", "version": 1, "name": "heard", "scenario": "none", "entities": entities}
    document |= {"assets": {"head": {"uri": "head.sofa"}}, "systems": {"audio": audio}}
    (folder / "scene.json").write_text(json.dumps(document))
    try:
        load_checked_scene(folder / "scene.json")
    except SceneError as error:
        return [(issue.pointer, issue.what) for issue in error.issues]
    return []


def test_a_scene_whose_sound_could_not_play_as_it_says_is_refused(tmp_path):
    """Before a session starts; each was a traceback, or ignored."""
    write_sofa(tmp_path / "head.sofa", some_head())
    assert faults_of(tmp_path, sofa="head") == faults_of(tmp_path, hrtf=False, speakers="5.1") == []
    assert faults_of(tmp_path, sofa="heat") == [("/systems/audio/sofa", 'no asset "heat"')]
    assert faults_of(tmp_path, sofa="head", mixer="openal") == [
        ("/systems/audio/mixer", '"openal" plays no head of a file')
    ]
    assert faults_of(tmp_path, hrtf=False, speakers="7.1", mixer="openal") == [
        ("/systems/audio/mixer", '"openal" plays no 7.1')
    ]
    assert faults_of(tmp_path, speakers="5.1") == [
        ("/systems/audio/speakers", "5.1 is not played with head-related filters")
    ]
    (tmp_path / "head.sofa").write_bytes((tmp_path / "head.sofa").read_bytes()[:2000])
    ((pointer, what),) = faults_of(tmp_path, sofa="head")
    assert pointer == "/systems/audio/sofa" and what.startswith("head.sofa cannot be read")


def test_places_may_be_spherical_or_cartesian(tmp_path):
    heads = [read_sofa(write_sofa(tmp_path / f"{kind}.sofa", HEAD, cartesian=kind)) for kind in (False, True)]
    for head in heads:
        np.testing.assert_allclose(head.directions, HEAD.directions, atol=1e-9)
        np.testing.assert_array_equal(head.responses, HEAD.responses)


TONE = np.stack((0.5 * np.sin(np.arange(24_000) * 0.05), 0.25 * np.cos(np.arange(24_000) * 0.11)), axis=1)


@pytest.mark.parametrize(("suffix", "error"), [("wav", 1e-4), ("flac", 1e-4), ("ogg", 0.06)])
def test_sounds_of_every_kind_are_read_at_our_rate(tmp_path, suffix, error):
    path = tmp_path / f"tone.{suffix}"
    soundfile.write(path, TONE, 48_000)
    samples = read_sound(path, 48_000)
    assert samples.shape == TONE.shape
    assert np.abs(samples[1000:-1000] - TONE[1000:-1000]).max() < error
    assert read_sound(path, 24_000).shape == (12_000, 2)


def test_a_recording_that_is_not_spatial_keeps_its_two_channels(tmp_path):
    soundfile.write(tmp_path / "tone.flac", TONE, 48_000)
    specs = {
        "mixed": SoundSpec(file=tmp_path / "tone.flac"),
        "binaural": SoundSpec(file=tmp_path / "tone.flac", spatial=False),
    }
    bank = SoundBank(specs, 48_000)
    np.testing.assert_allclose(bank["mixed"].samples, TONE.mean(axis=1), atol=1e-4)
    left = bank["binaural"]
    assert (left.cell, left.other) == (1, "binaural:right") and bank["binaural:right"].cell == 2
    np.testing.assert_allclose(bank["binaural:right"].samples, TONE[:, 1], atol=1e-4)


@pytest.mark.parametrize("name", ["noise.ogg", "cut.flac", "empty.wav", "missing.ogg", "text.flac"])
def test_damaged_sounds_are_refused_with_their_name(tmp_path, name):
    path = tmp_path / name
    if name == "noise.ogg":
        path.write_bytes(np.random.default_rng(1).bytes(4000))
    elif name == "cut.flac":
        soundfile.write(path, TONE, 48_000)
        path.write_bytes(path.read_bytes()[:60])
    elif name != "missing.ogg":
        path.write_bytes(b"no sound" if name == "text.flac" else b"")
    with pytest.raises(SceneError, match=name):
        read_sound(path, 48_000)


def test_a_sound_of_2_gb_is_refused_before_it_is_read(tmp_path):
    """A file with a hole: its size is reported, nothing of it is on the disk."""
    path = tmp_path / "long.wav"
    with path.open("wb") as file:
        file.truncate(2 << 30)
    with pytest.raises(SceneError, match=r"2\.1 GB"):
        read_sound(path, 48_000)


def test_a_sound_that_says_it_lasts_for_days_is_refused_before_it_is_decoded(tmp_path):
    """A few bytes of FLAC can say so, and a compressed silence can even be so; the memory for it is never requested."""
    path = tmp_path / "days.flac"
    soundfile.write(path, TONE, 48_000)
    content = bytearray(path.read_bytes())
    content[21] |= 0x0F  # 36 bits of STREAMINFO: the number of frames (RFC 9639, 8.2)
    content[22:26] = b"\xff\xff\xff\xff"
    path.write_bytes(content)
    with pytest.raises(SceneError, match="lasts 1431656 s; 43200 s at most"):
        read_sound(path, 48_000)


def silence(path, channels: int, rate: int, seconds: float):
    """A FLAC of silence, a thousandth of what it decodes to."""
    with soundfile.SoundFile(path, "w", rate, channels, format="FLAC") as file:
        for _ in range(round(seconds / 4)):
            file.write(np.zeros((4 * rate, channels), np.int16))
    return path


@pytest.mark.parametrize(("channels", "rate", "seconds"), [(8, 48_000, 12), (1, 384_000, 48), (8, 8_000, 12)])
def test_a_sound_is_refused_by_what_it_decodes_to_and_not_only_by_its_seconds(
    tmp_path, channels, rate, seconds, monkeypatch
):
    """With a sixteenth of the budget, so that the file need not last for an hour."""
    assert read_budget.READ_BUDGET <= 1 << 28
    monkeypatch.setattr(read_budget, "READ_BUDGET", read_budget.READ_BUDGET // 16)
    path = silence(tmp_path / "long.flac", channels, rate, seconds)
    assert path.stat().st_size < 1 << 17
    tracemalloc.start()
    try:
        with pytest.raises(SceneError, match="MB of memory"):
            read_sound(path, 48_000)
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
    finally:
        tracemalloc.stop()


def test_what_is_too_large_to_be_held_is_refused_by_the_check_as_by_the_session(tmp_path, monkeypatch):
    """A sound at 16 kHz is held as three times as many samples: the check saw the file's own size and let it pass."""
    monkeypatch.setattr(read_budget, "READ_BUDGET", read_budget.READ_BUDGET // 256)
    path = silence(tmp_path / "music.flac", 1, 16_000, 16)
    for refuse in (lambda: read_sound(path, 48_000), lambda: check_sound_file(path, None, whole=False)):
        with pytest.raises(SceneError, match=r"MB of memory.*save it with fewer channels"):
            refuse()


@pytest.mark.parametrize("rate", [44_100, 44_101, 96_000])
def test_a_long_sound_is_resampled_in_blocks_as_in_one_piece(tmp_path, rate, monkeypatch):
    """Against the sines themselves, which are written at the other rate; the joints lie where the blocks meet."""
    monkeypatch.setattr(sound_file, "_BLOCK", 60_000)

    def sines(at: int) -> np.ndarray:
        t = np.arange(4 * at) / at
        return np.stack((0.5 * np.sin(2e3 * np.pi * t), 0.4 * np.cos(2.6e4 * np.pi * t)), axis=1)

    soundfile.write(tmp_path / "long.wav", sines(rate), rate, "DOUBLE")
    found = read_sound(tmp_path / "long.wav", 48_000)
    assert found.shape == (192_000, 2)
    # Both ends ring, where the sines begin and end abruptly.
    assert np.abs(found - sines(48_000))[24_000:-24_000].max() < 1e-5


def test_a_sound_that_is_cut_off_ends_where_it_is_cut(tmp_path):
    path = tmp_path / "cut.wav"
    soundfile.write(path, TONE, 48_000)
    path.write_bytes(path.read_bytes()[:40_000])
    assert len(read_sound(path, 24_000)) == (40_000 - 44) // 4 // 2


def test_a_pipe_is_no_sound(tmp_path):
    os.mkfifo(tmp_path / "pipe.wav")
    with pytest.raises(SceneError, match="not a regular file"):
        read_sound(tmp_path / "pipe.wav", 48_000)


@pytest.mark.parametrize("name", ["hum.ogg", "hum.flac", "hum.wav"])
def test_check_refuses_a_sound_that_a_run_would_not_play(tmp_path, name):
    entities = [{"id": "hum", "components": {"sound": {"asset": "hum"}}}]
    document = {"format": "mimics-scene", "version": 1, "name": "heard", "scenario": "none", "entities": entities}
    (tmp_path / "scene.json").write_text(json.dumps(document | {"assets": {"hum": {"uri": name}}}))
    head = {"hum.ogg": b"OggS", "hum.flac": b"fLaC", "hum.wav": b"RIFF\0\0\0\0WAVE"}[name]
    (tmp_path / name).write_bytes(head + bytes(60))
    with pytest.raises(SceneError, match=rf"{name} cannot be read as a sound"):
        load_checked_scene(tmp_path / "scene.json")
