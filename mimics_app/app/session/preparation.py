"""Preparation of a session: its parts are made and the device opened, before a process starts or anything moves.

Faults of files and devices are found here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import msgspec

from mimics_app.app.planner.plan import Plan, apply_plan
from mimics_app.app.scenes.loading import check_scene
from mimics_app.app.scenes.person_edit import PersonEdit
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.app.session.body import Body, open_body
from mimics_app.app.session.mover import mover_of
from mimics_app.app.session.requested import read_requested, with_requested_trials
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.ceiling import Held, hold_limits
from mimics_app.app.touch.ceilings import read_ceiling
from mimics_app.app.touch.device_fit import check_shape
from mimics_app.app.touch.haptic_scene_data import HapticSceneData
from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.loop.loop_ports import DevicePlugin
from mimics_app.contracts.messages.fit import Fit
from mimics_app.contracts.ports.scenario_port import Scenario, TaskContext
from mimics_app.contracts.system.language import SOURCE, speak
from mimics_app.inputs.commands.command_file import TimedCommand, read_command_file
from mimics_app.learning.policy import Policy
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.descriptors.hapticmaster import HAPTICMASTER
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import POINTER, SIMULATED, recording_of
from mimics_app.rendering.haptic.devices.device_objects import DeviceObject
from mimics_app.rendering.haptic.devices.patients import impairment_of
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.devices.request import DeviceBuilder
from mimics_app.rendering.haptic.stability_checks import softened_contacts
from mimics_app.tasks.actions import fill_defaults
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.tailoring import at_difficulty
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_file import resolve_files
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.scene import Scene

__all__ = ["Given", "SessionParts", "prepare", "prepare_scene"]

_PERSON = "person"
"""Setting of a simulated device that names who moves it."""


@dataclass(frozen=True, slots=True, eq=False)
class SessionParts:
    """Parts of a session.

    Attributes:
        settings: Settings of the run.
        live: True when the haptic loop will run in real time.
        scene: The checked scene, with the methods of the plan.
        plan: The methods that run, and why.
        world: The world built from the scene.
        scenario: The scenario of the scene.
        side: The haptic objects of the scene.
        parameter_store: The haptic parameters.
        held: What the operator's ceiling makes of the scene's limits.
        softened: A line for each contact that the device cannot hold as the scene asks.
        fit: What fits the person who plays.
        task: The task; its trial file has been read, and its parameters' defaults taken from the scene.
        body: Body signals, their processing, the estimated state, and the learning system.
        robot: The scene's robot, with the device of this run.
        patient: The scene's simulated patient, with the preset of this run.
        plugin: The device, open; the owner of the parts closes it.
        commands: Commands of a file, each with its time.
        device_given: Whether a program gave the device as an object.
        recorded: Header of the recording that the device replays; None: another device.
    """

    settings: RunSettings
    live: bool
    scene: Scene
    plan: Plan
    world: World
    scenario: Scenario
    side: HapticSceneData
    parameter_store: ParameterStore
    held: Held
    task: TaskSpec
    body: Body
    robot: Robot
    patient: Patient
    plugin: DevicePlugin
    softened: Sequence[str] = ()
    commands: Sequence[TimedCommand] = ()
    fit: Fit = field(default_factory=Fit)
    device_given: bool = False
    recorded: Mapping[str, object] | None = None

    @property
    def context(self) -> TaskContext:
        """Context of the task: the scene, the device, and the person or simulated patient."""
        mover = mover_of(self.plugin)
        return replace(
            self.scenario.task_context,
            simulated=not self.live,
            limb=(self.plugin.descriptor or HAPTICMASTER).contacts[0],
            by_pointer=self.robot.device == POINTER,
            fastest=float(self.parameter_store.block["velocity_limit"][0]),
            introduced=self.live and self.settings.journey is not None,
            waits=mover != "simulated",
            audible=self.settings.sound != "off",
            abilities=impairment_of(self.patient).abilities if mover == "simulated" else None,
        )


@dataclass(frozen=True, slots=True)
class Given:
    """Parts that a program gives as objects instead of names.

    Attributes:
        policy: Policy that adapts the task.
        device: Builder of the device, called with a `DeviceRequest` of the scene's robot.
    """

    policy: Policy | None = None
    device: DeviceBuilder | None = None


def prepare(
    settings: RunSettings, *, live: bool, read: Scene | None = None, given: Given | None = None
) -> SessionParts:
    """Read the scene, plan it, and open the device. Nothing moves, no process runs, and nothing is written.

    A device that runs in real time, a stream of markers, and an operator's page make the session live, even where
    `live` is False.

    Args:
        settings: Settings of the run.
        live: Whether the haptic loop is to run in real time.
        read: Result of `read_requested` for these settings; None: the scene is read here.
        given: Parts that a program gives as objects.

    Raises:
        SceneError: The scene, the file of actions, commands or the display is faulty.
        UsageError: The session has no such trial.
        DeviceError: The robot is not available.
    """
    return prepare_scene(check_scene(read or read_requested(settings)), settings, live=live, given=given)


def prepare_scene(
    scene: Scene, settings: RunSettings, *, live: bool = False, plan: Plan | None = None, given: Given | None = None
) -> SessionParts:
    """Do the same as `prepare` with a scene that is checked already.

    Args:
        scene: The scene to be played.
        settings: Settings of the run.
        live: Whether the haptic loop is to run in real time.
        plan: The methods that run; None: those that the planner chooses for the profile.
        given: Parts that a program gives as objects.

    Raises:
        SceneError: The action file is faulty.
        DeviceError: The robot is not available.
        UsageError: A sound device is requested, but the virtual clock would be too fast for it; or the settings file of
            this machine's limits is damaged.
    """
    speak(settings.language or SOURCE)
    plan = apply_plan(scene, settings.profile, plan)
    world = build_world(scene)
    world.effects.seed = settings.seed
    scenario = open_scenario(scene, world)
    side = HapticSceneData(scene)
    store = side.parameter_store(scenario.scene_block())
    held = hold_limits(store.block, read_ceiling())
    store.fit(held.values)
    task = _task_of_run(scene, store, settings)
    robot, patient = _who_moves(settings, scene, live=live)
    given = given or Given()
    body = open_body(settings, task, patient.preset, given.policy)
    commands = () if settings.commands is None else read_command_file(settings.commands)
    asked = _Asked(robot, patient, scenario.via_points_world, side.for_robot(robot), given.device)
    device = _open_device(scene, settings, asked)
    live = live or device.plugin.real_time or settings.console is not None or bool(settings.markers)
    if settings.sound == "device" and not live:
        raise UsageError("the virtual clock is too fast for a sound device", "write --sound file")
    return SessionParts(
        settings=settings,
        live=live,
        scene=scene,
        plan=plan,
        world=world,
        scenario=scenario,
        side=side,
        parameter_store=store,
        held=held,
        task=task,
        body=body,
        robot=robot,
        patient=patient,
        plugin=device.plugin,
        softened=device.softened,
        commands=commands,
        fit=scene.edit.fit if isinstance(scene.edit, PersonEdit) else Fit(),
        device_given=given.device is not None,
        recorded=device.recorded,
    )


def _task_of_run(scene: Scene, store: ParameterStore, settings: RunSettings) -> TaskSpec:
    """Return the scene's task with the trials and the difficulty of the settings, defaults from the scene's values."""
    task = fill_defaults(resolve_files(task_of(scene), scene.path.parent, scene.root), store.value)
    return with_requested_trials(at_difficulty(task, settings.difficulty), settings)


@dataclass(frozen=True, slots=True)
class _Asked:
    """What a run asks of its device.

    Attributes:
        robot: The scene's robot, with the device of this run.
        patient: The simulated patient, with the preset of this run.
        points: Points that the patient reaches for in order, world [m], shape [n, 3].
        objects: Objects that the robot renders itself.
        given: Builder of the device that a program gives; None: by its name.
    """

    robot: Robot
    patient: Patient
    points: F8
    objects: tuple[DeviceObject, ...]
    given: DeviceBuilder | None


@dataclass(frozen=True, slots=True)
class _OpenDevice:
    """The device of a run, open.

    Attributes:
        plugin: The device.
        recorded: Header of the recording that it replays; None: another device.
        softened: A line for each contact that it cannot hold as the scene asks.
    """

    plugin: DevicePlugin
    recorded: Mapping[str, object] | None = None
    softened: Sequence[str] = ()


def _open_device(scene: Scene, settings: RunSettings, asked: _Asked) -> _OpenDevice:
    """Open the device of a run, or one that replays a recording of the scene's robot.

    Raises:
        DeviceError: It is not available, or of another shape than the scene's own.
    """
    open_it = partial(
        build_device, asked.robot, asked.patient, asked.points, settings.seed, objects=asked.objects, given=asked.given
    )
    recording = settings.recording or recording_of(asked.robot.device)
    if recording is None:
        check_shape(asked.robot.device, scene)
        plugin = open_it()
        return _OpenDevice(plugin, softened=softened_contacts(scene, asked.robot, plugin))
    run = Run.open(recording)
    descriptor = descriptor_of((scene.first(Robot) or Robot()).device)
    return _OpenDevice(open_it(samples=run.haptic, descriptor=descriptor), recorded=run.session)


def _who_moves(settings: RunSettings, scene: Scene, *, live: bool) -> tuple[Robot, Patient]:
    """Return the robot and the simulated patient of this run: the scene's, with device and preset of the settings.

    In a window the pointer replaces the simulated device. A preset of the settings also takes the place of the person
    that a scene puts into its device.
    """
    robot, patient = scene.first(Robot) or Robot(), scene.first(Patient) or Patient()
    if settings.patient:
        patient = msgspec.structs.replace(patient, preset=settings.patient)
        device_settings = {name: value for name, value in robot.settings.items() if name != _PERSON}
        robot = msgspec.structs.replace(robot, settings=device_settings)
    device = settings.device or (POINTER if live and robot.device == SIMULATED else robot.device)
    return msgspec.structs.replace(robot, device=device), patient
