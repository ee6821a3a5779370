"""A session's side of the operator's page: it offers its memory, publishes its state, and notices a lost operator."""

from __future__ import annotations

import os
import socket
from collections import deque
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.app.picture.around_hand import AROUND
from mimics_app.app.scenes.person_edit import plain_edit
from mimics_app.app.session.frame import Frames
from mimics_app.app.session.operator_status import status_of, trial_line
from mimics_app.app.session.state_mirror import StateMirror
from mimics_app.console.handover import VERSION, Lines, SessionCard, Slider, send_line
from mimics_app.console.meeting_place import MeetingPlace, has_unix_sockets
from mimics_app.contracts.clock import SECOND_NS, Clock, MonotonicClock
from mimics_app.contracts.commands.command_records import CommandSource
from mimics_app.contracts.commands.vocabulary import Pause, Stop
from mimics_app.contracts.loop.device_faults import FAULT_WORDS
from mimics_app.contracts.messages.mirror_frame import write_frame
from mimics_app.contracts.messages.stage_messages import SignalBlock
from mimics_app.contracts.shared_memory.command_ring import CommandSender
from mimics_app.contracts.shared_memory.newest_bytes import NewestWriter
from mimics_app.contracts.shared_memory.ring_history import HistoryWriter
from mimics_app.contracts.shared_memory.session_memory import SIGNAL_SAMPLE, AttendanceWord
from mimics_app.dsp.channel import Event
from mimics_app.dsp.stage import PhysioDsp
from mimics_app.recording.event_log import to_json

if TYPE_CHECKING:
    from mimics_app.app.session.session import Session

__all__ = ["OperatorLink"]

_SEEK_NS = SECOND_NS
"""Period in which a page is sought [ns]."""
_STATUS_FRAMES = 3
"""Frames between two states that are published: what changes faster is read from the samples."""
_LOST_NS = 2 * SECOND_NS
"""Time without an operator after which one counts as lost [ns]: a page that is reloaded is back earlier."""
_KEPT_EVENTS, _KEPT_TRIALS = 60, 40
"""Newest entries of each list in the published state."""
_UNSHOWN = {"frame", "features", "person", "choice", "result", "sound", "tactile"}
"""Kinds of lines of the journal that are not in the page's log: what they say is in the state."""
_EVENT = 1
"""Kind of a `SIGNAL_SAMPLE` that marks an event, such as an R peak."""
_BODY_SIGNALS = ("ecg", "gsr", "emg", "resp")
_LOST_WORDS = {"pause": "the task is paused", "stop": "the force is stopped", "continue": "the session continues"}


class OperatorLink:
    """Link of one session; made before its first `Frames`, whose reports it passes on too.

    Args:
        session: The session.
        lost: What a lost operator leads to: "continue", "pause" or "stop".
    """

    def __init__(self, session: Session, lost: str) -> None:
        memory = session.memory
        self._session, self._lost = session, lost
        self._clock: Clock = MonotonicClock()  # the page lives by it, also beside a session on the virtual clock
        self._line: socket.socket | None = None
        self._lines: Lines | None = None
        self._next_seek_ns = 0
        self._status = NewestWriter(memory.status_words, memory.status)
        self._signals = HistoryWriter(memory.signal_words, memory.signal_samples)
        self._mirror = StateMirror(session.world)
        self._mirrored = NewestWriter(memory.mirror_words, memory.mirror)
        self._sender = CommandSender(memory, CommandSource.ATTENDANCE, "session")
        self._names = {name: i for i, name in enumerate(_BODY_SIGNALS)} if session.settings.physio else {}
        self._first_ns: dict[str, int] = {}
        self._events: deque[dict[str, Any]] = deque(maxlen=_KEPT_EVENTS)
        self._trials: deque[dict[str, Any]] = deque(maxlen=_KEPT_TRIALS)
        self._numbers = {"event": 0, "trial": 0}
        self._newest: dict[str, Mapping[str, object]] = {}
        self._seen_ns: int | None = None
        self._noted_view = ""
        self._hand = np.zeros(3)
        self._report = session.report
        session.report = self._say
        session.recorder.listener = self._note
        if session.settings.despite:
            session.recorder.journal("override", {"despite": session.settings.despite})
        if isinstance(session.dsp, PhysioDsp):
            session.dsp.on_event = self._mark

    @property
    def attached(self) -> bool:
        """Whether a page shows this session."""
        return self._line is not None

    def after_frame(self, frames: Frames) -> None:
        """Publish what is new after a frame; look for a page where none is attached."""
        now_ns = self._clock.now_ns()
        self._check(now_ns)
        if self._line is None:
            return
        self._watch_operator(now_ns)
        if frames.snapshot is not None:
            self._hand = frames.snapshot.hip_world
        self._mirror_state(frames)
        self._put_signals(frames.signals)
        self._copy_picture()
        self._watch_second_view()
        if frames.number % _STATUS_FRAMES == 0:
            entries = {"events": list(self._events), "trials": list(self._trials)}
            state = status_of(self._session, frames, self._newest) | {"second_view": self._second_view}
            self._status.write(to_json({**state, **entries}))

    def close(self, *, orderly: bool) -> None:
        """Leave the page, which says whether the session ended as it should."""
        if self._line is None or self._lines is None:
            return
        if orderly:
            send_line(self._line, {"kind": "ended"})
        self._lines.close()
        self._line = self._lines = None

    # the page

    def _check(self, now_ns: int) -> None:
        """Notice that the page is gone, and look for one once a second."""
        if self._lines is not None:
            self._lines.take()
            if self._lines.ended:
                self.close(orderly=False)
        if self._line is None and now_ns >= self._next_seek_ns:
            self._next_seek_ns = now_ns + _SEEK_NS
            self._seek()

    def _seek(self) -> None:
        place = MeetingPlace().socket
        if not (has_unix_sockets() and place.exists()):
            return
        line = socket.socket(socket.AF_UNIX)
        line.setblocking(False)
        try:
            line.connect(str(place))
        except OSError:
            line.close()
            return
        self._line, self._lines = line, Lines(line)
        memory = self._session.memory
        if not send_line(line, {"kind": "session", "card": self._card()}, memory.segment.descriptor):
            self.close(orderly=False)

    def _card(self) -> SessionCard:
        session = self._session
        return SessionCard(
            version=VERSION,
            size=session.memory.segment.size,
            capacities=session.memory.capacities,
            pid=os.getpid(),
            scene=session.scene.name,
            title=session.scene.title or session.scene.name,
            folder=session.folder.name,
            device=session.haptics.plugin.name,
            simulated=session.haptics.plugin.simulated,
            participant=session.settings.participant,
            scene_hash=session.scene.hash,
            has_policy=session.has_policy,
            lost=self._lost,
            sliders=[
                Slider(each.name, each.low, each.high, each.step, each.unit, each.rate == 0.0, each.kind)
                for each in session.tasks.parameters
            ],
            views=session.views,
            second_views=self._second_views,
            faults=FAULT_WORDS if session.haptics.plugin.simulated else {},
            signals=list(self._names),
            edit=plain_edit(session.scene),
        )

    # the operator

    def _watch_operator(self, now_ns: int) -> None:
        """Follow the setting where an operator was there and is not any more, or the page makes no passes."""
        words = self._session.memory.attendance
        alive = now_ns - int(words[AttendanceWord.PASS_NS]) < _LOST_NS
        if alive and words[AttendanceWord.OPERATORS]:
            self._seen_ns = now_ns
        elif self._seen_ns is not None and now_ns - self._seen_ns > _LOST_NS:
            self._lose(self._session.clock.now_ns())

    def _lose(self, now_ns: int) -> None:
        self._seen_ns = None
        self._session.recorder.journal("operator", {"t_ns": now_ns, "lost": True, "leads_to": self._lost})
        self._say(f"the operator's page is lost; {_LOST_WORDS[self._lost]}")
        if self._lost == "pause":
            self._sender.send(Pause(), now_ns)
        elif self._lost == "stop":
            self._sender.send(Stop(), now_ns)

    # what the page shows

    def _say(self, text: str) -> None:
        self._report(text)
        self._add_event("report", text, self._session.clock.now_ns())

    def _note(self, kind: str, data: Mapping[str, object]) -> None:
        """Take a line of the journal, or the row of a trial."""
        if kind == "trial":
            self._numbers["trial"] += 1
            self._trials.append({"n": self._numbers["trial"], **trial_line(data)})
        elif kind in _UNSHOWN:
            self._newest[kind] = data
        else:
            self._add_event(kind, data, self._session.clock.now_ns())

    def _add_event(self, kind: str, what: object, now_ns: int) -> None:
        self._numbers["event"] += 1
        self._events.append({"n": self._numbers["event"], "t_ns": now_ns, "kind": kind, "what": what})

    def _copy_picture(self) -> None:
        """Let the picture, which may open after the first frames, be copied while a page shows it."""
        picture, memory = self._session.picture, self._session.memory
        if picture is None or picture.copies:
            return
        from mimics_app.app.picture.operator_picture import OperatorPicture
        from mimics_app.app.picture.second_view import SecondView

        first = NewestWriter(memory.picture_words, memory.picture)
        second = NewestWriter(memory.second_picture_words, memory.second_picture)
        picture.copies = [
            OperatorPicture(picture.surface, first, lambda: self._watched),
            SecondView(picture.surface, picture.renderer, second, lambda: self._second_view, lambda: self._hand),
        ]

    @property
    def _watched(self) -> bool:
        return self.attached and bool(self._session.memory.attendance[AttendanceWord.WATCHERS])

    def _watch_second_view(self) -> None:
        """Note which view is drawn beside the person's picture: it takes time of the frames."""
        if (view := self._second_view) != self._noted_view:
            self._noted_view = view
            self._session.recorder.journal("second_view", {"t_ns": self._session.clock.now_ns(), "view": view})

    @property
    def _second_view(self) -> str:
        """Name of the view that a page shows beside the person's picture; "": none."""
        number = int(self._session.memory.attendance[AttendanceWord.SECOND_VIEW]) - 1
        return self._second_views[number] if self._watched and 0 <= number < len(self._second_views) else ""

    @property
    def _second_views(self) -> list[str]:
        return [*self._session.views, *AROUND]

    def _mirror_state(self, frames: Frames) -> None:
        """Publish the scene as it is now, while a second display follows it."""
        now_ns = self._session.clock.now_ns()
        self._mirror.listen(frames, now_ns)
        if self._session.memory.attendance[AttendanceWord.MIRRORS]:
            self._mirrored.write(write_frame(self._mirror.frame(frames, now_ns)))

    def _put_signals(self, blocks: tuple[SignalBlock, ...]) -> None:
        for block in blocks:
            if block.name not in self._names or not len(block.values):
                continue
            self._first_ns.setdefault(block.name, block.t_ns)
            rows = np.zeros(len(block.values), SIGNAL_SAMPLE)
            rows["t_ns"] = block.t_ns + (np.arange(len(rows)) * (SECOND_NS / block.rate)).astype(np.int64)
            rows["value"], rows["signal"] = block.values, self._names[block.name]
            self._signals.append(rows)

    def _mark(self, name: str, event: Event) -> None:
        """Mark an event that the signal processing found, such as an R peak."""
        if name not in self._first_ns:  # in its very first block
            return
        row = np.zeros(1, SIGNAL_SAMPLE)
        row["t_ns"] = self._first_ns[name] + round(event.t_s * SECOND_NS)
        row["value"], row["signal"], row["kind"] = event.value, self._names[name], _EVENT
        self._signals.append(row)
