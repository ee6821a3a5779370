"""One run of a scene: the session is built and played, the recording closed, report and result written."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TextIO

from mimics_app.app.play.album import Album
from mimics_app.app.play.collector import frozen_objects
from mimics_app.app.play.journey_log import JourneyLog
from mimics_app.app.play.pace import run_live, run_unseen, run_virtual
from mimics_app.app.play.result import summarise
from mimics_app.app.play.summary_lines import summary_lines
from mimics_app.app.play.value_picture import ValuePicture
from mimics_app.app.session.assembly import build_session, start_loop
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.operator_link import OperatorLink
from mimics_app.app.session.session import Session
from mimics_app.app.settings import RunSettings
from mimics_app.app.terminal import output
from mimics_app.app.terminal.display import has_display
from mimics_app.app.terminal.progress import draw_bar
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError, MimicsError, PartialDataError, SafetyStop
from mimics_app.contracts.loop.haptic import SafetyState
from mimics_app.contracts.system.phrases import phrase
from mimics_app.recording.manifest import Manifest
from mimics_app.recording.orthosis_residual import residual_torques
from mimics_app.recording.report import write_report
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import private_files
from mimics_app.rendering.visual.surfaces.surface import Place, Surface
from mimics_app.tasks.kinds.registry import report_sections
from mimics_app.world.files.scene.scene import Scene

__all__ = ["ProgressLine", "open_live_window", "open_picture", "play"]

_STOPS = (SafetyState.SAFE_STOP.name, SafetyState.E_STOP.name)

_WHO_PLAYS = {False: "the simulated patient plays", True: "the person at the robot plays, without a picture"}
"""Who plays where no window can be opened, by whether the device runs in real time."""


_EVERY = 30
"""Period of the updates [frames]."""


def play(settings: RunSettings, *, as_json: bool, read: Scene | None = None) -> int:
    """Run a scene.

    Args:
        settings: Settings of the run.
        as_json: Whether the answer is one JSON object.
        read: The scene, where it was read before; see `prepare`.

    Returns:
        0; 4 where the picture was lost for good; 5 where the run ended in a latched stop; 6 where ticks were not
        recorded, or the report or the last picture could not be written.
    """
    started = MonotonicClock().now_ns()
    windowed = not settings.headless and has_display()
    log = JourneyLog(settings.journey)
    log.doing(phrase("Reading the scene"))
    with (
        private_files(),
        log.reporting(),
        build_session(settings, live=windowed, read=read) as session,
        _say_where_kept(session),
        _linked(session) as link,
        _marked(session),
        _sent_out(session),
    ):
        frames = Frames(session)
        if session.limit_notes:
            output.say(f"this scene goes beyond the usual limits: {'; '.join(session.limit_notes)}")
        if session.softened:
            output.say(f"softened, as this device cannot hold it: {'; '.join(session.softened)}")
        if not (windowed or settings.headless):
            sys.stderr.write(f"mimics: no display: {_WHO_PLAYS[session.live]}\n")
        if windowed:
            _play_in_window(session, frames, log, link)
            album = None
        elif session.live:
            album = _play_unseen(session, frames, link)
        else:
            album = _play_headless(session, frames, log)
        sound = session.end_stages()
        summary = summarise(session, frames, sound, (MonotonicClock().now_ns() - started) * 1e-9)
        manifest = session.finish(summary)
    log.doing(phrase("Writing the report"))
    pictures, all_written = _pictures(album)
    report, whole = _report(session, manifest)
    answer = {**summary, "state_hash": manifest.state_hash, "report": str(report or ""), "pictures": pictures}
    answer |= _resistance(session)
    if session.film is not None:
        answer["video"] = session.film
    if as_json:
        output.write_object("run", answer)
    else:
        print("\n".join(summary_lines(answer)), flush=True)
    log.recorded(session.folder)
    if summary["safety"]["state"] in _STOPS:
        return SafetyStop.exit_code
    if session.trouble:
        return DeviceError.exit_code
    return 0 if whole and all_written else PartialDataError.exit_code


def _pictures(album: Album | None) -> tuple[list[Path], bool]:
    """Return the saved pictures, and whether all could be saved. A loss is reported on stderr."""
    if album is None:
        return [], True
    try:
        return album.written(), True
    except OSError as error:
        sys.stderr.write(f"mimics: {error.filename}: {error.strerror}; the recording is complete without it\n")
        return [file for file in album.files if file.exists()], False


def _resistance(session: Session) -> dict[str, object]:
    """Return what a gait orthosis resisted to legs that swung freely; {} for any other run."""
    rms = residual_torques(Run.open(session.folder))
    return {"residual_torque_nm": rms} if rms else {}


def _report(session: Session, manifest: Manifest) -> tuple[Path | None, bool]:
    """Write the report; return it, and whether recording and report are complete. Losses are reported on stderr."""
    lost = manifest.dropped.get("samples", 0)
    if lost:
        sys.stderr.write(f"mimics: {session.folder}: {lost} ticks were not recorded; {_why(manifest)}\n")
    try:
        return write_report(session.folder, report_sections()), not lost
    except OSError as error:
        sys.stderr.write(f"mimics: the report cannot be written: {error.strerror}; mimics report {session.folder}\n")
        return None, False


def _why(manifest: Manifest) -> str:
    """Return the present problem of the disk, else the reasons for missing rows."""
    return manifest.problem or ", ".join(dict.fromkeys(str(gap["reason"]) for gap in manifest.gaps)) or "see its report"


@contextmanager
def _say_where_kept(session: Session) -> Iterator[None]:
    """Report where the recording of a run is that a signal or a fault of a plug-in ends: its report is not written."""
    try:
        yield
    except MimicsError:  # says itself what happened
        raise
    except BaseException:
        sys.stderr.write(f"mimics: broken off; mimics report {session.folder} shows what was recorded\n")
        raise


@contextmanager
def _linked(session: Session) -> Iterator[OperatorLink]:
    """Let the operator's page show a session that runs by the wall clock; it receives how the session ends."""
    link = OperatorLink(session, session.settings.operator_lost)
    try:
        yield link
    except Exception:
        link.close(orderly=False)
        raise
    finally:
        link.close(orderly=True)


@contextmanager
def _marked(session: Session) -> Iterator[None]:
    """Take commands from a stream of markers where that is requested."""
    if not session.settings.markers:
        yield
        return
    from mimics_app.inputs.commands.marker_stream import MarkerStream

    markers = MarkerStream(session.memory, session.settings.markers, session.clock, session.report)
    try:
        yield
    finally:
        markers.close()


@contextmanager
def _sent_out(session: Session) -> Iterator[None]:
    """Send a session to the lab streaming layer where that is requested; samples that it did not take are reported."""
    if not session.settings.lsl:
        yield
        return
    from mimics_app.app.session.lsl_outlets import LslOutlets
    from mimics_app.rendering.haptic.scene_objects import objects_of_scene

    bodies = list(objects_of_scene(session.scene).body_entities)
    simulated = bool(session.settings.headless)
    outlets = LslOutlets(session.clock, session.folder.name, session.scene.name, bodies, simulated=simulated)
    before = session.recorder.listener

    def listen(kind: str, data: Mapping[str, object]) -> None:
        before(kind, data)
        outlets.mark(kind, data)

    session.outlets, session.recorder.listener = outlets, listen
    try:
        yield
    finally:
        counts = outlets.close()
        if counts["dropped"]:
            output.say(
                f"{counts['dropped']} samples were not sent to the lab streaming layer: it did not take them in time"
            )


def _play_in_window(session: Session, frames: Frames, log: JourneyLog, link: OperatorLink) -> None:
    """Play in a window, with the live loop and the sound output."""
    from mimics_app.app.picture.window_opening import remember_size

    log.doing(phrase("Starting touch, sound and recording"))
    start_loop(session)
    log.doing(phrase("Making the picture"))
    surface = open_live_window(session, visible=not log.asked)
    if place := log.place:
        surface.move_to(Place.of(place)._replace(width=0, height=0))
    values = ValuePicture(session)

    def after_frame(frames: Frames) -> None:
        values.update(frames)
        link.after_frame(frames)
        if frames.number == 1 and log.asked:  # the page before it stays until there is a picture
            surface.show()
            log.shown()

    def before_dark() -> None:
        log.over([int(value) for value in surface.place or ()], closed=surface.should_close)

    session.before_dark = before_dark
    with frozen_objects():
        run_live(session, frames, after_frame)
    remember_size(surface)


def open_live_window(session: Session, *, visible: bool = True) -> Surface:
    """Open the window of a session whose loop runs, with its picture and the inputs of the person at it.

    Raises:
        DeviceError: There is no display.
    """
    from mimics_app.app.picture.shown_on import chosen_display
    from mimics_app.app.picture.window_opening import open_window
    from mimics_app.app.session.person_input import person_inputs

    kind = chosen_display(session.scene, session.settings.display).kind
    title = session.scene.title or session.scene.name
    # A headset has its own frame rate: its mirror in the window must not wait for the monitor.
    vsync = kind not in ("openxr", "sim-hmd")
    surface = open_window(session.settings.size, title, vsync=vsync, stereo=kind == "quad", visible=visible)
    open_picture(session, surface)
    session.inputs = person_inputs(session)
    return surface


def open_picture(session: Session, surface: Surface) -> None:
    """Draw the session on a surface from now on."""
    from mimics_app.app.picture.picture import Picture, live_quality
    from mimics_app.app.picture.shown_on import open_display

    settings, scene = session.settings, session.scene
    display = open_display(scene, settings.display, surface)
    drawn, full = display.drawn_size(surface.size), settings.quality == "full"
    quality = live_quality(scene, settings.profile, surface, drawn, full=full)
    session.recorder.journal("quality", asdict(quality))
    picture = Picture(surface, scene, session.world, quality, display=display)
    picture.keep_contact_shadow(scene)
    session.show(picture)


class ProgressLine:
    """A bar of the present trial.

    Args:
        stream: Stream to write to; nothing is written unless it is a terminal.
        session: The session, for its trials.
        log: Log for the beginning of every trial.
    """

    def __init__(self, stream: TextIO, session: Session, log: JourneyLog) -> None:
        self._stream = stream
        self._log = log
        self._trial = 0
        self._session = session
        self._shown = stream.isatty()

    def show(self, frames: Frames) -> None:
        """Report a new trial, and redraw the bar every half second."""
        view = frames.orders.view
        if self._trial < view.trial <= view.trials:
            self._trial = view.trial
            self._log.trial(view.trial, view.trials, self._session.tasks.plan[view.trial - 1].label)
        if not self._shown or frames.number % _EVERY:
            return
        seconds = self._session.clock.now_ns() * 1e-9
        self._stream.write(
            f"\rtrial {view.trial} / {view.trials} {draw_bar(view.progress)}  {seconds:6.1f} s simulated \x1b[K"
        )
        self._stream.flush()

    def end(self) -> None:
        """End the line."""
        if self._shown:
            self._stream.write("\n")


def _play_headless(session: Session, frames: Frames, log: JourneyLog) -> Album:
    """Let the simulated patient play on the virtual clock; only frames that are saved are drawn."""
    album, values = Album(session), ValuePicture(session)
    progress = ProgressLine(sys.stderr, session, log)

    def after_frame(frames: Frames) -> None:
        album.update(frames)
        values.update(frames)
        progress.show(frames)

    run_virtual(session, frames, after_frame)
    progress.end()
    album.finish(frames)
    return album


def _play_unseen(session: Session, frames: Frames, link: OperatorLink) -> Album:
    """Play without a window beside the live loop: with a device that runs in real time, or before an operator."""
    album = Album(session)
    start_loop(session)

    def after_frame(frames: Frames) -> None:
        album.update(frames)
        link.after_frame(frames)

    with frozen_objects():
        run_unseen(session, frames, after_frame, attended=lambda: link.attached)
    album.finish(frames)
    return album
