"""Pictures that a headless run draws and saves, and its video; the renderer is created at the first of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS
from mimics_app.contracts.messages.trial_state import TaskView, TrialState

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

    from mimics_app.app.picture.picture import Picture

__all__ = ["Album"]


class Album:
    """Saves pictures at moments spread evenly over the trials. A video has every frame.

    The duration of a trial is unknown, so a moment is a share of the trials, the present one counted by its progress,
    or a share of the run's length where that was requested, whichever comes first.

    Attributes:
        files: Files of the pictures; the last may still be written.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._folder = session.folder / "pictures"
        self._wanted = session.settings.pictures
        self.files: list[Path] = []
        self._kept = 0
        self._first_trial: int | None = None
        self._writer: ThreadPoolExecutor | None = None
        self._writing: Future[None] | None = None

    def update(self, frames: Frames) -> None:
        """Draw this frame if it is due or a video is made."""
        due = self._kept < self._wanted and self._is_due(frames)
        if due or self._session.settings.video is not None:
            self._draw(frames, keep=due)

    def finish(self, frames: Frames) -> None:
        """Draw the last frame where the run was too short for any other."""
        if not self.files and self._wanted > 0 and frames.number > 0:
            self._draw(frames, keep=True)

    def written(self) -> list[Path]:
        """Return the files once they are written.

        Raises:
            OSError: The last one cannot be written; the others are.
        """
        if self._writer is not None:
            self._writer.shutdown()
            self._wait()
        return self.files

    def _is_due(self, frames: Frames) -> bool:
        run_s, share = self._session.settings.seconds, (self._kept + 0.5) / self._wanted
        if run_s is not None and frames.number >= share * run_s * FRAMES_PER_SECOND:
            return True
        return self._share_of_trials(frames.orders.view) >= share

    def _share_of_trials(self, view: TaskView) -> float:
        """Return the share of the trials that are done; 0 where none is under way."""
        if view.state is not TrialState.TRAVEL:
            return 0.0
        if self._first_trial is None:
            self._first_trial = view.trial
        return (view.trial - self._first_trial + view.progress) / (view.trials - self._first_trial + 1)

    def _draw(self, frames: Frames, *, keep: bool) -> None:
        picture = self._session.picture or self._open()
        picture.draw(frames.board, frames.number * SECOND_NS // FRAMES_PER_SECOND)
        if picture.film is not None:
            picture.film.take(frames.number * SECOND_NS // FRAMES_PER_SECOND)
        if keep:
            self._folder.mkdir(parents=True, exist_ok=True)
            file = self._folder / f"frame_{frames.number:06d}.png"
            self._kept += 1
            self.files += picture.save(file, self._write)

    def _write(self, pixels: NDArray[np.uint8], file: Path) -> None:
        """Compress and write a picture in another thread; at most one is pending."""
        from concurrent.futures import ThreadPoolExecutor

        from mimics_app.rendering.visual.surfaces.headless import write_png

        self._wait()
        self._writer = self._writer or ThreadPoolExecutor(1, "pictures")
        self._writing = self._writer.submit(write_png, pixels, file)

    def _wait(self) -> None:
        if self._writing is not None:
            self._writing.result()

    def _open(self) -> Picture:
        from mimics_app.app.picture.picture import Picture, picture_quality
        from mimics_app.app.picture.shown_on import open_display
        from mimics_app.rendering.visual.surfaces.headless import open_offscreen

        session = self._session
        surface = open_offscreen("auto", session.settings.picture_size)
        quality = picture_quality(session.scene, session.settings.profile)
        display = open_display(session.scene, session.settings.display, surface)
        sparse = session.settings.video is None
        picture = Picture(surface, session.scene, session.world, quality, display=display, sparse=sparse)
        session.show(picture)
        return picture
