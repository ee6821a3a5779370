"""One frame: D2.1 Figure 1 from left to right."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.cues.cue_watch import with_gait_cues
from mimics_app.app.picture.loop_cards import loop_cards
from mimics_app.app.session.command_desk import CommandDesk
from mimics_app.app.session.core import SessionCore
from mimics_app.app.session.safety_watch import SafetyWatch
from mimics_app.app.session.visible_scene import VisibleScene
from mimics_app.app.session.watches import RecorderWatch, SignalWatch, TactileWatch
from mimics_app.app.stage_timer import UNTIMED
from mimics_app.app.terminal.output import say
from mimics_app.contracts.clock import FRAMES_PER_SECOND, TICK_NS, TICKS_PER_SECOND, ticks_until_frame
from mimics_app.contracts.errors import counted
from mimics_app.contracts.loop.haptic import EVENT, EventKind
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.contracts.messages.stage_messages import (
    Experience,
    HapticSnapshot,
    SignalBlock,
    TaskAction,
    TaskOrders,
    TrialResult,
    UserState,
    VRInput,
)
from mimics_app.contracts.ports.display_port import FrameTiming
from mimics_app.contracts.ports.tracker_port import TrackedPose
from mimics_app.maths.length import length

__all__ = ["Frames", "LossWatch", "experience_of"]

_LONGEST_START = 20 * FRAMES_PER_SECOND
"""Largest number of frames for the robot to reach the start of a trial."""


class LossWatch:
    """Finds losses among the loop's events.

    Args:
        effect_entities: Id of the entity of each row of effects.
        report: Shows a line to the person.
    """

    def __init__(self, effect_entities: Sequence[str], report: Callable[[str], None] = say) -> None:
        self._report = report
        self._names = effect_entities
        self._pairs = 0
        self._fields: list[str] = []

    def see(self, events: NDArray[Any]) -> None:
        """Take the EVENT records of a frame, oldest first."""
        for event in events:
            if event["kind"] == EventKind.LEFT_OUT:
                self._leave_out(int(event["force"]))
            elif event["kind"] == EventKind.QUARANTINE:
                self._quarantine(int(event["force"]))

    def summary(self) -> dict[str, Any]:
        """Return the largest number of pairs left out at once, and the ids of the force fields switched off."""
        return {"pairs_left_out": self._pairs, "fields_disabled": list(self._fields)}

    def _leave_out(self, pairs: int) -> None:
        if self._pairs == 0:
            what = f"{counted(pairs, 'pairs')} of neighbouring shapes exceed the capacity of the collision test"
            self._report(f"{what}: they do not collide; move the objects apart, or give them fewer shapes")
        self._pairs = max(self._pairs, pairs)

    def _quarantine(self, row: int) -> None:
        name = self._names[row] if row < len(self._names) else f"effect {row + 1}"
        self._report(f'the force field of "{name}" gave a number that is not finite: it is switched off')
        self._fields.append(name)


class Frames:
    """Calls every stage once per frame and remembers what the next frame needs.

    Attributes:
        desk: Takes the commands.
        number: Frames done.
        orders: Orders of the task in the newest frame.
        snapshot: Haptic state read by the newest frame.
        losses: Objects of the scene that are no longer simulated.
        safety: Stops and holds of the loop.
        events: EVENT records of the haptic loop since the previous frame.
        timer: Timer of the frame's stages.
        timing: When the next frame is displayed; None where no display reports it.
        signals: Blocks of body signals of the newest frame.
    """

    def __init__(self, core: SessionCore) -> None:
        self._core = core
        self._visible = VisibleScene(core.scene, core.world)
        self._action: TaskAction | None = None
        self.desk = CommandDesk(core)
        self.timer = UNTIMED
        self.timing: FrameTiming | None = None
        self.number = 0
        self.orders = TaskOrders()
        self.signals: tuple[SignalBlock, ...] = ()
        self.snapshot: HapticSnapshot | None = None
        self._refused: set[str] = set()
        self.losses = LossWatch(core.side.effect_entities, core.report)
        self.safety = SafetyWatch(core.report)
        self._recorder = RecorderWatch(core.recorder, core.report)
        self._signals = SignalWatch(core.inputs.signals, core.recorder, core.report)
        self._taps = TactileWatch(core.recorder, core.report)
        self.events: NDArray[Any] = np.zeros(0, EVENT)

    @property
    def board(self) -> Board:
        """Overlay of the picture: the task's board, the stability margin of the touched object, and a gait state."""
        if self.snapshot is None:
            return self.orders.board
        return self.orders.board.with_cards(loop_cards(self.snapshot))

    def advance_frame(self) -> TaskOrders:
        """On the virtual clock: run the ticks up to the next frame, then that frame; return the task's orders.

        Raises:
            UsageError: The session has ended.
        """
        core = self._core
        core.require_open()
        begin, end = ticks_until_frame(self.number), ticks_until_frame(self.number + 1)
        core.recorder.wait_for_room(end - begin)
        core.haptics.advance(end - begin)
        core.clock.sleep_until_ns(end * TICK_NS)
        self.step()
        return self.orders

    def play_to_start(self) -> None:
        """On the virtual clock: play until the person of the first trial acts."""
        while self.number < _LONGEST_START and not self.advance_frame().person_may_act:
            pass

    def step(self) -> None:
        """Do one frame at the session's present time.

        What the learning system chooses after a frame takes effect in the next one, so that it can use the result of
        the task; before the first frame it chooses the initial parameters.

        Raises:
            UsageError: The session has ended.
        """
        core, stage = self._core, self.timer.stage
        core.require_open()
        now_ns = core.clock.now_ns()
        with stage("inputs"):
            vr = core.inputs.poll(now_ns)
            core.keys.step(core.inputs.frame, vr.pressed, self.orders.view, now_ns)
            core.timed_commands.step(now_ns)
            core.buttons.step(core.haptics.buttons, now_ns)
        with stage("signals"):
            features = core.dsp.process(vr.signals, now_ns)
            state = core.estimation.update(features)
            if self.number == 0:
                self._choose(state, None, now_ns)
        with stage("watch"):
            snapshot, events = core.haptics.snapshot(), core.haptics.events()
            self.losses.see(events)
            self.safety.see(events)
            self._recorder.check()
            self._signals.check(now_ns)
        with stage("tasks"):
            core.steered.step(snapshot, self.orders.view, now_ns)
            vr = replace(vr, commands=self.desk.take(snapshot), head=self._head(now_ns))
            taken = self.desk.gate.take_confirmed() or self._action
            timing = self.timing or FrameTiming.expected(now_ns)
            orders = core.tasks.step(vr, taken, snapshot, events, now_ns, timing)
            if orders.result is not None:
                state = core.estimation.update_from_result(orders.result)
            if orders.haptic.obstacle:
                self.desk.call_obstacle(orders.haptic.obstacle)
            self.desk.answer(orders.replies, self.number, now_ns)
            self._choose(state, orders.result, now_ns)
            self._touch(vr, orders, snapshot)
            self._drive_vibrators(orders, now_ns)
        with stage("scenario"):
            self._track(now_ns)
            self._play(orders, snapshot, timing.display_ns)
        with stage("world update"):
            self._visible.update(orders, events, now_ns)
            self._report_cords()
        with stage("sound"):
            self._visible.light(orders, events, timing.display_ns)
            core.sound.step(with_gait_cues(orders, events), core.world, now_ns)
        with stage("record"):
            head = core.trackers.pose("head", now_ns)
            core.inputs.take_experience(experience_of(orders, self.snapshot, snapshot, head, now_ns))
            core.signal_recorder.step(self.number, vr.signals, features, state)
            self._journal(vr, taken, snapshot, len(events), now_ns)
            core.outlets.step(snapshot, events, features, state, now_ns)
        self.number, self.orders, self.snapshot, self.events = self.number + 1, orders, snapshot, events
        self.signals = vr.signals

    def _track(self, now_ns: int) -> None:
        """Poll the trackers."""
        core = self._core
        core.trackers.take_window(core.inputs.frame)
        core.trackers.poll(now_ns)
        for problem in core.trackers.take_problems():
            core.report(problem)

    def _head(self, now_ns: int) -> HeadPlace | None:
        """Return where the tracked head is, by the reports up to the previous frame; None: not tracked."""
        found = self._core.trackers.pose("head", now_ns)
        return None if found is None or found.stale else HeadPlace.of(found.pose)

    def _play(self, orders: TaskOrders, snapshot: HapticSnapshot, shown_ns: int) -> None:
        """Let the scenario move its entities, and pass on its parameters and the next action of the hand."""
        core = self._core
        self._visible.play(core.scenario, core.part_of_body, orders, snapshot, shown_ns)
        self._tell(core.parameter_store.order(core.scenario.haptic_orders()))
        core.inputs.aim(core.scenario.aim(snapshot))

    def _tell(self, refused: Mapping[str, str]) -> None:
        """Report orders that were refused, each name once: they ended, the session continues."""
        for name, why in refused.items():
            if name not in self._refused:
                self._refused.add(name)
                self._core.report(f"an order of the scene or a plug-in ended: {why}")
                self._core.recorder.journal("refused", {"name": name, "why": why})

    def _report_cords(self) -> None:
        for name, cord in self._core.world.cords.items():
            for fault in cord.take_faults():
                self._core.report(f'cord "{name}": {fault}')

    def _drive_vibrators(self, orders: TaskOrders, now_ns: int) -> None:
        """Send the task's taps to the vibrators, and journal the time of each."""
        self._taps.take(self._core.tactile.step(orders.tactile.taps, now_ns), now_ns)

    def _choose(self, state: UserState, result: TrialResult | None, now_ns: int) -> None:
        """Let the learning system choose, given the result of the task and its reward."""
        core = self._core
        reward = core.goal.reward(state, result)
        action = core.learning.choose(state, result, reward, now_ns)
        core.signal_recorder.choice(self.number, result, reward, action)
        self._action = self.desk.gate.passed(action)

    def _journal(
        self, vr: VRInput, action: TaskAction | None, snapshot: HapticSnapshot, events: int, now_ns: int
    ) -> None:
        """Journal the inputs of this frame that a replay of the task needs, and the poses of the bodies."""
        line: dict[str, object] = {"frame": self.number, "tick": snapshot.tick, "t_ns": now_ns}
        if self.timing is not None:
            line |= {"shown_ns": self.timing.display_ns, "period_ns": self.timing.period_ns}
        if events:
            line["events"] = events
        if vr.pressed:
            line["pressed"] = vr.pressed
        if vr.head is not None:
            line["head"] = list(vr.head)
        if action is not None:
            line["action"] = {"values": dict(action.values), "at_trial": action.at_trial}
        used = self._core.parameter_store.block["objects"]
        if int(used["curves"][0]):
            line["phase"] = snapshot.phase
        bodies = int(used["bodies"][0])
        if bodies:
            line["bodies"] = snapshot.poses[:bodies].tolist()
        self._core.recorder.journal("frame", line)

    def _touch(self, vr: VRInput, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        """Send the task's haptic orders and the person's pointer to the loop."""
        core = self._core
        self._tell(core.parameter_store.order(orders.haptic, of_task=True))
        if orders.view.robot_leads:
            x, y, z = snapshot.hip_world
            core.inputs.hold_at((float(x), float(y), float(z)))
        trial = int(core.parameter_store.block["trial"][0])
        self._core.haptics.send_pointer(vr.pointer, trial=trial, may_act=orders.person_may_act)


def experience_of(
    orders: TaskOrders, before: HapticSnapshot | None, snapshot: HapticSnapshot, head: TrackedPose | None, now_ns: int
) -> Experience:
    """Return the speed, power, head, demand and result of the person in a frame.

    Args:
        orders: Orders of the task.
        before: Haptic state of the previous frame; None in the first.
        snapshot: That of this frame.
        head: Pose of the head; None: not tracked.
        now_ns: Time of the frame.
    """
    legs = snapshot.gait_state >= 0
    speed, power = _of_legs(before or snapshot, snapshot) if legs else _of_hand(snapshot)
    return Experience(
        now_ns,
        speed=speed,
        power=max(power, 0.0),
        legs=legs,
        head=None if head is None or head.stale else head.pose,
        demand=orders.demand,
        acting=orders.person_may_act,
        result=orders.result,
    )


def _of_hand(snapshot: HapticSnapshot) -> tuple[float, float]:
    """Return the speed [m/s] and the power [W] of the hand."""
    return length(snapshot.v_world), float(snapshot.f_user_world.dot(snapshot.v_world))


def _of_legs(before: HapticSnapshot, snapshot: HapticSnapshot) -> tuple[float, float]:
    """Return the speed of the belt [m/s] and the power of both legs at the joints of the orthosis [W].

    Each is a mean over the frame; a joint that yields to the drive takes power from the sum.
    """
    seconds = (snapshot.tick - before.tick) / TICKS_PER_SECOND
    if seconds <= 0.0:
        return 0.0, 0.0
    power = snapshot.torque_meas.dot(snapshot.q - before.q) / seconds
    return (snapshot.belt_travel - before.belt_travel) / seconds, float(power)
