"""Keys for the picture of a live run (overlay, saved pictures, page of keys), and the end of a run that lost it."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from mimics_app.app.picture.force_arrows import ForceArrows
from mimics_app.app.picture.overlay_keys import toggle_overlay
from mimics_app.app.play.session_keys import OPERATORS_PAGE, task_page
from mimics_app.app.scenes.shipped import thumbnail_of
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.mover import mover_of
from mimics_app.app.session.session import Session
from mimics_app.contracts.clock import SECOND_NS
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.messages.stage_messages import TaskOrders
from mimics_app.contracts.messages.trial_state import TrialState
from mimics_app.contracts.system.phrases import phrase
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.visual.figures.key_page import KeyPage
from mimics_app.tasks.scene_section import task_of

if TYPE_CHECKING:
    from mimics_app.app.picture.governor import FrameGovernor
    from mimics_app.app.picture.picture import Picture

__all__ = ["ViewKeys", "rate_note"]

_KEEP, _KEYS, _LEAVE = "f12", "h", "escape"
_FIRST = (TrialState.APPROACH, TrialState.READY)
"""States of the first trial in which the page of the task is shown."""

_BEGIN = phrase("Enter, click or gamepad A: begin")
_ON_ITS_OWN = phrase("Begins on its own in a moment; Enter or click: now")
_COMES = phrase("One moment, please")
_RESUME = phrase("H: the operator's keys; once more: resume")


_RATED = 31
"""Number of frames whose rate is shown."""


class ViewKeys:
    """Handles the window's events once a frame."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._arrows = ForceArrows()
        self._kept = 0
        self._seen = deque[int](maxlen=_RATED)
        self._waits = mover_of(session.haptics.plugin) != "simulated"
        self._introduces = session.settings.journey is not None

    @cached_property
    def _page(self) -> KeyPage:
        return _page_of(self._session)

    def step(self, frames: Frames, governor: FrameGovernor | None = None) -> None:
        """Before a frame is drawn: switch layers of the overlay, save a picture, update arrows and frame rate."""
        picture, events = self._session.picture, self._session.inputs.frame.events
        if picture is None:
            return
        toggle_overlay(picture.renderer, events)
        pressed = {event.name for event in events if event.kind == "key" and event.pressed and not event.repeat}
        if _KEEP in pressed:
            self._keep()
        if _LEAVE in pressed:
            picture.page = None  # what Escape asks would be hidden by it
        self._show_pages(picture, frames.orders, asked=_KEYS in pressed)
        self._seen.append(self._session.clock.now_ns())
        if picture.renderer.shows("graph"):
            picture.renderer.overlay.note = rate_note(self._seen, () if governor is None else governor.lowered)
        if picture.renderer.shows("forces") and frames.snapshot is not None:
            now_ns = self._session.clock.now_ns()
            picture.renderer.overlay.arrows = self._arrows.of(frames.snapshot, frames.events, now_ns)

    def _show_pages(self, picture: Picture, orders: TaskOrders, *, asked: bool) -> None:
        """Show the page of the task before the first trial, later that and the operator's keys on request."""
        introduced, self._introduces = (
            self._introduces,
            (self._introduces and orders.view.state in _FIRST and not orders.board.count),
        )
        if introduced and not self._introduces:
            picture.page = None
        if asked:
            picture.page = self._next(picture.page)
        elif self._introduces and picture.page is not OPERATORS_PAGE:
            picture.page = self._introduction(orders)

    def _next(self, page: KeyPage | None) -> KeyPage | None:
        """Return the page after one: of the task, of the operator, none."""
        if page is None:
            return replace(self._page, foot=_RESUME)
        return None if page is OPERATORS_PAGE else OPERATORS_PAGE

    def _introduction(self, orders: TaskOrders) -> KeyPage:
        """Return the page of the task; its foot is the task's line where something else comes first, as a drive."""
        if not orders.view.reading or orders.view.paused:
            return replace(self._page, foot=orders.board.message or _COMES)
        return replace(self._page, foot=_BEGIN if self._waits else _ON_ITS_OWN)

    def end_without_picture(self, error: MimicsError) -> None:
        """Report that the picture is lost, and let the session end in order."""
        session = self._session
        session.trouble = f"the picture is lost: {error}"
        session.recorder.journal("picture", {"lost": str(error)})
        sys.stderr.write(f"mimics: {session.trouble}; the run ends here\n")
        if session.picture is not None:
            session.picture.abandon()
            session.picture = None

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


def _page_of(session: Session) -> KeyPage:
    """Return the page of the task of a session, without its foot."""
    scene, plugin = session.scene, session.haptics.plugin
    words = task_of(scene).instructions or scene.description
    limb = (plugin.descriptor or HAPTICMASTER).contacts[0]
    picture = thumbnail_of(scene.name)
    return task_page(scene.title or scene.name, words, mover_of(plugin), limb, picture if picture.is_file() else None)


def rate_note(seen_ns: Sequence[int], lowered: Sequence[str]) -> str:
    """Return the frames per second, from the times of the newest frames [ns], and what was lowered for them."""
    span_ns = seen_ns[-1] - seen_ns[0] if len(seen_ns) > 1 else 0
    rate = f"{(len(seen_ns) - 1) * SECOND_NS / span_ns:.0f} frames per second" if span_ns > 0 else ""
    last = {label.rpartition(" ")[0]: label for label in lowered}  # of a step with several levels the lowest
    lowered = f"lowered: {', '.join(last.values())}" if last else "full quality"
    return "; ".join(part for part in (rate, lowered) if part)
