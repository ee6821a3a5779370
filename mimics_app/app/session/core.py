"""Core of every session: the haptic side, the scenario, and the stages of D2.1 Figure 1.

A run adds recorder, sound and picture; a still, a point of a sweep, a warm-up and a test use the core alone.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from mimics_app.app.scenes.scenario_choice import features_of
from mimics_app.app.session.preparation import SessionParts
from mimics_app.app.session.signal_recorder import SignalRecorder
from mimics_app.app.session.switched_off import NullOutlets, NullRecorder, NullSound, Outlets, RecorderPort, SoundPort
from mimics_app.app.session.trackers import make_hub
from mimics_app.app.terminal.output import say_nothing
from mimics_app.app.touch.device_fit import device_values
from mimics_app.app.touch.haptic_scene_data import HapticSceneData
from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.clock import Clock, MonotonicClock, VirtualClock
from mimics_app.contracts.commands.vocabulary import Reply
from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.ports.command_port import open_steersman
from mimics_app.contracts.ports.scenario_port import Scenario
from mimics_app.contracts.ports.stages import Dsp, Estimation, Goal, Learning
from mimics_app.contracts.shared_memory.session_memory import SessionMemory
from mimics_app.inputs.commands.command_file import TimedCommands
from mimics_app.inputs.commands.device_buttons import DeviceButtons
from mimics_app.inputs.commands.keys import KeyCommands
from mimics_app.inputs.commands.steered import SteeredBy
from mimics_app.inputs.interaction.simulated_patient import SimulatedPatient
from mimics_app.inputs.stage import Inputs
from mimics_app.learning.action_sequence import ActionSequence
from mimics_app.rendering.haptic.devices.address import split_device
from mimics_app.rendering.haptic.devices.button_commands import button_commands
from mimics_app.rendering.haptic.devices.device_names import BUILT_IN, load_built_in
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.rendering.tactile.vibrators import NoVibrators, Vibrators
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.components.systems import VisualSettings
from mimics_app.world.components.tactile import TactileSettings
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

if TYPE_CHECKING:
    from mimics_app.rendering.visual.presenting.presenter import Presenter

__all__ = ["SessionCore", "open_core", "simulated_person"]


class SessionCore:
    """One played scene: `Frames` steps it. A context: leaving it stops the loop and closes the device.

    Args:
        parts: Parts of the session; its parameters are fitted to the device already.
        memory: Memory shared by the loop and its readers.
        recorder: Recorder of the session, or a null object.
        sound: Sound of the session, or a null object.
        folder: Run folder, None where nothing is kept.

    Attributes:
        side: Haptic objects of the scene, as they were when the loop was built.
        limit_notes: A line for each limit that the scene sets beyond its usual value.
        softened: A line for each contact that the device cannot hold as the scene asks.
        report: Shows a line to the person; discards it unless the session is a run.
        outlets: Streams of the session for other programs.
        live: True when the haptic loop runs in real time; False on the virtual clock.
        ended: Whether `stop` was called: no frame follows.
        has_policy: Whether a policy or a list of actions adapts the task.
        view: The view that a command wants; "": as the scene says.
        keys: Keys and gamepad as sources of commands.
        timed_commands: Commands of a file, each at its time.
        buttons: Buttons of the device as a source of commands.
        steered: Program of an installed package as a source of commands.
    """

    def __init__(
        self,
        parts: SessionParts,
        memory: SessionMemory,
        recorder: RecorderPort,
        sound: SoundPort,
        folder: Path | None = None,
    ) -> None:
        self.scene: Scene = parts.scene
        self.world: World = parts.world
        self.scenario: Scenario = parts.scenario
        self.side: HapticSceneData = parts.side
        self.live: bool = parts.live
        self.ended = False
        self.memory = memory
        self.clock: Clock = MonotonicClock() if parts.live else VirtualClock()
        self.parameter_store: ParameterStore = parts.parameter_store
        self.limit_notes = parts.held.notes
        self.softened = parts.softened
        self.haptics: HapticEngine = parts.side.engine(memory, parts.plugin, recipe=parts.settings.recipe)
        seed = parts.settings.seed
        self.tasks = TaskManager(
            parts.task,
            parts.context,
            seed,
            on_trial=recorder.trial,
            on_event=recorder.journal,
            first_trial=parts.settings.from_trial - 1,
            features=features_of(parts.scene),
        )
        self.trackers = make_hub(parts.scene, self.clock, seed, folder)
        body = parts.body
        self.inputs = Inputs([simulated_person(parts.scene, parts.scenario)], body.sources)
        self.dsp: Dsp = body.dsp
        self.estimation: Estimation = body.estimation
        self.learning: Learning = body.learning
        self.goal: Goal = body.goal
        self.has_policy = parts.settings.action is not None or not isinstance(body.learning, ActionSequence)
        self._has_signals = bool(parts.settings.physio)
        self.view = ""
        first = (parts.scene.system(VisualSettings) or VisualSettings()).view or ""
        self.keys = KeyCommands(memory, self._say, self.views, lambda: self.view or first)
        self.timed_commands = TimedCommands(memory, parts.commands, self._say)
        steer = parts.settings.steer
        self.steered = SteeredBy(memory, open_steersman(steer) if steer else None, steer, self._say)
        self.buttons = DeviceButtons(memory, button_commands(parts.robot.buttons), self._say)
        self.recorder = recorder
        self.signal_recorder = SignalRecorder(recorder)
        self.report: Callable[[str], None] = say_nothing
        self.outlets: Outlets = NullOutlets()
        self.sound = sound
        self.tactile = _open_tactile(parts.scene, live=parts.live)

    def require_open(self) -> None:
        """Refuse to play on after the end: recorder and device are closed.

        Raises:
            UsageError: The session is closed.
        """
        if self.ended:
            raise UsageError("session is closed", "open another one")

    def show_view(self, name: str) -> Reply:
        """Show the view of an entity's camera from the next frame on."""
        names = self.views
        if name not in names:
            return Reply(done=False, why=f'this scene has no view "{name}"; {nearest(name, names)}')
        self.view = name
        return Reply(done=True)

    @property
    def views(self) -> list[str]:
        """Names of the scene's views: entities with a camera."""
        return [camera.node.name for camera in self.world.cameras]

    def recalibrate(self) -> Reply:
        """Measure the baseline of the body signals anew."""
        if not self._has_signals:
            return Reply(done=False, why="this session measures no body signals")
        self.estimation.recalibrate()
        return Reply(done=True)

    def _say(self, text: str) -> None:
        """Show a line to the person, by the means that the session has at this time."""
        self.report(text)

    def part_of_body(self, role: str, at_ns: int) -> NDArray[np.float64] | None:
        """Return room_from_part of the person's body at a time [ns], float64 [4, 4]; or None."""
        found = self.trackers.pose(role, at_ns)
        return None if found is None else found.pose

    def shown_by(self, presenter: Presenter) -> None:
        """Make a display follow the person's head, and the scenario place the person before walls."""
        presenter.follow(self.trackers.head)
        if self.live:  # on the virtual clock the simulation is independent of the display
            self.trackers.attach_display(presenter.tracked)
        if presenter.surrounds:
            self.scenario.hide_own_avatar()
            self.world.update()

    def begin(self) -> None:
        """Send the first parameters to the recorder, then to the loop."""
        self.parameter_store.send_to(self.recorder.parameters, self.haptics.publish)

    def stop(self) -> None:
        """End the task and the loop, and close the device; a second call does nothing.

        Raises:
            DeviceError: A device or the loop ended with an error, after all the others were closed.
        """
        if self.ended:
            return
        self.ended = True
        with ExitStack() as stack:  # the last first
            stack.callback(self.signal_recorder.flush)
            stack.callback(self.inputs.close)
            stack.callback(self.steered.close)
            stack.callback(self.tactile.close)
            stack.callback(self.trackers.stop)
            stack.callback(self.haptics.stop)
            self.tasks.end_session(self.clock.now_ns())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def open_core(parts: SessionParts, recorder: Callable[[SessionMemory], RecorderPort] = NullRecorder) -> SessionCore:
    """Return a session without processes, sound or picture, ready for its first frame.

    Args:
        parts: Parts of the session.
        recorder: Creates the recorder of the session.

    Raises:
        DeviceError: The robot cannot be opened; it is closed.
    """
    with ExitStack() as stack:
        stack.callback(parts.plugin.close)
        parts.parameter_store.fit(device_values(parts.plugin, parts.scene, parts.parameter_store.block))
        memory = parts.side.memory(parts.plugin)
        core = SessionCore(parts, memory, recorder(memory), NullSound())
        core.trackers.start()
        stack.pop_all()
    core.begin()
    return core


def simulated_person(scene: Scene, scenario: Scenario) -> SimulatedPatient:
    """Return the simulated person of a scene, for a run or an emulated robot."""
    robot, patient = scene.first(Robot) or Robot(), scene.first(Patient) or Patient()
    name = split_device(robot.device).name
    walks = name in BUILT_IN and load_built_in(name).walks
    return SimulatedPatient(intent=patient.intent, follows_path=walks or len(scenario.via_points_world) > 1)


def _open_tactile(scene: Scene, *, live: bool) -> Vibrators:
    """Return the driver of the scene's vibrators: its serial line in a live session, else a null object.

    Raises:
        DeviceError: The serial line cannot be opened.
    """
    settings = scene.system(TactileSettings) or TactileSettings()
    if not live or not settings.port:
        return NoVibrators()
    from mimics_app.rendering.tactile.vibrators import GuardedVibrators, SerialVibrators

    return GuardedVibrators(SerialVibrators(settings.port, settings.vibrators, settings.baud))
