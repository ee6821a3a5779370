"""Builders are found without being imported, have one habit, and build through the command line."""

from __future__ import annotations

import importlib
import inspect
import itertools
import json
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from assets import builders as builders_room
from assets.builders import catalogue
from assets.builders.catalogue import find_builder, find_builders
from assets.builders.fonts.build import FOLDER
from assets.builders.sounds.spectrogram import draw_spectrograms
from mimics_app.app import cli
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.system.resources import root
from mimics_app.rendering.audio.sound_file import read_sound
from mimics_app.rendering.audio.synth import synthesise_tick
from mimics_app.rendering.audio.wav_file import WavWriter


def test_builders_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["assets", "list", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["builders"]
    assert {"city", "sounds"} <= {row["name"] for row in rows}
    assert all(row["what"] for row in rows)


def test_sounds_are_built(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["assets", "build", "sounds", "--out", str(tmp_path / "new"), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["files"]
    assert len(rows) > 5
    assert all(Path(row["file"]).stat().st_size == row["bytes"] for row in rows)
    heard = read_sound(tmp_path / "new" / "tick.wav", 48_000).mean(axis=1)
    assert np.abs(heard - synthesise_tick()).max() <= 1.01 / 32767, "16 bit: half a step of rounding"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["build"], "the name of a builder is missing"),
        (["build", "citty"], "city"),
        (["build", "city", "--seed", "-1"], "-1 is not a whole number"),
    ],
)
def test_wrong_use_is_one_line(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["assets", *arguments]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    "name", ["alley", "canyon", "city", "icon", "orthosis", "room", "skies", "sprites", "stadium", "touch"]
)
def test_shipped_files_are_the_bytes_of_seed_1(name: str) -> None:
    """Nothing is written: `compose` gives bytes by name; sines may differ in their last digit on another machine.

    The market's files, which take longest, are compared in their own tests.
    """
    folder = root() / "assets" / ("" if name in ("icon", "sprites") else "models") / name
    made = find_builder(name).compose(1)
    shipped = {file.name: file.read_bytes() for file in folder.iterdir() if file.suffix in (".glb", ".png")}
    assert set(made) == set(shipped)
    if name in ("city", "skies", "sprites"):  # the bowl's sines are compared to a micrometre elsewhere
        assert made == shipped
    else:
        assert {file: len(content) for file, content in made.items()} == {f: len(c) for f, c in shipped.items()}


@pytest.mark.skipif(not FOLDER.is_dir(), reason="the fonts that the atlas is made of are not installed")
def test_the_atlas_of_letters_is_made_of_its_fonts() -> None:
    made, shipped = find_builder("fonts").compose(1), root() / "assets" / "fonts"
    assert json.loads(made["glyphs.json"]) == json.loads((shipped / "glyphs.json").read_text(encoding="utf-8"))
    with Image.open(BytesIO(made["glyphs.png"])) as new, Image.open(shipped / "glyphs.png") as old:
        assert new.tobytes() == old.tobytes()


def test_every_builder_has_the_habit() -> None:
    builders = find_builders()
    assert {"city", "market", "room", "sounds", "sprites", "touch"} <= {builder.name for builder in builders}
    for builder in builders:
        module = importlib.import_module(f"assets.builders.{builder.name}.build")
        assert "compose" in module.__all__ and list(inspect.signature(module.compose).parameters) == ["seed"]


def test_a_builder_that_is_added_is_found_and_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new package is all it takes; one without a module `build` is none."""
    (tmp_path / "toys").mkdir()
    (tmp_path / "toys" / "__init__.py").write_text("")
    (tmp_path / "toys" / "build.py").write_text(
        '"""Toys."""\ndef compose(seed):\n    return {"b/toy.txt": b"%d" % seed, "a.txt": b""}\n'
    )
    (tmp_path / "parts").mkdir()
    monkeypatch.setattr(catalogue, "_ROOM", tmp_path)
    monkeypatch.setattr(builders_room, "__path__", [str(tmp_path)])
    assert [(builder.name, builder.what) for builder in find_builders()] == [("toys", "Toys.")]
    files = find_builder("toys").write(tmp_path / "out", 5)
    assert [file.relative_to(tmp_path / "out").as_posix() for file in files] == ["a.txt", "b/toy.txt"]
    assert files[1].read_bytes() == b"5"
    with pytest.raises(UsageError):
        find_builder("parts")


def test_what_was_built_is_drawn_from_six_sides(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "touch.png"
    asked = ["assets", "build", "touch", "--out", str(tmp_path / "models"), "--picture", str(picture)]
    assert cli.main(asked) == 0
    with Image.open(picture) as sheet:
        width, height = sheet.size
        pixels = np.asarray(sheet.convert("RGB"))
    assert (width, height) == (6 * 406 + 6, 6 * 306 + 6)
    stone = [pixels[1536:1836, 6 + 406 * side : 406 + 406 * side] for side in range(6)]
    assert all((one != two).any() for one, two in itertools.pairwise(stone))
    assert cli.main(["assets", "build", "sprites", "--out", str(tmp_path), "--picture", str(picture)]) == 2
    assert "sprites builds neither a model" in capsys.readouterr().err


def test_sounds_are_drawn_as_spectra(tmp_path: Path) -> None:
    """A tone of 4 kHz stands at a quarter of the picture's height, whose top is 16 kHz."""
    tone = (0.5 * np.sin(2 * np.pi * 4000.0 * np.arange(24_000) / 48_000)).astype(np.float32)
    writer = WavWriter(tmp_path / "tone.wav", 48_000)
    writer.append(np.repeat(tone[:, None], 2, axis=1))
    writer.close()
    draw_spectrograms([tmp_path / "tone.wav"], tmp_path / "sheet.png")
    with Image.open(tmp_path / "sheet.png") as sheet:
        light = np.asarray(sheet.convert("L"), np.float64)[16:170, 20:280].mean(axis=1)
    assert 1.0 - int(np.argmax(light)) / len(light) == pytest.approx(0.25, abs=0.02)
