"""Haptic engine: owner of the loop of one session, live or on the virtual clock."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from mimics_app.compiled.function_pointers import pointers_to
from mimics_app.contracts.arrays import Records
from mimics_app.contracts.clock import MonotonicClock
from mimics_app.contracts.errors import DeviceError, UsageError, require_choice
from mimics_app.contracts.loop.calibrated_device import calibration_steps
from mimics_app.contracts.loop.controller_slots import names_in
from mimics_app.contracts.loop.device_faults import fault_order
from mimics_app.contracts.loop.device_life import LIFE_IN, DeviceLife, LifeStep, life_after
from mimics_app.contracts.loop.haptic import EVENT, INBOX, SafetyState
from mimics_app.contracts.loop.loop_ports import COMMAND_LENGTH, DATA_LENGTH, INBOX_LENGTH, DevicePlugin
from mimics_app.contracts.loop.object_rows import Rows, slot_of
from mimics_app.contracts.loop.spoiling import Spoiling
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, PointerState
from mimics_app.contracts.shared_memory import ring, triple_buffer
from mimics_app.contracts.shared_memory.session_memory import ControlWord, SessionMemory
from mimics_app.rendering.haptic import scheduler
from mimics_app.rendering.haptic.block_check import check_block
from mimics_app.rendering.haptic.channels import channels_of, new_work, newest_snapshot
from mimics_app.rendering.haptic.controllers.registry import NO_CONTROLLERS, controllers_of, set_controllers
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.histogram import LatenessReport, LinkReport, percentile_us
from mimics_app.rendering.haptic.kernels.spoiled_data import KIND, ORDERS, OTHER, PLACE, VALUE
from mimics_app.rendering.haptic.loop import advance_ticks
from mimics_app.rendering.haptic.loop_tick import LOOP_FUNCTIONS, loop_tick, tick
from mimics_app.rendering.haptic.no_objects import NO_FIELDS, load_simulation, no_objects
from mimics_app.rendering.haptic.objects import ObjectWork, new_object_work
from mimics_app.rendering.haptic.stability_report import StabilityReport, stability_of

if TYPE_CHECKING:
    from mimics_app.rendering.haptic.record_types import Fields

__all__ = ["HapticEngine"]


_JOIN_S = 2.0
"""Time-out of the haptic thread's end [s]."""

_RELEASE_TICKS = 40
"""Disabled commands that a real device is sent after the loop: at 1 ms each, also a line of 9600 baud carries one."""

_RELEASE_NS = 1_000_000
"""Time between two of them [ns]."""


class HapticEngine:
    """One haptic loop over one session memory and one device.

    Either `advance` it on the virtual clock or `start` it live; the tick is the same. Without published parameters the
    loop stays OFF.

    Args:
        memory: The session's shared memory; the engine writes both the loop's and the main thread's side of it.
        plugin: The device.
        rate: Ticks per second.
        recipe: One of `scheduler.RECIPES`.
        objects: Working arrays of the scene's haptic objects, with the session's capacities; None: no objects.
        fields: Force fields by EFFECT.field, MAX_FIELDS of them.
    """

    def __init__(
        self,
        memory: SessionMemory,
        plugin: DevicePlugin,
        *,
        rate: int = 1000,
        recipe: str = "auto",
        objects: ObjectWork | None = None,
        fields: Fields = NO_FIELDS,
    ) -> None:
        self._memory = memory
        self._plugin = plugin
        self._descriptor = plugin.descriptor or HAPTICMASTER
        self._period_ns = 1_000_000_000 // rate
        self._recipe = recipe
        self._channels = channels_of(memory)
        self._work = new_work(objects or new_object_work(memory.capacities.objects))
        self._drained, self._no_events = np.zeros(memory.main_events.shape[0], EVENT), np.zeros(0, EVENT)
        self._inbox: Records = np.zeros(1, INBOX)
        self._beside: list[tuple[float, ...]] = []  # from the first point of contact to each other, world [m]
        self._beside_in = -1  # trial at whose begin they were so
        self._resets = 0
        self._life = DeviceLife.INACTIVE  # its builder has configured it
        self._released = False
        self._granted: scheduler.Granted | None = None
        self._arranged = threading.Event()
        self._thread: threading.Thread | None = None
        self._failure: BaseException | None = None
        simulate = no_objects if objects is None else load_simulation()
        kin = tuple(self._descriptor.kinematics)
        # Kept alive here: the loop holds addresses without references.
        self._controllers, self._named = NO_CONTROLLERS, b""
        self._functions = (loop_tick, tick, plugin.read, plugin.write, simulate, fields, kin)
        pointers = pointers_to(self._functions, LOOP_FUNCTIONS)
        self._loop_args = (self._channels, self._work, pointers, plugin.memory)
        advance_ticks(*self._loop_args, 0, self._period_ns)

    @property
    def plugin(self) -> DevicePlugin:
        """The device in use."""
        return self._plugin

    @property
    def life(self) -> DeviceLife:
        """State of the device's life cycle; between the engine's own steps that of the loop's safety machine."""
        if self._life is not DeviceLife.INACTIVE or self._released:
            return self._life
        return LIFE_IN[SafetyState(self.snapshot().state)]

    @property
    def running(self) -> bool:
        """True while the live loop runs."""
        return self._thread is not None and self._thread.is_alive()

    @property
    def buttons(self) -> int:
        """Buttons word of the device, of the newest data that the loop took."""
        return int(self._work.state[0]["buttons"])

    @property
    def ticks(self) -> int:
        """Ticks done so far; a constant count means a dead loop."""
        return int(self._memory.control[ControlWord.TICKS])

    @property
    def granted(self) -> scheduler.Granted:
        """Scheduler recipe of the live loop; "virtual" on the virtual clock."""
        return self._granted or scheduler.Granted("virtual", False)

    def publish(self, scene: Records, rows: Rows | None = None) -> None:
        """Pass a parameter block to the loop; it takes effect at a tick boundary.

        A changed count of resets also answers all stop requests so far, so that a latched stop can be left.

        Args:
            scene: SCENE record, shape [1]; `sequence` must count up from 1.
            rows: Tables of objects that the record counts; None where it counts none.

        Raises:
            ValueError: The loop cannot run with this block, see `check_block`; or it has other controllers than the
                live loop runs with.
            UsageError: A controller is not installed.
        """
        check_block(scene, rows, self._memory.capacities.objects, len(self._work.objects.meshes.rows))
        self._load_controllers(scene[0]["controller_names"])
        if int(scene[0]["resets"]) != self._resets:
            self._resets = int(scene[0]["resets"])
            self._memory.control[ControlWord.CLEARED] = self._memory.stop_words.sum()
        memory = self._memory
        slot = triple_buffer.back_slot(memory.scene_words)
        memory.scenes[slot] = scene[0]
        if rows is not None:
            slot_of(memory.rows, slot, rows, scene[0]["objects"])
        triple_buffer.publish(memory.scene_words)

    def _load_controllers(self, named: Records) -> None:
        """Look up the controllers of a block, where they differ from those of the last one."""
        if named.tobytes() == self._named:
            return
        if self.running:
            raise ValueError("SCENE.controller_names differ from those that the live loop began with")
        self._controllers = controllers_of(names_in(named))
        set_controllers(self._work.state, self._controllers)
        self._named = named.tobytes()

    def send(self, inbox: Records) -> None:
        """Pass the newest state of the pointing device (INBOX record, shape [1]) to the device plug-in."""
        memory = self._memory
        memory.inboxes[triple_buffer.back_slot(memory.inbox_words)] = inbox[0]
        triple_buffer.publish(memory.inbox_words)

    def send_pointer(self, pointer: PointerState | None, *, trial: int, may_act: bool) -> None:
        """Pass the pointing device of a frame to the device plug-in.

        Args:
            pointer: Its state; None keeps the last target and marks the person as inactive.
            trial: Number of the present trial.
            may_act: False while the robot leads.
        """
        record = self._inbox[0]
        record["active"] = int(may_act and pointer is not None and pointer.active)
        record["trial"] = trial
        if pointer is not None:
            record["target_world"][0], record["grasp"][0] = pointer.target_world, pointer.grasp
            self._point_further(record, pointer)
        self.send(self._inbox)

    def _point_further(self, record: Records, pointer: PointerState) -> None:
        """Set the targets of the points of contact after the first; without one of its own a point stays beside it."""
        points = len(self._descriptor.contacts) - 1
        if points > len(pointer.further) and record["trial"] != self._beside_in:
            self._beside_in = int(record["trial"])
            first, *others = self.snapshot().points
            self._beside = [tuple(other.hip_world - first.hip_world) for other in others]
        for c in range(points):
            if c < len(pointer.further):
                target, grasp = pointer.further[c].target_world, pointer.further[c].grasp
            else:
                x, y, z = pointer.target_world
                dx, dy, dz = self._beside[c]
                target, grasp = (x + dx, y + dy, z + dz), pointer.grasp
            record["target_world"][c + 1], record["grasp"][c + 1] = target, grasp

    def calibrate(self, step: str) -> None:
        """Begin a step of the device's calibration; the device must be inactive.

        Args:
            step: Name of the step.

        Raises:
            UsageError: The device has no such step, or is active.
        """
        steps = calibration_steps(self._plugin)
        if not steps:
            raise UsageError(f"the device {self._plugin.name} has no steps of calibration")
        require_choice(step, steps, "step of this device's calibration")
        if self.life is not DeviceLife.INACTIVE:
            raise UsageError(f"the device is {self.life}: it is calibrated while it is inactive", "stop it first")
        steps[step]()

    def inject(self, fault: str) -> None:
        """Let a fault of the simulated device begin at the next tick, or end the one before.

        Args:
            fault: "NAME" or "NAME:PLACE", see `contracts/loop/device_faults.py`; "none" ends one.

        Raises:
            UsageError: The device is not simulated, or has no such fault.
        """
        if not self._plugin.simulated:
            raise UsageError("faults are injected into simulated devices only")
        order, spoiling = fault_order(fault, self._descriptor), self._work.spoiling
        spoiling[KIND] = Spoiling.NOTHING  # the loop runs: it must not see half of an order
        spoiling[PLACE], spoiling[OTHER], spoiling[VALUE] = order.place, order.other, order.value
        spoiling[KIND] = order.spoiling
        spoiling[ORDERS] += 1.0

    def snapshot(self) -> HapticSnapshot:
        """Return the newest state of the loop; its arrays are copies."""
        return newest_snapshot(self._memory, len(self._descriptor.joints), len(self._descriptor.contacts))

    def events(self) -> Records:
        """Return the EVENT records since the last call, oldest first."""
        memory = self._memory
        count = ring.drain(memory.main_event_words, memory.main_events, self._drained)
        return self._drained[:count].copy() if count else self._no_events

    def advance(self, ticks: int) -> int:
        """Run `ticks` ticks on the virtual clock at full speed; return the total number of ticks done.

        Raises:
            RuntimeError: The live loop is running.
            DeviceError: The device is finalised.
        """
        if self.running:
            raise RuntimeError("the live loop is running; stop() it before advance()")
        self._check_configured()
        return int(advance_ticks(*self._loop_args, ticks, self._period_ns))

    def start(self) -> scheduler.Granted:
        """Start the live loop in its own thread; return how it is scheduled.

        If the result has `lower_main` set, the calling thread should call `scheduler.lower_this_thread()` before it
        creates its GL context.

        Raises:
            RuntimeError: The loop is running.
            DeviceError: The device is finalised, or the thread could not be scheduled.
        """
        if self.running:
            raise RuntimeError("the live loop is running already")
        self._check_configured()
        if sys.platform.startswith("linux") and threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGXCPU, self._demote)
        from mimics_app.rendering.haptic.live_loop import run_live  # compiled before the first deadline

        self._memory.control[ControlWord.QUIT] = 0
        self._arranged.clear()
        self._thread = threading.Thread(target=self._run, args=(run_live,), name="haptic", daemon=True)
        self._thread.start()
        self._arranged.wait()
        if self._failure is not None:
            raise DeviceError(f"the haptic loop could not be started: {self._failure}")
        return self.granted

    def stop(self) -> None:
        """End the live loop, if it runs; deactivate, clean up and finalise the device. A second call does nothing more.

        Raises:
            DeviceError: The loop did not end, or ended with an error.
        """
        self._memory.control[ControlWord.QUIT] = 1
        if self._thread is not None:
            self._thread.join(_JOIN_S)
            if self._thread.is_alive():
                raise DeviceError("the haptic loop did not stop", "switch the robot off at its own switch")
        if self._life is not DeviceLife.FINALISED:
            self._deactivate_device()
            self._life = life_after(life_after(self._life, LifeStep.CLEANUP), LifeStep.SHUTDOWN)
            self._plugin.close()
        if self._failure is not None:
            raise DeviceError(f"the haptic loop ended with an error: {self._failure}")

    def histogram(self) -> LatenessReport:
        """Return the lateness and duration of the ticks so far."""
        control = self._memory.control
        late = self._memory.lateness
        return LatenessReport(
            p50=percentile_us(late, 0.5),
            p99=percentile_us(late, 0.99),
            p99_9=percentile_us(late, 0.999),
            max=percentile_us(late, 1.0),
            duration_p50=percentile_us(self._memory.duration, 0.5),
            duration_p99=percentile_us(self._memory.duration, 0.99),
            missed=int(control[ControlWord.MISSED]),
            held=int(control[ControlWord.HELD]),
            stale=int(control[ControlWord.STALE]),
            stops=int(control[ControlWord.STOPS]),
            holds=int(control[ControlWord.HOLDS]),
            ticks=self.ticks,
            recipe=self.granted.recipe,
        )

    def link(self) -> LinkReport | None:
        """Return the quality of the link to the device so far; None of a simulated device, and on a virtual clock."""
        if self._plugin.simulated:
            return None
        return LinkReport.of(self._memory.data_age, int(self._memory.control[ControlWord.UNREAD]))

    def stability(self) -> StabilityReport:
        """Return the results of the stability monitor so far."""
        return stability_of(self._work.state[: len(self._descriptor.contacts)], self._work.objects.margins)

    def _demote(self, *_: object) -> None:
        """Handle SIGXCPU: a runaway loop continues without SCHED_FIFO, and its late ticks stop it."""
        if self._thread is not None and self._thread.native_id is not None and self.running:
            with suppress(ProcessLookupError):  # the thread has ended meanwhile
                self._granted = scheduler.demote(self._thread.native_id)

    def _check_configured(self) -> None:
        """Refuse a loop over a finalised device: its descriptor may be another file's by now."""
        if self._life is not DeviceLife.INACTIVE:
            raise DeviceError(f"the device is {self._life}; no loop runs over it", "build another engine")

    def _deactivate_device(self) -> None:
        """Send the device commands with zero force and disabled drives, once; the loop must have ended.

        A real device gets some: it may hold the last one for as long as it has power, also after its line is closed.
        """
        if self._released:
            return
        self._released = True
        plugin, clock, ticks = self._plugin, MonotonicClock(), self.ticks
        command, data = np.zeros(COMMAND_LENGTH), np.zeros(DATA_LENGTH)
        inbox = np.zeros(INBOX_LENGTH)
        try:
            plugin.write(plugin.memory, command, ticks)
            for tick in range(ticks + 1, ticks + (1 if plugin.simulated else _RELEASE_TICKS + 1)):
                clock.sleep_until_ns(clock.now_ns() + _RELEASE_NS)
                plugin.read(plugin.memory, inbox, data, tick)
                plugin.write(plugin.memory, command, tick)
        except Exception as failure:  # noqa: BLE001  whatever a plug-in raises, its device is closed next
            self._failure = self._failure or failure

    def _run(self, run_live: Callable[..., Any]) -> None:
        """Body of the haptic thread: set the scheduler, then make one compiled call until the quit word is set."""
        try:
            self._granted = scheduler.arrange_thread(self._recipe)
            spin_us = scheduler.spin_for(self._granted)
        except BaseException as failure:  # noqa: BLE001  raised by start()
            self._failure = failure
            return
        finally:
            self._arranged.set()
        try:
            run_live(*self._loop_args, self._period_ns, spin_us * 1000)
        except BaseException as failure:  # noqa: BLE001  raised by stop()
            self._failure = failure
        finally:
            self._deactivate_device()
