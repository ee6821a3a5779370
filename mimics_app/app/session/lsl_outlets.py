"""Streams of a session for the lab streaming layer (`mimics run --lsl`): poses, forces, features, state and markers.

The frame appends what it has to a queue of fixed length and never waits; a thread of its own takes it from there and
calls the library. Time stamps are those of the session, moved to the clock of the layer by one offset that is measured
at the beginning: when that clock is set later, they continue in order.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.clock import FRAMES_PER_SECOND, SECOND_NS, Clock
from mimics_app.contracts.loop.haptic import EventKind
from mimics_app.contracts.loop.loop_fields import HapticSnapshot
from mimics_app.contracts.messages.stage_messages import Estimate, FeatureFrame, UserState
from mimics_app.contracts.version import __version__
from mimics_app.dsp.channel_kinds import feature_units
from mimics_app.inputs.physio.lsl import lsl_library
from mimics_app.recording.event_log import to_json

if TYPE_CHECKING:
    from pylsl import StreamInfo, StreamOutlet

__all__ = ["LslOutlets"]

_HOLDS_S = 10.0
"""Time for which the queue holds all data while the thread does not run [s]."""
_SAMPLES_A_FRAME = 8
"""Samples that a frame appends at most: four series and some markers."""
_WAIT_S = 0.5
"""Longest sleep of the thread [s]; an appended sample wakes it."""
_NOT_MARKED = frozenset({"frame", "features", "person"})
"""Lines of the journal that are samples of the other streams."""

_XYZ = ("x", "y", "z")
_POSE = (*_XYZ, "qx", "qy", "qz", "qw")
_STATE = ("arousal", "valence", "effort")
_LOADS = ("underchallenged", "challenged", "overchallenged")

Channels = Sequence[tuple[str, str]]


class LslOutlets:
    """The outlets of one session.

    Args:
        clock: Clock of the session.
        session: Name of the session, unique among all: its run folder.
        scene: Name of the scene.
        bodies: Names of the haptic bodies, whose poses are sent.
        simulated: Whether nobody plays.

    Attributes:
        sent: Samples that the thread has passed to the library.
        dropped: Samples for which the queue had no place.

    Raises:
        UsageError: pylsl is not installed.
    """

    def __init__(self, clock: Clock, session: str, scene: str, bodies: Sequence[str], *, simulated: bool) -> None:
        pylsl = self._pylsl = lsl_library()
        self._bodies = len(bodies)
        self._features = feature_units()
        self._about = {"session": session, "scene": scene, "program": f"mimics_app {__version__}"}
        self._about["person"] = "simulated" if simulated else "person"
        self._outlets = {
            "poses": self._open("poses", "MoCap", _pose_channels(bodies)),
            "forces": self._open("forces", "Force", _FORCE_CHANNELS),
            "features": self._open("features", "Features", list(self._features.items())),
            "state": self._open("state", "State", _state_channels()),
            "markers": self._open("markers", "Markers", [("marker", "")], rate=0.0),
        }
        self._offset_s = float(pylsl.local_clock()) - clock.now_ns() / SECOND_NS
        self._clock = clock
        self._last_state: dict[str, object] = {}
        self._joined = False
        self.sent = self.dropped = 0
        self._queue: deque[tuple[str, list[Any], float]] = deque()
        self._most = round(_HOLDS_S * FRAMES_PER_SECOND * _SAMPLES_A_FRAME)
        self._wake = threading.Event()
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="lsl", daemon=True)
        self._thread.start()

    def step(
        self, snapshot: HapticSnapshot, events: NDArray[Any], features: FeatureFrame, state: UserState, now_ns: int
    ) -> None:
        """Append the samples of a frame."""
        self._put("poses", _poses(snapshot, self._bodies), snapshot.t_ns)
        forces = [*snapshot.f_user_world, *snapshot.f_meas_world, snapshot.margin, snapshot.energy]
        self._put("forces", [float(value) for value in forces], snapshot.t_ns)
        values = features.values
        self._put("features", [float(values.get(name, np.nan)) for name in self._features], now_ns)
        self._put("state", _state_values(state), now_ns)
        for event in events:
            line = {"kind": EventKind(int(event["kind"])).name.lower(), "tick": int(event["tick"])}
            self._put("markers", [to_json({"source": "loop", **line}).decode()], int(event["t_ns"]))

    def mark(self, kind: str, data: Mapping[str, object]) -> None:
        """Append a line of the journal as a marker."""
        if kind in _NOT_MARKED:
            return
        t_ns = data.get("t_ns")
        line = {"source": "app", "kind": kind, **data}
        if kind == "state":
            self._last_state = line
        self._put("markers", [to_json(line).decode()], t_ns if isinstance(t_ns, int) else self._clock.now_ns())

    def close(self) -> Mapping[str, int]:
        """Send what is in the queue, end the thread, and return the numbers of samples sent and dropped."""
        self._ended = True
        self._wake.set()
        self._thread.join()
        return {"sent": self.sent, "dropped": self.dropped}

    def _put(self, stream: str, values: list[Any], t_ns: int) -> None:
        if len(self._queue) >= self._most:
            self.dropped += 1
            return
        self._queue.append((stream, values, t_ns / SECOND_NS + self._offset_s))
        self._wake.set()

    def _run(self) -> None:
        while True:
            self._wake.wait(_WAIT_S)
            self._wake.clear()
            self._greet()
            while self._queue:
                stream, values, stamp = self._queue.popleft()
                self._outlets[stream].push_sample(values, stamp)
                self.sent += 1
            if self._ended:
                return

    def _greet(self) -> None:
        """Repeat the present state of the task to whoever has just begun to listen: it was sent before."""
        joined = bool(self._outlets["markers"].have_consumers())
        if joined and not self._joined and self._last_state:
            line = {**self._last_state, "repeated": True}
            stamp = self._clock.now_ns() / SECOND_NS + self._offset_s
            self._outlets["markers"].push_sample([to_json(line).decode()], stamp)
        self._joined = joined

    def _open(self, name: str, kind: str, channels: Channels, rate: float = float(FRAMES_PER_SECOND)) -> StreamOutlet:
        pylsl = self._pylsl
        text = pylsl.cf_string if rate == 0.0 else pylsl.cf_double64
        source = f"mimics/{self._about['session']}/{name}"
        info = pylsl.StreamInfo(f"mimics_{name}", kind, len(channels), rate, text, source)
        _describe(info, self._about, channels)
        return pylsl.StreamOutlet(info)


_FORCE_CHANNELS: Channels = [
    *((f"force_on_user_{axis}", "N") for axis in _XYZ),
    *((f"measured_force_{axis}", "N") for axis in _XYZ),
    ("stability_margin", "1"),
    ("contact_energy", "J"),
]


def _describe(info: StreamInfo, about: Mapping[str, str], channels: Channels) -> None:
    """Write who sends, and label and unit of each channel."""
    sender = info.desc().append_child("acquisition")
    for name, value in about.items():
        sender.append_child_value(name, value)
    described = info.desc().append_child("channels")
    for label, unit in channels:
        channel = described.append_child("channel")
        channel.append_child_value("label", label)
        channel.append_child_value("unit", unit)


def _pose_channels(bodies: Sequence[str]) -> Channels:
    """Return the channels of the hand, in the frame of the world, and of each body: position, quaternion."""
    hand = [*((f"hand_{axis}", "m") for axis in _XYZ), *((f"hand_velocity_{axis}", "m/s") for axis in _XYZ)]
    return hand + [(f"{body}_{part}", "m" if part in _XYZ else "1") for body in bodies for part in _POSE]


def _poses(snapshot: HapticSnapshot, bodies: int) -> list[float]:
    found = [*snapshot.hip_world.tolist(), *snapshot.v_world.tolist()]
    return [float(value) for value in (*found, *snapshot.poses[:bodies].ravel().tolist())]


def _state_channels() -> Channels:
    """Return mean and variance of each quantity, the probabilities of the load, and the quality."""
    means = [(f"{name}{part}", "1") for name in _STATE for part in ("", "_variance")]
    return [*means, *((name, "1") for name in _LOADS), ("quality", "1")]


def _state_values(state: UserState) -> list[float]:
    estimates: list[Estimate | None] = [state.arousal, state.valence, state.effort]
    values = [value for each in estimates for value in ((each.mean, each.variance) if each else (np.nan, np.nan))]
    return [float(value) for value in (*values, *(state.load or (np.nan,) * len(_LOADS)), state.quality)]
