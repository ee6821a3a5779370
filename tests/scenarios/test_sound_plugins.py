"""A sound recipe and a mixer of another package, which change no file of the product."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import soundfile

from tests.support.command import mimics, mimics_with
from tests.support.plugin_site import write_package

SOURCE = """
import numpy as np

from mimics_app.rendering.audio.mixer_kinds import MixerKind, find_mixer
from mimics_app.rendering.audio.recipe import Recipe


def whistle(variant, rate):
    t = np.arange(rate // 2) / rate
    return (0.5 * np.sin(2.0 * np.pi * 1000.0 * t)).astype(np.float32)


def broken(variant, rate):
    raise KeyError("no reed")


WHISTLE, BROKEN, WRONG = Recipe(whistle), Recipe(broken), Recipe(lambda _, rate: np.full(9, 7.0, np.float32))


class Halved:
    '''The mixer "openal" at half the level, which shows that it plays.'''

    def __init__(self, inner):
        self._inner = inner

    def __getattr__(self, name):
        return getattr(self._inner, name)

    def render(self, frames):
        return self._inner.render(frames) * np.float32(0.5)


HALVED = MixerKind(lambda request: Halved(find_mixer("openal").open(request)), most_voices=8)
"""

POINTS = """[mimics_app.sound_recipes]
whistle = lab_of_sounds:WHISTLE
reed = lab_of_sounds:BROKEN
loud = lab_of_sounds:WRONG
[mimics_app.mixers]
halved = lab_of_sounds:HALVED
"""


def scene_with(folder: Path, name: str, synth: str, mixer: str, speakers: str = "stereo") -> Path:
    """A scene of one sound that plays from the first frame on."""
    entities = [
        {"id": "robot", "prefab": "robot"},
        {"id": "tone", "components": {"sound": {"synth": synth}}},
        {
            "id": "pipe",
            "transform": {"translation": [0.0, 0.0, -1.0]},
            "components": {"sound_emitter": {"sound": "tone"}},
        },
    ]
    audio = {"mixer": mixer, "hrtf": False, "speakers": speakers}
    room = "mimics:scenes/parts/touch_room.json"
    head = {"format": "mimics-scene", "version": 1, "title": name, "include": [room]}
    content = {**head, "entities": entities, "systems": {"audio": audio}}
    file = folder / f"{name}.json"
    file.write_text(json.dumps(content))
    return file


def tone_of(file: Path) -> tuple[float, float]:
    """Frequency of the largest component [Hz], and the largest sample."""
    samples, rate = soundfile.read(file)
    left = samples[:, 0]
    spectrum = np.abs(np.fft.rfft(left * np.hanning(len(left))))
    return float(np.argmax(spectrum) * rate / len(left)), float(np.abs(left).max())


def test_a_recipe_and_a_mixer_of_another_package(tmp_path: Path) -> None:
    (tmp_path / "site").mkdir()
    site = write_package(tmp_path / "site", "lab_of_sounds", SOURCE, POINTS)
    plain = scene_with(tmp_path, "plain", "whistle", "openal")
    halved = scene_with(tmp_path, "halved", "whistle", "halved")
    around = scene_with(tmp_path, "around", "whistle", "halved", "5.1")
    reed, loud = (scene_with(tmp_path, name, name, "openal") for name in ("reed", "loud"))
    files = [tmp_path / "plain.wav", tmp_path / "halved.wav"]
    *rendered, refused, broken, wrong = mimics_with(
        site,
        *(
            ("render", scene, "--seconds", "1", "--audio", file)
            for scene, file in zip((plain, halved), files, strict=True)
        ),
        ("check", around),
        *(("render", scene, "--seconds", "0.2", "--audio", tmp_path / "x.wav") for scene in (reed, loud)),
    )
    for done in rendered:
        assert done.returncode == 0, done.stderr
    (tone, level), (same, half) = map(tone_of, files)
    assert abs(tone - 1000.0) < 3.0 and abs(same - 1000.0) < 3.0
    assert abs(half / level - 0.5) < 1e-3
    assert refused.returncode != 0 and '"halved" plays no 5.1' in refused.stderr + refused.stdout
    assert 'the recipe "reed" raised KeyError' in broken.stderr + broken.stdout
    assert 'the recipe "loud" makes samples beyond -1 to 1' in wrong.stderr + wrong.stdout
    for scene, what in ((plain, 'no recipe "whistle"'), (halved, 'there is no mixer "halved"')):
        absent = mimics("check", scene)
        assert absent.returncode != 0 and what in absent.stderr + absent.stdout
