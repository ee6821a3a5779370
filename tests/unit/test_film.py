"""Films: what ffmpeg is given, what is made without it, and that no live frame waits."""

from __future__ import annotations

import errno
import os
import stat
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from mimics_app.app.picture import video
from mimics_app.app.picture.video import Film, draw_film, film_place
from mimics_app.app.play.play import play
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.errors import OutputError
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.surfaces.frame_reader import FrameReader

SIZE = (31, 17)
NS = 1_000_000_000

_FFMPEG = """#!{python}
import sys
arguments = sys.argv[1:]
data = sys.stdin.buffer.read()
open(arguments[-1], "wb").write(data)
open(arguments[-1] + ".arguments", "w").write(" ".join(arguments))
"""
_BROKEN = """#!{python}
import sys
sys.stderr.write("Unknown encoder\\nmore words")
sys.exit(1)
"""


@pytest.fixture
def ffmpeg(tmp_path, monkeypatch):
    """Puts a program called ffmpeg on the path that writes what it is given."""

    def install(text: str) -> None:
        folder = tmp_path / "bin"
        folder.mkdir(exist_ok=True)
        program = folder / "ffmpeg"
        program.write_text(text.format(python=sys.executable))
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")

    return install


def shoot(wanted: Path, times_s: list[float], *, live: bool = False) -> Film:
    """A film of a surface that grows redder picture by picture, its lower half black."""
    with create_surface("egl", SIZE) as surface:
        film = Film(surface, wanted, live=live)
        for number, seconds in enumerate(times_s):
            surface.framebuffer.clear((number + 1) * 10 / 255, 0.0, 0.0, 1.0)
            surface.framebuffer.clear(0.0, 0.0, 0.0, 1.0, viewport=(0, 0, SIZE[0], SIZE[1] // 2))
            film.take(round(seconds * NS))
        film.finish()
    return film


def reds(file: Path) -> list[int]:
    """Redness of the upper half of each picture ffmpeg was given."""
    data = np.frombuffer(file.read_bytes(), np.uint8).reshape(-1, SIZE[1], SIZE[0], 3)
    assert (data[:, 0] == 0).all(), "rows come from the bottom up"
    return data[:, -1, 0, 0].tolist()


@pytest.mark.parametrize("live", [False, True])
def test_each_picture_is_seen_as_long_as_it_was(tmp_path, ffmpeg, live):
    """At 0, 1/60, 4/60 s: one frame, three frames, and the last once."""
    ffmpeg(_FFMPEG)
    film = shoot(tmp_path / "out.mp4", [5.0, 5.0 + 1 / 60, 5.0 + 4 / 60], live=live)
    assert reds(film.place) == [10, 20, 20, 20, 30]
    assert (film.dropped, film.problem) == (0, "")
    arguments = (tmp_path / "out.mp4.arguments").read_text()
    assert f"-video_size {SIZE[0]}x{SIZE[1]} -framerate 60" in arguments and "vflip" in arguments


def test_without_ffmpeg_frames_are_files_and_it_is_reported(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    film = shoot(tmp_path / "sub" / "out.mp4", [0.0, 1 / 60, 3 / 60])
    assert sorted(file.name for file in film.place.iterdir()) == [f"frame_{n:06d}.png" for n in (0, 1, 3)]
    picture = np.array(Image.open(film.place / "frame_000003.png"))
    assert picture.shape == (SIZE[1], SIZE[0], 3) and picture[0, 0, 0] == 30 and picture[-1, 0, 0] == 0
    said = capsys.readouterr().err
    assert said == f"mimics: no ffmpeg for {tmp_path}/sub/out.mp4: frames go to {tmp_path}/sub/out/ as PNG; " + (
        "install ffmpeg, or the extra `video`\n"
    )


def test_the_ffmpeg_of_the_extra_is_used_where_the_system_has_none(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    brought = SimpleNamespace(get_ffmpeg_exe=lambda: "/brought/ffmpeg")
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", brought)
    assert film_place(tmp_path / "out.mp4") == (tmp_path / "out.mp4", "/brought/ffmpeg")


def test_a_folder_is_asked_for_without_a_word(tmp_path, capsys):
    assert film_place(tmp_path / "frames") == (tmp_path / "frames", "")
    assert capsys.readouterr().err == ""


def test_an_ffmpeg_that_gives_up_is_reported_in_its_own_words(tmp_path, ffmpeg, capsys):
    ffmpeg(_BROKEN)
    film = shoot(tmp_path / "out.mp4", [n / 60 for n in range(200)])
    assert film.problem == "ffmpeg failed: Unknown encoder"
    assert capsys.readouterr().err == f"mimics: film {tmp_path}/out.mp4: ffmpeg failed: Unknown encoder\n"


def test_a_film_that_cannot_be_written_ends_the_command_with_the_place(tmp_path, monkeypatch):
    def fill(self, number, frame):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(video._PngFolder, "add", fill)
    renderer = SimpleNamespace(draw_finished=lambda views: SimpleNamespace(cpu_ms=1.0))
    with create_surface("egl", SIZE) as surface, pytest.raises(OutputError, match="No space left") as error:
        draw_film(renderer, surface, 2, lambda number: (), tmp_path / "frames")
    assert error.value.issues[0].file == str(tmp_path / "frames")


def test_a_live_film_drops_what_the_thread_cannot_take_and_counts_it(tmp_path, capsys):
    """The thread does not run: sixteen pictures wait, two are in the driver, the rest is dropped, nobody blocks."""
    gate = threading.Event()
    with create_surface("egl", SIZE) as surface:
        film = Film(surface, tmp_path / "frames", live=True)
        add = film._sink.add

        def wait_and_add(*arguments) -> None:
            gate.wait(60.0)
            add(*arguments)

        film._sink.add = wait_and_add
        for number in range(60):
            film.take(number * NS // 60)
        dropped = film.dropped
        gate.set()
        film.finish()
    assert 60 - 2 - 16 - 1 <= dropped <= 60 - 2 - 16
    kept = len(list((tmp_path / "frames").iterdir()))
    assert kept + film.dropped == 60
    assert f"{film.dropped} pictures were dropped" in capsys.readouterr().err


def test_a_window_that_changed_its_size_goes_on_in_the_first_size(tmp_path, ffmpeg):
    ffmpeg(_FFMPEG)
    with create_surface("egl", SIZE) as surface:
        film = Film(surface, tmp_path / "out.mp4", live=False)
        for number, size in enumerate([SIZE, (64, 40), SIZE]):
            surface.resize(size)
            surface.framebuffer.clear(0.2, 0.0, 0.0, 1.0)
            film.take(number * NS // 60)
        film.finish()
    assert film.place.stat().st_size == 3 * 3 * SIZE[0] * SIZE[1]


def test_a_run_that_is_broken_off_leaves_a_whole_film(tmp_path, ffmpeg, monkeypatch):
    """Ctrl-C at frame 7: what was drawn is in the file, and ffmpeg was not interrupted with the run."""
    ffmpeg(_FFMPEG)
    shown: list[int] = []

    def interrupt(self, frames) -> None:
        shown.append(frames.number)
        if len(shown) == 7:
            raise KeyboardInterrupt

    monkeypatch.setattr("mimics_app.app.play.play.ProgressLine.show", interrupt)
    settings = RunSettings(
        Path("wavy_tunnel"), headless=True, seconds=5.0, runs=tmp_path, sound="off", size=SIZE, video=tmp_path / "a.mp4"
    )
    with pytest.raises(KeyboardInterrupt):
        play(settings, as_json=False)
    assert (tmp_path / "a.mp4").stat().st_size == 7 * 3 * SIZE[0] * SIZE[1]


def test_a_film_is_finished_once(tmp_path):
    film = shoot(tmp_path / "frames", [0.0])
    film.finish()
    assert len(list((tmp_path / "frames").iterdir())) == 1


def test_a_window_that_changes_its_size_leaves_no_read_buffer_behind():
    with create_surface("egl", SIZE) as surface:
        held, reserve = [], surface.ctx.buffer
        surface.ctx.buffer = lambda **how: held.append(reserve(**how)) or held[-1]
        reader = FrameReader(surface, behind=1)
        for width in (31, 40, 50, 60, 60, 60):
            surface.resize((width, SIZE[1]))
            reader.take(width)
        sizes = {buffer.size for buffer in held if type(buffer.mglo).__name__ != "InvalidObject"}
        reader.release()
    assert sizes == {3 * 60 * SIZE[1]}
