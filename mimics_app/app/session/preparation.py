"""Parts of a session before anything starts: faults of files and devices are found here."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import msgspec
from numpy.typing import NDArray

from mimics_app.app.planner.plan import Plan, settle
from mimics_app.app.scenes.catalogue import open_scenario
from mimics_app.app.scenes.loading import check_scene
from mimics_app.app.session.asked import as_long_as_asked, read_asked
from mimics_app.app.session.body import Body, open_body
from mimics_app.app.settings import RunSettings
from mimics_app.app.touch.device_fit import check_shape, fit_context
from mimics_app.app.touch.haptic_side import HapticSide
from mimics_app.app.touch.parameter_store import ParameterStore
from mimics_app.contracts.loop_ports import DevicePlugin
from mimics_app.contracts.scenario_port import Scenario, TaskContext
from mimics_app.recording.run import Run
from mimics_app.rendering.haptic.devices.described import descriptor_of
from mimics_app.rendering.haptic.devices.device_names import POINTER, SIMULATED
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.tasks.actions import fill_defaults
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.tailoring import eased
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_file import resolve_files
from mimics_app.world.components.robot import Patient, Robot
from mimics_app.world.scene.file import build_world
from mimics_app.world.scene.scene import Scene
from mimics_app.world.world import World

__all__ = ["Preparation", "prepare", "prepare_scene"]


@dataclass(frozen=True, slots=True, eq=False)
class Preparation:
    """The parts.

    Attributes:
        settings: What was requested.
        live: True when the haptic loop will run in real time.
        scene: The checked scene, its plan settled.
        plan: Which methods run, and why.
        world: Built from the scene.
        scenario: What plays it.
        side: What of it can be touched.
        parameter_store: Its haptic parameters.
        task: The task, its trial file read and its parameters' defaults taken from the scene.
        body: Signals of the person, their state, and what chooses the task's actions.
        robot: The scene's, with the device of this run.
        patient: The scene's, with the preset of this run.
        plugin: The device, open: whoever has the parts closes it.
    """

    settings: RunSettings
    live: bool
    scene: Scene
    plan: Plan
    world: World
    scenario: Scenario
    side: HapticSide
    parameter_store: ParameterStore
    task: TaskSpec
    body: Body
    robot: Robot
    patient: Patient
    plugin: DevicePlugin

    @property
    def context(self) -> TaskContext:
        """Context of the task: the scene, the device, and the person or simulated patient."""
        context = fit_context(self.scenario.task_context, self.plugin)
        return replace(
            context,
            simulated=not self.live,
            by_pointer=self.robot.device == POINTER,
            introduced=self.live and self.settings.journey is not None,
        )


def prepare(settings: RunSettings, *, live: bool, read: Scene | None = None) -> Preparation:
    """Read the scene, plan it, and open the device. Nothing moves, no process runs, and nothing is written.

    A device with a time of its own makes the session live, whatever was requested.

    Args:
        settings: What was asked for.
        live: Whether the haptic loop is to run in real time.
        read: What `read_asked` gave for these settings; None: it is asked here.

    Raises:
        SceneError: the scene, the action file or the file of the display is wrong.
        UsageError: the session has no such trial.
        DeviceError: the robot cannot be had.
    """
    return prepare_scene(check_scene(read or read_asked(settings)), settings, live=live)


def prepare_scene(scene: Scene, settings: RunSettings, *, live: bool = False, plan: Plan | None = None) -> Preparation:
    """As `prepare`, of a checked scene that is there already.

    Args:
        scene: What is played.
        settings: What was requested.
        live: Whether the haptic loop is to run in real time.
        plan: What runs; None: what the planner chooses for the profile.

    Raises:
        SceneError: the action file is wrong.
        DeviceError: the robot cannot be had.
    """
    plan = settle(scene, settings.profile, plan)
    world = build_world(scene)
    world.effects.seed = settings.seed
    scenario = open_scenario(scene, world)
    side = HapticSide(scene)
    store = side.parameter_store(scenario.scene_block())
    task = fill_defaults(resolve_files(task_of(scene), scene.path.parent, scene.root), store.value)
    task = as_long_as_asked(eased(task, settings.difficulty), settings)
    robot, patient = _who_moves(settings, scene, live=live)
    body = open_body(settings, task, patient.preset)
    points, objects = scenario.via_points_world, side.for_robot(robot)
    recorded = _recorded(settings)
    if recorded is None:
        check_shape(robot.device, scene)
    descriptor = None if recorded is None else descriptor_of((scene.first(Robot) or Robot()).device)
    plugin = build_device(
        robot, patient, points, settings.seed, samples=recorded, descriptor=descriptor, objects=objects
    )
    return Preparation(
        settings=settings,
        live=live or plugin.real_time,
        scene=scene,
        plan=plan,
        world=world,
        scenario=scenario,
        side=side,
        parameter_store=store,
        task=task,
        body=body,
        robot=robot,
        patient=patient,
        plugin=plugin,
    )


def _who_moves(settings: RunSettings, scene: Scene, *, live: bool) -> tuple[Robot, Patient]:
    """The robot and the simulated person of this run: the scene's, with what the settings say over it.

    A person at a window takes the place of the simulated one.
    """
    robot, patient = scene.first(Robot) or Robot(), scene.first(Patient) or Patient()
    if settings.patient:
        patient = msgspec.structs.replace(patient, preset=settings.patient)
    device = settings.device or (POINTER if live and robot.device == SIMULATED else robot.device)
    return msgspec.structs.replace(robot, device=device), patient


def _recorded(settings: RunSettings) -> NDArray[Any] | None:
    """Samples for the replay device, where a recording was named."""
    return None if settings.recording is None else Run.open(settings.recording).haptic
