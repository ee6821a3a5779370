"""Keys for the picture of a live run (overlay, saved pictures, page of keys), and the end of a run that lost it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from mimics_app.app.picture.force_arrows import ForceArrows
from mimics_app.app.picture.overlay_keys import toggle_overlay
from mimics_app.app.play.session_keys import session_keys
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.session import Session
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.messages import TaskOrders
from mimics_app.contracts.trial_state import TrialState

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["ViewKeys"]

_KEEP, _KEYS = "f12", "h"
_FIRST = (TrialState.APPROACH, TrialState.READY)
"""States of the first trial in which the overlay lists the keys."""

_BEGIN = ("Enter or click", "begin")


class ViewKeys:
    """Handles the window's events once a frame."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._arrows = ForceArrows()
        self._kept = 0
        self._page = session_keys(session.haptics.plugin)
        self._introduces = session.window is not None

    def step(self, frames: Frames) -> None:
        """Before a frame is drawn: switch layers of the overlay, save a picture, update the arrows of forces."""
        picture, events = self._session.picture, self._session.inputs.frame.events
        if picture is None:
            return
        toggle_overlay(picture.renderer, events)
        pressed = {event.name for event in events if event.kind == "key" and event.pressed and not event.repeat}
        if _KEEP in pressed:
            self._keep()
        self._show_keys(picture, frames.orders, asked=_KEYS in pressed)
        if picture.renderer.shows("forces") and frames.snapshot is not None:
            now_ns = self._session.clock.now_ns()
            picture.renderer.overlay.arrows = self._arrows.of(frames.snapshot, frames.events, now_ns)

    def _show_keys(self, picture: Picture, orders: TaskOrders, *, asked: bool) -> None:
        """Show the page of keys: before the first trial automatically, later on request."""
        if self._introduces:
            view = orders.view
            picture.keys = (*self._page, _BEGIN) if view.reading else self._page
            self._introduces = view.state in _FIRST and not orders.board.count and not asked
            if not self._introduces:
                picture.keys = ()
        elif asked:
            picture.keys = () if picture.keys else self._page

    def end_without_picture(self, error: MimicsError) -> None:
        """Report that the picture is lost, and let the session end in order."""
        session = self._session
        session.trouble = f"the picture is lost: {error}"
        session.recorder.journal("picture", {"lost": str(error)})
        sys.stderr.write(f"mimics: {session.trouble}; the run ends here\n")
        if session.picture is not None:
            session.picture.abandon()
            session.picture = session.window = None

    def _keep(self) -> None:
        """Write the displayed frame into the run folder."""
        picture = self._session.picture
        assert picture is not None
        self._kept += 1
        folder = self._session.folder / "pictures"
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / f"kept_{self._kept:03d}.png"
        picture.save(file)
        sys.stderr.write(f"mimics: picture {file}\n")
