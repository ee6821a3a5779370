"""A robot of paper: obeys a task manager's orders at once and travels the tunnel at a given speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mimics_app.contracts.commands.vocabulary import Command
from mimics_app.contracts.loop.controller_slots import Slot
from mimics_app.contracts.loop.haptic import EVENT, EventKind, SafetyState, TripCause
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskAction, TaskOrders, VRInput
from mimics_app.contracts.messages.trial_state import TaskView
from mimics_app.contracts.ports.scenario_port import TaskContext
from mimics_app.inputs.commands.keys import command_of_key
from mimics_app.tasks.steering import TASK_COMMANDS
from mimics_app.tasks.task_manager import TaskManager

START = (0.01, -0.2, 0.05)
FRAME_NS = 16_666_667


def make_snapshot(now_ns: int = 0, **changes: Any) -> HapticSnapshot:
    values: dict[str, Any] = {
        "tick": now_ns // 1_000_000,
        "t_ns": now_ns,
        "state": int(SafetyState.ACTIVE),
        "cause": int(TripCause.NONE),
        "hip_world": np.zeros(3),
        "v_world": np.zeros(3),
        "f_user_world": np.zeros(3),
        "f_meas_world": np.zeros(3),
        "q": np.array(START),
        "grasp": 0.0,
        "ball_radius": 0.02,
        "progress": 0.0,
        "distance": 0.0,
        "penetration": 0.0,
        "f_grip": np.zeros(3),
        "partners": 0,
        "held_body": -1,
        "crushed_body": -1,
        "ramp": 1.0,
        "margin": 2.0,
        "energy": 0.0,
        "stiffness_share": 1.0,
        "calm": 1.0,
        "wall_force": 0.0,
        "wall_normal": np.zeros(3),
        "force_peak": 0.0,
        "distance_peak": 0.0,
        "progress_peak": 0.0,
        "own_work": 1.0,
        "quiet_ticks": 1000,
        "phase": 0.0,
        "gait_state": -1,
        "free_leg": -1,
        "belt_travel": 0.0,
        "left_strikes": -1,
        "right_strikes": -1,
        "torque_meas": np.zeros(len(START)),
        "poses": np.zeros((0, 7)),
    }
    return HapticSnapshot(**(values | changes))


def make_events(*rows: tuple[int, EventKind, float]) -> np.ndarray:
    """EVENT records of (t_ns, kind, force)."""
    events = np.zeros(len(rows), EVENT)
    for i, (t_ns, kind, force) in enumerate(rows):
        events[i]["t_ns"], events[i]["kind"], events[i]["force"] = t_ns, kind, force
    return events


@dataclass
class Player:
    """Plays a task frame by frame from time 0.

    Attributes:
        speed: Share of the tunnel travelled per second while the person may act.
        change: Changes of the snapshot by frame number, e.g. a safety stop.
    """

    manager: TaskManager
    speed: float = 0.25
    change: Callable[[int, Player], dict[str, Any]] = lambda frame, player: {}
    frame: int = 0
    now_ns: int = 0
    progress: float = 0.0
    peaks: dict[str, float] = field(default_factory=dict)
    q: np.ndarray = field(default_factory=lambda: np.zeros(3))
    scene: dict[str, Any] = field(default_factory=dict)
    states: list[str] = field(default_factory=list)
    orders: list[TaskOrders] = field(default_factory=list)

    def step(
        self,
        *rows: tuple[int, EventKind, float],
        action: TaskAction | None = None,
        pressed: tuple[str, ...] = (),
        commands: tuple[Command, ...] = (),
        frame_ns: int = FRAME_NS,
        **changes: Any,
    ) -> TaskOrders:
        values = {"q": self.q.copy(), "progress": self.progress} | self.change(self.frame, self) | changes
        snapshot = make_snapshot(self.now_ns, **self._with_peaks(values))
        view = self.orders[-1].view if self.orders else TaskView()
        keyed = [command_of_key(name, view) for name in pressed]
        commands = (*commands, *(command for command in keyed if isinstance(command, TASK_COMMANDS)))
        vr = VRInput(pressed=pressed, commands=commands)
        orders = self.manager.step(vr, action, snapshot, make_events(*rows), self.now_ns)
        self.scene.update({str(field): value for field, value in orders.haptic.numbers.items()})
        if self.scene["controller"] in (Slot.HOLD, Slot.START):
            self.q = np.array(self.scene["target"], float)
            if self.manager.state == "approach":
                self.progress = 0.0
        if orders.person_may_act:
            self.progress = min(1.0, self.progress + self.speed * frame_ns / 1e9)
        self.states.append(self.manager.state.value)
        self.orders.append(orders)
        self.frame += 1
        self.now_ns += frame_ns
        return orders

    def _with_peaks(self, values: dict[str, Any]) -> dict[str, Any]:
        """The values with the extremes of the trial, as the loop follows them while the person leads."""
        if self.scene.get("controller") != Slot.PERSON:
            self.peaks = {}
        else:
            now = {
                "force_peak": float(np.linalg.norm(values.get("f_user_world", np.zeros(3)))),
                "distance_peak": values.get("distance", 0.0),
                "progress_peak": values.get("progress", 0.0),
            }
            self.peaks = {name: max(value, self.peaks.get(name, 0.0)) for name, value in now.items()}
        return self.peaks | values

    def until(self, state: str, most_frames: int = 20_000) -> int:
        """Step until the state is entered; the frames it took. AssertionError when it never is."""
        for count in range(most_frames):
            self.step()
            if self.manager.state == state:
                return count + 1
        raise AssertionError(f"{state} not reached; in {self.manager.state}")

    def journey(self) -> list[str]:
        """The states without repeats."""
        return [state for i, state in enumerate(self.states) if i == 0 or state != self.states[i - 1]]


def make_manager(
    spec: Any, seed: int = 1, *, introduced: bool = False, waits: bool = False, **listeners: Any
) -> TaskManager:
    return TaskManager(spec, TaskContext(START, introduced=introduced, waits=waits), seed, **listeners)
