"""What a scene asks of its sound, and what it may not ask."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mimics_app.contracts.errors import SceneError
from mimics_app.rendering.audio.bank import SoundBank
from mimics_app.rendering.audio.scene_sounds import settings_from_components
from mimics_app.rendering.audio.settings import AudioSettings, SoundSpec
from mimics_app.rendering.audio.synth_crowd import synthesise_crowd
from mimics_app.world.components.visible import Sound, SoundEmitter
from mimics_app.world.files.scene.assets import SceneAsset


def from_scene(sounds, emitters=(), **changes):
    assets = {"rain": SceneAsset("rain", "sound", Path("rain.wav"))}
    return settings_from_components(sounds, emitters, assets, "scene.json", **changes)


def test_scene_without_sound_has_no_audio():
    assert from_scene([]) is None


def test_scene_sounds_become_settings():
    settings = from_scene(
        [
            ("wall_touch", Sound(synth="contact", trigger="contact", gain=0.8, full_level=20.0), "/entities/0"),
            ("chime", Sound(synth="goal", trigger="goal", parameters={"pitch": 0.5}), "/entities/1"),
            ("rub", Sound(synth="scrape", gain=0.5), "/entities/2"),
            ("rain", Sound(asset="rain"), "/entities/3"),
        ],
        [("cloud", SoundEmitter(sound="rain", gain=0.5, max_distance=9.0), "/entities/4")],
        sink="null",
    )
    assert settings is not None
    assert dict(settings.triggers) == {"contact": "wall_touch", "goal": "chime"}
    assert settings.scrape == "rub"
    assert settings.sounds["wall_touch"] == SoundSpec(recipe="contact", gain=0.8, full_force=20.0)
    assert settings.sounds["chime"].pitch == 0.5
    assert settings.sounds["cloud"] == SoundSpec(file=Path("rain.wav"), gain=0.5, loop=True, max_distance=9.0)
    assert settings.emitters == ("cloud",)
    assert settings.sink == "null"


def test_every_fault_of_a_scenes_sounds_is_reported_at_once():
    with pytest.raises(SceneError) as caught:
        from_scene(
            [
                ("a", Sound(synth="contakt"), "/entities/0/components/sound"),
                ("b", Sound(synth="goal", parameters={"pich": 2.0}), "/entities/1/components/sound"),
                ("c", Sound(synth="goal", parameters={"pitch": float("nan")}), "/entities/2/components/sound"),
                ("d", Sound(synth="wind", parameters={"arousal": 0.5}), "/entities/3/components/sound"),
                ("e", Sound(synth="crowd", parameters={"arousal": 1.5}), "/entities/4/components/sound"),
            ]
        )
    assert [issue.pointer for issue in caught.value.issues] == [
        "/entities/0/components/sound/synth",
        "/entities/1/components/sound/parameters/pich",
        "/entities/2/components/sound/parameters/pitch",
        "/entities/3/components/sound/parameters/arousal",
        "/entities/4/components/sound/parameters/arousal",
    ]
    assert 'did you mean "contact"' in str(caught.value)


def test_a_scene_rouses_its_crowd():
    """To the samples, as the roused one is another recording (its sound: test_synth_scene)."""
    parameters = {"parameters": {"arousal": 1.0}}
    settings = from_scene([("calm", Sound(synth="crowd"), ""), ("roused", Sound(synth="crowd", **parameters), "")])
    bank = SoundBank(settings.sounds, 8_000)
    assert np.array_equal(bank["calm"].samples, synthesise_crowd(8_000))
    assert np.array_equal(bank["roused"].samples, synthesise_crowd(8_000, 1.0))
    assert bank["roused"].spec.loop


def test_a_bank_names_every_file_it_cannot_read(tmp_path):
    specs = {name: SoundSpec(file=tmp_path / f"{name}.wav") for name in ("one", "two")}
    with pytest.raises(SceneError) as caught:
        SoundBank(specs, 48_000)
    assert [Path(issue.file).name for issue in caught.value.issues] == ["one.wav", "two.wav"]


@pytest.mark.parametrize(
    ("settings", "match"),
    [
        ({"sink": "file"}, "needs a file"),
        ({"period": 1024}, "20 ms"),
        ({"triggers": {"contact": "thud"}}, '"thud"'),
        ({"scrape": "bell"}, '"bell"'),
        ({"emitters": ("sea",)}, '"sea"'),
    ],
)
def test_settings_that_cannot_be_are_refused(settings, match):
    with pytest.raises(ValueError, match=match):
        AudioSettings(**settings)


def test_the_seam_and_the_settings_import_nothing_heavy():
    """numba looks at scipy's version: the bare package is there, none of its parts is."""
    code = (
        "import sys; import mimics_app.rendering.audio.settings, mimics_app.rendering.audio.process; "
        "heavy = ('openal', 'scipy.linalg', 'scipy.signal', 'scipy.fft', 'moderngl', 'multiprocessing.spawn'); "
        "heavy += ('mimics_app.rendering.audio.synth',); "
        "print([m for m in heavy if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
