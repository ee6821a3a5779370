"""Loops of frames: on the virtual clock as fast as possible, or beside the live haptic loop at 60 Hz."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from mimics_app.app.picture.governor import FrameGovernor
from mimics_app.app.picture.held_quality import held_quality, measure_frame_ms, name_of_picture
from mimics_app.app.picture.nudges import nudges_of
from mimics_app.app.planner.tolerances import tolerances_of
from mimics_app.app.play.reload import SceneReload
from mimics_app.app.play.view_keys import ViewKeys
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.safety_watch import hold_message
from mimics_app.app.session.session import Session
from mimics_app.app.session.watches import DeviceWatch
from mimics_app.contracts.clock import FRAME_NS, SECOND_NS
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.rendering.visual.quality_steps import quality_steps, rehearse_steps

__all__ = ["LiveFrames", "run_live", "run_unseen", "run_virtual"]

_FEWEST_FRAMES = 120
"""Smallest number of frames of a run whose quality is kept for the next one."""

_LINGER_NS = 3_000_000_000
"""Time for which the last line of a task is shown before the session ends [ns]."""

_LATCHED = (SafetyState.SAFE_STOP, SafetyState.E_STOP)

Progress = Callable[[Frames], None]


def run_virtual(session: Session, frames: Frames, after_frame: Progress) -> None:
    """Run ticks and frames in a fixed pattern on the virtual clock.

    The run ends when the task is done, the time is over, or a command ends it. A latched stop ends it too unless
    commands of a file follow, since no person can reset it.
    """
    limit = _limit_ns(session)
    while not (session.tasks.done or frames.desk.ended) and session.clock.now_ns() < limit:
        frames.advance_frame()
        after_frame(frames)
        if frames.snapshot is not None and frames.snapshot.state in _LATCHED and not session.timed_commands.waiting:
            return


def run_live(
    session: Session, frames: Frames, after_frame: Progress, until: Callable[[], bool] = lambda: False
) -> None:
    """Run frames beside the live loop until the person leaves, the task is done, the run's time is over, or `until`.

    The end of the haptic loop ends the run too; the stop of the session then reports the reason. So does the loss of
    the picture.
    """
    live = LiveFrames(session)
    live.run(frames, after_frame, until)
    live.end()


def _draw_once(session: Session) -> None:
    """Draw a frame of each view, the present one last, before the task's clock begins.

    Compilation and upload take up to seconds, and the first switch to a view would wait for what only that one shows.
    """
    if session.picture is None:
        return
    for views in (*session.picture.each_view(), session.picture.views):
        session.picture.renderer.draw_finished(views)


class LiveFrames:
    """Frames of a session beside its live loop, with a picture or without.

    Args:
        session: The session; its loop runs.

    Attributes:
        over: Whether the session ends: by the person, its task, its time, the loss of its picture or its loop.
    """

    def __init__(self, session: Session) -> None:
        governor = session.governor = _govern(session)
        self._session, self._governor = session, governor
        self._name = _start_lower(session, governor) if governor is not None and governor.steps else ""
        _draw_once(session)
        self._keys, self._leaving = ViewKeys(session), _Leaving(session)
        self._reload, self._watch = SceneReload(session), DeviceWatch(session.haptics.plugin, session.recorder)
        self._limit = session.clock.now_ns() + _limit_ns(session)
        self.over = False

    def run(self, frames: Frames, after_frame: Progress, until: Callable[[], bool] = lambda: False) -> None:
        """Run frames at their times until `until`, or the session is over."""
        session = self._session
        due = session.clock.now_ns()
        while not (self._is_over(frames) or until()):
            if not self._frame(frames):
                self.over = True
                return
            after_frame(frames)
            due = max(due + _period_ns(session), session.clock.now_ns() - FRAME_NS)
            session.clock.sleep_until_ns(due)

    def end(self) -> None:
        """Keep the quality that the picture held, for the next session."""
        governor = self._governor
        if self._name and governor is not None and governor.frames >= _FEWEST_FRAMES:
            held_quality().keep(self._name, governor.held)

    def _is_over(self, frames: Frames) -> bool:
        session = self._session
        ended = session.clock.now_ns() >= self._limit or not session.haptics.running
        self.over = ended or self._leaving.wanted(frames)
        return self.over

    def _frame(self, frames: Frames) -> bool:
        """Do a frame and show it; return False where the picture is lost for good."""
        session, picture, governor = self._session, self._session.picture, self._governor
        begun_ns = session.clock.now_ns()
        if picture is not None:
            frames.timer = picture.begin_frame()
            frames.timing = picture.expect(begun_ns)
        with frames.timer.stage("reload"):
            self._reload.check(between=frames.orders.view.between_trials)
        frames.step()
        trouble = self._watch.check()
        if picture is not None and governor is not None:
            self._keys.step(frames, governor)
            message = session.keys.message or _message(session, frames, self._reload, trouble)
            try:
                done_ns = picture.show_frame(frames.board.saying(message), session.clock)
            except DeviceError as error:
                self._keys.end_without_picture(error)
                return False
            picture.shown(begun_ns, session.clock.now_ns())
            governor.note((done_ns - begun_ns) * 1e-6, done_ns)
        return True


def _period_ns(session: Session) -> int:
    """Return the period of the frames [ns]: that of a headset, else 60 Hz."""
    return FRAME_NS if session.picture is None else session.picture.presenter.timing.period_ns or FRAME_NS


def _govern(session: Session) -> FrameGovernor | None:
    """Return the governor of a live picture; all steps are fixed in a study and with `--quality full`."""
    if session.picture is None:
        return None
    steps = quality_steps(session.picture.renderer)
    settings = session.settings
    fixed = {step.name for step in steps} if settings.profile == "study" or settings.quality == "full" else ()
    budget_ms = tolerances_of(session.scene, settings.profile)["frame_ms"]
    return FrameGovernor(steps, budget_ms, fixed=fixed, log=session.recorder.journal)


def _start_lower(session: Session, governor: FrameGovernor) -> str:
    """Start at the quality that this picture held in its last run on this machine, else at one that fits now.

    Returns:
        The name under which the quality is kept.
    """
    assert session.picture is not None
    name = name_of_picture(session.picture, session.scene.path.stem, session.settings.profile)
    known = held_quality().find(name)
    frame_ms = partial(measure_frame_ms, session.picture, nudges_of(session.scene, session.world))
    rehearse_steps(session.picture.renderer, session.picture.views)
    if known is not None and governor.start_from(known):
        governor.prove_last(frame_ms)
    else:
        governor.stabilise(frame_ms)
    return name


def run_unseen(session: Session, frames: Frames, after_frame: Progress, attended: Callable[[], bool]) -> None:
    """Run frames beside the live loop without a window, until the task is done or the run's time is over.

    A latched stop ends a run without a time limit and without an operator, since no person can reset it.

    Args:
        session: The session; its loop runs.
        frames: Its frames.
        after_frame: Called after each.
        attended: Whether an operator's page is attached.
    """
    watch = DeviceWatch(session.haptics.plugin, session.recorder)
    limit = session.clock.now_ns() + _limit_ns(session)
    due = session.clock.now_ns()
    while session.clock.now_ns() < limit and session.haptics.running and not (session.tasks.done or frames.desk.ended):
        frames.step()
        after_frame(frames)
        watch.check()
        latched = frames.snapshot is not None and frames.snapshot.state in _LATCHED
        if latched and session.settings.seconds is None and not attended():
            return
        due = max(due + FRAME_NS, session.clock.now_ns() - FRAME_NS)
        session.clock.sleep_until_ns(due)


def _message(session: Session, frames: Frames, reload: SceneReload, trouble: str) -> str:
    """Return the message over the picture: of the device, the recorder, a hold, or else a reload."""
    held = "" if frames.snapshot is None else hold_message(frames.snapshot.state)
    return trouble or session.recorder.problem or held or reload.message


def _limit_ns(session: Session) -> int:
    seconds = session.settings.seconds
    return 1 << 62 if seconds is None else round(seconds * SECOND_NS)


class _Leaving:
    """Checks once a frame whether the session ends: by a command, with the window, or after the task."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._done_ns: int | None = None

    def wanted(self, frames: Frames) -> bool:
        """Whether the session ends now."""
        session = self._session
        if session.picture is not None and session.picture.leaving:
            return True
        return frames.desk.ended or self._is_over(session.clock.now_ns())

    def _is_over(self, now_ns: int) -> bool:
        """Whether the last line of a task that is done has been shown long enough."""
        if not self._session.tasks.done:
            return False
        self._done_ns = self._done_ns or now_ns
        return now_ns - self._done_ns > _LINGER_NS
