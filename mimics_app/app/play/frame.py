"""One frame: D2.1 Figure 1 from left to right."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.cues.effect_cues import EffectCues
from mimics_app.app.picture.stability_card import stability_card
from mimics_app.app.play.recorder_watch import RecorderWatch
from mimics_app.app.play.safety_watch import SafetyWatch
from mimics_app.app.session.session import Session
from mimics_app.app.touch.loss_watch import LossWatch
from mimics_app.app.touch.person_inbox import PersonInbox
from mimics_app.contracts.board import Board
from mimics_app.contracts.haptic import EVENT
from mimics_app.contracts.messages import HapticSnapshot, TaskOrders, VRInput

__all__ = ["Frames"]


class Frames:
    """Calls every stage once per frame and remembers what the next frame needs.

    Attributes:
        number: Frames done.
        orders: What the task wanted in the newest frame.
        snapshot: The haptic state the newest frame saw.
        losses: What of the scene's objects is not simulated any more.
        safety: What stopped or held the loop.
        events: What had happened in the haptic loop since the frame before, EVENT records.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._inbox = PersonInbox(session.haptics)
        self._effects = EffectCues(session.world)
        self.number = 0
        self.orders = TaskOrders()
        self.snapshot: HapticSnapshot | None = None
        self.losses = LossWatch(session.side.effect_entities)
        self.safety = SafetyWatch()
        self._recorder = RecorderWatch(session.recorder)
        self.events: NDArray[Any] = np.zeros(0, EVENT)

    @property
    def board(self) -> Board:
        """What may lie over the picture: the task's board, and the stability of what is touched."""
        if self.snapshot is None:
            return self.orders.board
        return self.orders.board.with_cards({"margin": stability_card(self.snapshot)})

    def step(self) -> None:
        """Do one frame at the session's present time."""
        session = self._session
        now_ns = session.clock.now_ns()
        vr = session.inputs.poll(now_ns)
        features = session.dsp.process(vr.signals, now_ns)
        state = session.estimation.update(features)
        action = session.learning.choose(state, now_ns)
        snapshot, events = session.haptics.snapshot(), session.haptics.events()
        self.losses.see(events)
        self.safety.see(events)
        self._recorder.look()
        orders = session.tasks.step(vr, action, snapshot, events, now_ns)
        self._touch(vr, orders, snapshot)
        session.scenario.apply(orders, snapshot)
        session.desk.change(session.scenario.haptic_orders())
        session.inputs.aim(session.scenario.aim(snapshot))
        session.world.update()
        self._effects.step(orders, events, now_ns)
        if session.sound is not None:
            session.sound.step(orders, session.world, now_ns)
        self._journal(snapshot, now_ns)
        self.number, self.orders, self.snapshot, self.events = self.number + 1, orders, snapshot, events

    def _journal(self, snapshot: HapticSnapshot, now_ns: int) -> None:
        """What this frame saw: the tick, and where every haptic body was."""
        line: dict[str, object] = {"frame": self.number, "tick": snapshot.tick, "t_ns": now_ns}
        bodies = int(self._session.desk.block["objects"]["bodies"][0])
        if bodies:
            line["bodies"] = snapshot.poses[:bodies].tolist()
        self._session.recorder.journal("frame", line)

    def _touch(self, vr: VRInput, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        """Hand the task's haptic orders and the person's pointer to the loop."""
        session = self._session
        if vr.pointer is not None and vr.pointer.stop:
            session.haptics.stop_key()
        haptic = dict(orders.haptic)
        if "r" in vr.pressed:
            haptic["resets"] = int(session.desk.block["resets"][0]) + 1
        session.desk.change(haptic)
        if orders.view.robot_leads:
            x, y, z = snapshot.hip_world
            session.inputs.hold_at((float(x), float(y), float(z)))
        trial = int(session.desk.block["trial"][0])
        self._inbox.tell(vr.pointer, trial=trial, may_act=orders.person_may_act)
