"""Films: pictures handed to a thread that gives them to ffmpeg, or writes PNG files where that is not installed."""

from __future__ import annotations

import queue
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import IO, TYPE_CHECKING, Protocol

from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS
from mimics_app.contracts.errors import UsageError
from mimics_app.rendering.visual.frame_set import FrameSet
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.frame_reader import FrameReader, ReadFrame
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.rendering.visual.view import View

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["Film", "draw_film", "film_place"]

_ROOM = 16
"""Pictures that may wait for the thread."""
_LONGEST_GAP = 600
"""Frames a picture is repeated at most, where a run was halted."""


def film_place(wanted: Path) -> tuple[Path, str]:
    """Return the file of a video, and the path of ffmpeg ("" for PNG files).

    A name without an ending is a folder for PNG files; so is FILE of FILE.mp4 without ffmpeg, which is reported.
    """
    if not wanted.suffix:
        return wanted, ""
    program = shutil.which("ffmpeg") or _ffmpeg_of_extra()
    if program is None:
        folder = wanted.with_suffix("")
        sys.stderr.write(
            f"mimics: no ffmpeg for {wanted}: frames go to {folder}/ as PNG; install ffmpeg, or the extra `video`\n"
        )
        return folder, ""
    return wanted, program


def _ffmpeg_of_extra() -> str | None:
    """Return the program that the extra `video` (imageio-ffmpeg) brings along, or None."""
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):  # not installed; or a platform for which its wheel has no program
        return None


class _Sink(Protocol):
    """Encoder of a video; it runs entirely in the thread."""

    def add(self, number: int, frame: ReadFrame) -> None:
        """Take the picture that is seen up to frame `number` of the film."""
        ...

    def close(self) -> None:
        """Finish."""
        ...


class Film:
    """Takes every picture of a surface.

    Args:
        surface: Whose.
        wanted: The file, see `film_place`.
        live: True never makes a frame wait: a picture for which there is no room is dropped and counted. False drops
            none.

    Attributes:
        place: The file, or the folder of PNG files.
        dropped: Pictures for which there was no room.
        problem: Why the film ends early, "" where it does not.
    """

    def __init__(self, surface: Surface, wanted: Path, *, live: bool) -> None:
        self.place, program = film_place(wanted)
        folder = self.place.parent if program else self.place
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UsageError(f"no film can be written to {folder}: {error.strerror}", "give another --video") from None
        self._sink: _Sink = _Ffmpeg(program, self.place, surface.size) if program else _PngFolder(self.place)
        self._surface, self._live = surface, live
        self._reader = FrameReader(surface, 2 if live else 0)
        self._begun_ns: int | None = None
        self._queue: queue.Queue[ReadFrame | None] = queue.Queue(_ROOM)
        self._finished = False
        self.dropped = 0
        self.problem = ""
        self._thread = threading.Thread(target=self._write, name="film", daemon=True)
        self._thread.start()

    def take(self, t_ns: int) -> None:
        """Take the picture drawn last, which is seen from a time on [ns]."""
        for frame in self._reader.take(t_ns):
            self._hand_over(frame)

    def forget(self) -> None:
        """The surface's context is lost: pictures that were not read yet are gone."""
        self._reader = FrameReader(self._surface, self._reader.behind)

    def finish(self) -> None:
        """Write what is still waiting, and close the file; the first time it is called."""
        if self._finished:
            return
        self._finished = True
        for frame in self._reader.flush():
            self._hand_over(frame)
        self._reader.release()
        self._queue.put(None)
        self._thread.join()
        if self.dropped or self.problem:
            what = self.problem or f"{self.dropped} pictures were dropped: this machine does not keep up"
            sys.stderr.write(f"mimics: film {self.place}: {what}\n")

    def _hand_over(self, frame: ReadFrame) -> None:
        if not self._live:
            self._queue.put(frame)
            return
        try:
            self._queue.put_nowait(frame)
        except queue.Full:
            self.dropped += 1

    def _write(self) -> None:
        """The thread: until the end is announced; after a fault it only empties the queue."""
        while (frame := self._queue.get()) is not None:
            if self.problem:
                continue
            if self._begun_ns is None:
                self._begun_ns = frame.t_ns
            try:
                self._sink.add(round((frame.t_ns - self._begun_ns) * FRAMES_PER_SECOND / SECOND_NS), frame)
            except (OSError, ValueError) as error:
                self.problem = f"writing failed: {getattr(error, 'strerror', None) or error}"
        try:
            self._sink.close()
        except (OSError, ValueError) as error:
            self.problem = str(error)  # ffmpeg's own words say more than a broken pipe


def draw_film(
    renderer: Renderer,
    surface: Surface,
    count: int,
    views: Callable[[int], Sequence[View]],
    wanted: Path,
    presenter: Presenter | None = None,
) -> FrameSet:
    """Draw frames into a film, 60 for each second of it.

    Args:
        renderer: Draws on `surface`.
        surface: Any.
        count: Number of frames, >= 1.
        views: Called with the number of each frame before it is drawn: moves the world, returns the eyes.
        wanted: The file, see `film_place`.
        presenter: Of the display, None for a plain picture.
    """
    film, spent = Film(surface, wanted, live=False), []
    for number in range(count):
        spent.append(renderer.draw_finished(views(number)).cpu_ms)
        if presenter is not None:
            presenter.present()
        film.take(number * SECOND_NS // FRAMES_PER_SECOND)
    film.finish()
    return FrameSet([film.place], median(spent))


class _PngFolder:
    """One file a picture, named by its frame of 60 a second."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def add(self, number: int, frame: ReadFrame) -> None:
        picture = _picture(frame)
        picture.save(self._folder / f"frame_{number:06d}.png", compress_level=1)

    def close(self) -> None:
        """Every file is closed already."""


class _Ffmpeg:
    """Pipe to ffmpeg at 60 frames per second: a picture shown longer is repeated."""

    def __init__(self, program: str, file: Path, size: Size) -> None:
        self._size = size
        self._written = 0
        self._last: bytes | None = None
        self._said: IO[bytes] = tempfile.TemporaryFile()
        source = ["-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", f"{size[0]}x{size[1]}"]
        source += ["-framerate", str(FRAMES_PER_SECOND), "-i", "-"]
        # Pictures come from the bottom up, and most decoders want even sides.
        made = ["-an", "-vf", "vflip,pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-y", str(file)]
        command = [program, "-hide_banner", "-loglevel", "error", *source, *made]
        # In a session of its own: Ctrl-C ends the run, which then closes the film; it must not end ffmpeg first.
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._said, start_new_session=True
        )

    def add(self, number: int, frame: ReadFrame) -> None:
        self._repeat_until(number)
        same = frame.size == self._size
        self._last = frame.pixels if same else _resized(frame, self._size)

    def close(self) -> None:
        assert self._process.stdin is not None
        try:
            self._repeat_until(self._written + 1)
            self._process.stdin.close()
        except BrokenPipeError:
            pass  # its own words follow
        if self._process.wait() != 0:
            self._said.seek(0)
            words = self._said.read().decode(errors="replace").split("\n")[0]
            raise ValueError(f"ffmpeg gave up: {words}")

    def _repeat_until(self, number: int) -> None:
        """Write the newest picture for every frame before `number`."""
        assert self._process.stdin is not None
        times = min(number - self._written, _LONGEST_GAP)
        self._written = max(number, self._written)
        for _ in range(times if self._last is not None else 0):
            self._process.stdin.write(self._last or b"")


def _resized(frame: ReadFrame, size: Size) -> bytes:
    """The picture in another size, from the bottom up again."""
    from PIL import Image

    return _picture(frame).resize(size).transpose(Image.Transpose.FLIP_TOP_BOTTOM).tobytes()


def _picture(frame: ReadFrame) -> Image.Image:
    """The picture, its first row on top."""
    from PIL import Image

    whole = Image.frombytes("RGB", frame.size, frame.pixels)
    return whole.transpose(Image.Transpose.FLIP_TOP_BOTTOM)
