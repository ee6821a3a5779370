"""The parts every session has, whoever looks at it: what is touched, what plays it, and the stages of Figure 1.

A run adds a recorder, a sound and a picture; a still, a point of a sweep, a warm-up and a test do without.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.session.preparation import Preparation
from mimics_app.app.session.switched_off import NullRecorder, NullSound, RecorderPort, SoundPort
from mimics_app.app.session.tap import Tap
from mimics_app.app.session.trackers import make_hub
from mimics_app.app.touch.device_fit import device_values
from mimics_app.app.touch.haptic_side import HapticSide
from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.clock import Clock, MonotonicClock, VirtualClock
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.scenario_port import Scenario
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.contracts.stages import Dsp, Estimation, Goal, Learning
from mimics_app.inputs.interaction.simulated_patient import SimulatedPatient
from mimics_app.inputs.stage import Inputs
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.tactile.vibrators import NoVibrators, Vibrators
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.world.components.robot import Patient
from mimics_app.world.components.tactile import TactileSettings
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

if TYPE_CHECKING:
    from mimics_app.rendering.visual.presenting.presenter import Presenter

__all__ = ["SessionCore", "open_core", "simulated_person"]


class SessionCore:
    """One played scene: `Frames` steps it. A context: leaving it stops the loop and closes the device.

    Args:
        parts: What it is made of; the device's values are fitted to its parameters already.
        memory: Shared by the loop and whoever reads it.
        recorder: Of the session, or what stands in its place.
        sound: Likewise.
        folder: Of the run, None where nothing is kept.

    Attributes:
        side: What of the scene can be touched, as it was when the loop was built.
        report: Says a line to the person at it; nobody is, unless it is a run.
        live: True when the haptic loop runs in real time; False on the virtual clock.
        ended: Whether `stop` was called: it plays no further frame.
    """

    def __init__(
        self,
        parts: Preparation,
        memory: SessionMemory,
        recorder: RecorderPort,
        sound: SoundPort,
        folder: Path | None = None,
    ) -> None:
        self.scene: Scene = parts.scene
        self.world: World = parts.world
        self.scenario: Scenario = parts.scenario
        self.side: HapticSide = parts.side
        self.live: bool = parts.live
        self.ended = False
        self.memory = memory
        self.clock: Clock = MonotonicClock() if parts.live else VirtualClock()
        self.parameter_store: ParameterStore = parts.parameter_store
        self.haptics: HapticEngine = parts.side.engine(memory, parts.plugin, recipe=parts.settings.recipe)
        seed = parts.settings.seed
        self.tasks = TaskManager(
            parts.task,
            parts.context,
            seed,
            on_trial=recorder.trial,
            on_event=recorder.journal,
            first_trial=parts.settings.from_trial - 1,
        )
        self.trackers = make_hub(parts.scene, self.clock, seed, folder)
        body = parts.body
        self.inputs = Inputs([simulated_person(parts.scene, parts.scenario)], body.sources)
        self.dsp: Dsp = body.dsp
        self.estimation: Estimation = body.estimation
        self.learning: Learning = body.learning
        self.goal: Goal = body.goal
        self.recorder = recorder
        self.tap = Tap(recorder)
        self.report: Callable[[str], None] = _say_nothing
        self.sound = sound
        self.tactile = _open_tactile(parts.scene, live=parts.live)

    def require_open(self) -> None:
        """Refuse to play on after the end: nobody would record it, and the device is closed.

        Raises:
            UsageError: The session has ended.
        """
        if self.ended:
            raise UsageError("this session has ended: it plays no further frame", "open another one")

    def part_of_body(self, role: str, at_ns: int) -> NDArray[np.float64] | None:
        """room_from_part of the person's body at a time [ns], as far as a tracker knows; float64 [4, 4]."""
        found = self.trackers.pose(role, at_ns)
        return None if found is None else found.pose

    def shown_by(self, presenter: Presenter) -> None:
        """Have a display follow the person's head, and the scenario know where the person is seen."""
        presenter.follow(self.trackers.head)
        if self.live:  # on the virtual clock the simulation does not go by what shows it
            self.trackers.listen_to(presenter.tracked)
        if presenter.surrounds:
            self.scenario.stand_before_walls()
            self.world.update()

    def begin(self) -> None:
        """Hand the first parameters on: to the recorder that keeps them, then to the loop that obeys them."""
        self.parameter_store.hand_to(self.recorder.parameters, self.haptics.publish)

    def stop(self) -> None:
        """End the task and the loop, and close the device; nothing the second time."""
        if self.ended:
            return
        self.ended = True
        self.tasks.end_session(self.clock.now_ns())
        self.haptics.stop()
        self.trackers.stop()
        self.tactile.close()
        self.inputs.close()
        self.tap.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()


def open_core(parts: Preparation, recorder: Callable[[SessionMemory], RecorderPort] = NullRecorder) -> SessionCore:
    """A session without processes, sound or picture, ready for its first frame.

    Args:
        parts: What it is made of.
        recorder: Makes what stands in the recorder's place.

    Raises:
        DeviceError: the robot cannot be had.
    """
    parts.parameter_store.fit(device_values(parts.plugin, parts.scene))
    memory = parts.side.memory(parts.plugin)
    core = SessionCore(parts, memory, recorder(memory), NullSound())
    core.trackers.start()
    core.begin()
    return core


def _say_nothing(text: str) -> None:
    """Nobody is there."""


def simulated_person(scene: Scene, scenario: Scenario) -> SimulatedPatient:
    """What a simulated person does with what the scene asks: the run's own, or one on an emulated robot."""
    patient = scene.first(Patient) or Patient()
    return SimulatedPatient(intent=patient.intent, follows_path=len(scenario.via_points_world) > 1)


def _open_tactile(scene: Scene, *, live: bool) -> Vibrators:
    """What drives the scene's vibrators: its line in a live session, else nothing but the record.

    Raises:
        DeviceError: the line cannot be opened.
    """
    settings = scene.system(TactileSettings) or TactileSettings()
    if not live or not settings.port:
        return NoVibrators()
    from mimics_app.rendering.tactile.vibrators import SerialVibrators

    return SerialVibrators(settings.port, settings.vibrators, settings.baud)
