"""Videos: a thread sends the pictures to ffmpeg, or writes PNG files where ffmpeg is not installed."""

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
from mimics_app.contracts.errors import OutputError
from mimics_app.rendering.visual.frame_set import FrameSet
from mimics_app.rendering.visual.presenting.presenter import Presenter
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.surfaces.frame_reader import FrameReader, ReadFrame
from mimics_app.rendering.visual.surfaces.surface import Size, Surface
from mimics_app.rendering.visual.view import View

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["Film", "draw_film", "film_place"]

_MAX_WAITING = 16
"""Largest number of pictures that wait for the thread."""
_MAX_GAP = 600
"""Largest number of frames for which a picture is repeated, after a halt of the run."""


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
        """Take a picture that is shown from frame `number` of the video on."""
        ...

    def close(self) -> None:
        """Finish."""
        ...


class Film:
    """Video of the pictures of a surface.

    Args:
        surface: The surface.
        wanted: The file, see `film_place`.
        live: True: no frame waits, and pictures without room in the queue are dropped and counted; False: none is
            dropped.

    Attributes:
        place: The file, or the folder of PNG files.
        dropped: Number of dropped pictures.
        problem: Why the video ends early, "" where it does not.
    """

    def __init__(self, surface: Surface, wanted: Path, *, live: bool) -> None:
        self.place, program = film_place(wanted)
        folder = self.place.parent if program else self.place
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(
                folder, f"no film can be written here: {error.strerror}", "give another --video"
            ) from None
        self._sink: _Sink = _Ffmpeg(program, self.place, surface.size) if program else _PngFolder(self.place)
        self._surface, self._live = surface, live
        self._reader = FrameReader(surface, 2 if live else 0)
        self._begun_ns: int | None = None
        self._queue: queue.Queue[ReadFrame | None] = queue.Queue(_MAX_WAITING)
        self._finished = False
        self.dropped = 0
        self.problem = ""
        self._thread = threading.Thread(target=self._write, name="film", daemon=True)
        self._thread.start()

    def take(self, t_ns: int) -> None:
        """Take the last picture, which is shown from a time on [ns]."""
        for frame in self._reader.take(t_ns):
            self._queue_frame(frame)

    def forget(self) -> None:
        """Drop the pictures that were not read yet, after a loss of the surface's context."""
        self._reader = FrameReader(self._surface, self._reader.behind)

    def finish(self) -> None:
        """Close the file and tell on stderr what is missing from it; further calls do nothing."""
        if self._finished:
            return
        self.close()
        if self.dropped or self.problem:
            what = self.problem or f"{self.dropped} pictures were dropped: this machine does not keep up"
            sys.stderr.write(f"mimics: film {self.place}: {what}\n")

    def close(self) -> None:
        """Write the waiting pictures and close the file."""
        self._finished = True
        for frame in self._reader.flush():
            self._queue_frame(frame)
        self._reader.release()
        self._queue.put(None)
        self._thread.join()

    def _queue_frame(self, frame: ReadFrame) -> None:
        if not self._live:
            self._queue.put(frame)
            return
        try:
            self._queue.put_nowait(frame)
        except queue.Full:
            self.dropped += 1

    def _write(self) -> None:
        """Run the thread until it gets None; after a fault it only empties the queue."""
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
            self.problem = str(error)  # the message of ffmpeg says more than a broken pipe


def draw_film(
    renderer: Renderer,
    surface: Surface,
    count: int,
    views: Callable[[int], Sequence[View]],
    wanted: Path,
    presenter: Presenter | None = None,
) -> FrameSet:
    """Draw frames into a video of 60 frames per second.

    Args:
        renderer: Renderer on `surface`.
        surface: The surface.
        count: Number of frames, >= 1.
        views: Called with the number of each frame before it is drawn: moves the world and returns the views.
        wanted: The file, see `film_place`.
        presenter: Presenter of the display, None for a plain picture.

    Raises:
        OutputError: The video cannot be written, or not to its end.
    """
    film, spent = Film(surface, wanted, live=False), []
    for number in range(count):
        spent.append(renderer.draw_finished(views(number)).cpu_ms)
        if presenter is not None:
            presenter.present()
        film.take(number * SECOND_NS // FRAMES_PER_SECOND)
    film.close()
    if film.problem:
        raise OutputError(film.place, film.problem, "free some space, or give another --video")
    return FrameSet([film.place], median(spent))


class _PngFolder:
    """One PNG file per picture, named by its frame at 60 Hz."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def add(self, number: int, frame: ReadFrame) -> None:
        _picture(frame).save(self._folder / f"frame_{number:06d}.png", compress_level=1)

    def close(self) -> None:
        """Do nothing: every file is closed already."""


class _Ffmpeg:
    """Pipe to ffmpeg at 60 frames per second; a picture shown longer is repeated."""

    def __init__(self, program: str, file: Path, size: Size) -> None:
        self._size = size
        self._written = 0
        self._last: bytes | None = None
        self._errors: IO[bytes] = tempfile.TemporaryFile()
        source = ["-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", f"{size[0]}x{size[1]}"]
        source += ["-framerate", str(FRAMES_PER_SECOND), "-i", "-"]
        # Pictures have their lowest row first, and most decoders need even sides.
        made = ["-an", "-vf", "vflip,pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-y", str(file)]
        command = [program, "-hide_banner", "-loglevel", "error", *source, *made]
        # In its own session, so that Ctrl-C ends the run, which closes the video, and not ffmpeg.
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._errors, start_new_session=True
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
            pass  # the message of ffmpeg follows
        if self._process.wait() != 0:
            self._errors.seek(0)
            message = self._errors.read().decode(errors="replace").split("\n")[0]
            raise ValueError(f"ffmpeg failed: {message}")

    def _repeat_until(self, number: int) -> None:
        """Write the newest picture for every frame before `number`."""
        assert self._process.stdin is not None
        times = min(number - self._written, _MAX_GAP)
        self._written = max(number, self._written)
        for _ in range(times if self._last is not None else 0):
            self._process.stdin.write(self._last or b"")


def _resized(frame: ReadFrame, size: Size) -> bytes:
    """Return the pixels of a picture in another size, lowest row first."""
    from PIL import Image

    return _picture(frame).resize(size).transpose(Image.Transpose.FLIP_TOP_BOTTOM).tobytes()


def _picture(frame: ReadFrame) -> Image.Image:
    """Return a picture with its highest row first."""
    from PIL import Image

    return Image.frombytes("RGB", frame.size, frame.pixels).transpose(Image.Transpose.FLIP_TOP_BOTTOM)
