"""Builds a session: processes first, then the haptic loop, then the picture.

Spawned children inherit the niceness of the moment, and a software renderer's workers that of the thread that makes the
GL context; so the order here is what keeps the haptic loop in time.
"""

from __future__ import annotations

import os
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from numpy.typing import NDArray

from mimics_app.app.catalogue import open_scenario
from mimics_app.app.device_fit import device_values, fit_context
from mimics_app.app.explain import describe_plan
from mimics_app.app.haptic_side import HapticSide
from mimics_app.app.person import simulated_person
from mimics_app.app.plan import Plan, settle
from mimics_app.app.scene_loading import load_checked_scene
from mimics_app.app.session import Session
from mimics_app.app.settings import RunSettings
from mimics_app.app.sound_stage import SoundStage
from mimics_app.contracts.clock import MonotonicClock, VirtualClock
from mimics_app.contracts.scenario_port import Scenario
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.contracts.stages import Learning
from mimics_app.dsp.stage import NullDsp
from mimics_app.estimation.stage import NullEstimation
from mimics_app.inputs.stage import Inputs
from mimics_app.learning.action_sequence import load_action_sequence
from mimics_app.learning.stage import NullLearning
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.run import Run
from mimics_app.recording.run_folder import create_run_folder
from mimics_app.recording.statics import write_statics
from mimics_app.rendering.haptic import scheduler
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.tasks.actions import build_action_space, fill_defaults
from mimics_app.tasks.scene_section import task_of
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskManager
from mimics_app.tasks.trial_file import resolve_trials
from mimics_app.world.components.robot import Patient, Robot, Safety
from mimics_app.world.components.systems import AudioSettings as AudioSystem
from mimics_app.world.components.visible import Sound, SoundEmitter
from mimics_app.world.scene.file import build_world
from mimics_app.world.scene.scene import Scene

if TYPE_CHECKING:
    from mimics_app.contracts.audio_port import AudioOutput

__all__ = ["build_session", "has_display", "start_loop"]

_SIMULATED = "simulated_hapticmaster"
_POINTER = "pointer"
"""A person at a window takes the place of the simulated one."""


def has_display() -> bool:
    """Whether a window can be hoped for."""
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def build_session(settings: RunSettings, *, live: bool) -> Session:
    """Load the scene, build the loop and the stages, start the recorder and the sound. Nothing moves yet.

    A device with a time of its own makes the session live, whatever was asked for.

    What can be wrong with files and devices is found before the first process starts and the run folder is made.

    Raises:
        SceneError: the scene or the action file is wrong.
        DeviceError: the robot cannot be had.
        UsageError: no room for the recording.
    """
    scene = load_checked_scene(settings.scene)
    plan = settle(scene, settings.profile)
    world = build_world(scene)
    world.effects.seed = settings.seed
    scenario = open_scenario(scene, world)
    side = HapticSide(scene)
    desk = side.desk(scenario.scene_block())
    spec = fill_defaults(resolve_trials(task_of(scene), scene.path.parent, scene.root), desk.value)
    learning = _learning(settings, spec)
    robot, patient = _who_moves(settings, scene, live=live)
    plugin = build_device(
        robot,
        patient,
        scenario.via_points_world,
        settings.seed,
        samples=_recorded(settings),
        objects=side.for_robot(robot),
    )
    live = live or plugin.real_time
    with ExitStack() as stack:
        stack.callback(plugin.close)
        desk.change(device_values(plugin, scene))
        memory = side.memory()
        folder = create_run_folder(settings.runs, settings.seconds or 0.0)
        recorder = Recorder(memory, folder, _header(settings, scene, scenario, plan, robot, patient, live=live))
        write_statics(folder, side.statics)
        recorder.start(wait=False)
        stack.callback(recorder.abandon)
        sound = _open_sound(settings, scene, memory, folder, live=live)
        if sound is not None:
            stack.callback(sound.stop)
        haptics = side.engine(memory, plugin, recipe=settings.recipe)
        stack.callback(haptics.stop)
        tasks = TaskManager(
            spec,
            fit_context(scenario.task_context, plugin),
            settings.seed,
            on_trial=recorder.trial,
            on_event=recorder.journal,
        )
        session = Session(
            settings=settings,
            live=live,
            scene=scene,
            world=world,
            scenario=scenario,
            side=side,
            memory=memory,
            clock=MonotonicClock() if live else VirtualClock(),
            desk=desk,
            haptics=haptics,
            tasks=tasks,
            inputs=Inputs([simulated_person(scene, scenario)]),
            dsp=NullDsp(),
            estimation=NullEstimation(),
            learning=learning,
            recorder=recorder,
            folder=folder,
            sound=sound,
        )
        recorder.wait_until_ready()
        session.on_close = stack.pop_all()
    desk.hand_to(recorder.parameters, haptics.publish)
    return session


def start_loop(session: Session) -> str:
    """Start the live haptic loop and make way for it; the recipe granted, in words."""
    granted = session.haptics.start()
    if granted.lower_main:
        scheduler.lower_this_thread()
    session.recorder.journal("scheduler", {"recipe": granted.recipe})
    return granted.recipe


def _learning(settings: RunSettings, spec: TaskSpec) -> Learning:
    if settings.action is None:
        return NullLearning()
    return load_action_sequence(settings.action, build_action_space(spec))


def _who_moves(settings: RunSettings, scene: Scene, *, live: bool) -> tuple[Robot, Patient]:
    """The robot and the simulated person of this run: the scene's, with what the settings say over it."""
    robots, patients = scene.components(Robot), scene.components(Patient)
    robot = robots[0][1] if robots else Robot()
    patient = patients[0][1] if patients else Patient()
    if settings.patient:
        patient = msgspec.structs.replace(patient, preset=settings.patient)
    device = settings.device or (_POINTER if live and robot.device == _SIMULATED else robot.device)
    return msgspec.structs.replace(robot, device=device), patient


def _recorded(settings: RunSettings) -> NDArray[Any] | None:
    """Samples for the replay device, where a recording was named."""
    return None if settings.recording is None else Run.open(settings.recording).haptic


def _open_sound(
    settings: RunSettings, scene: Scene, memory: SessionMemory, folder: Path, *, live: bool
) -> SoundStage | None:
    """The scene's sound, opening; None without imports where there is none."""
    sounds = scene.components(Sound)
    wanted = scene.systems.get("audio")
    system = wanted if isinstance(wanted, AudioSystem) else AudioSystem()
    if not sounds or not system.enabled or settings.sound == "off":
        return None
    from mimics_app.rendering.audio.offline import OfflineAudio
    from mimics_app.rendering.audio.process import AudioProcess
    from mimics_app.rendering.audio.scene_sounds import settings_from_components

    sink = "file" if settings.sound == "file" or not live else "device"
    chosen = settings_from_components(
        sounds,
        scene.components(SoundEmitter),
        lambda name: scene.assets[name].path,
        str(scene.path),
        sink=sink,
        file=folder / "sound.wav",
        hrtf=_heard_about_the_head(scene, system),
    )
    if chosen is None:
        return None
    output: AudioOutput = AudioProcess(memory, chosen) if live else OfflineAudio(memory, chosen)
    output.start()
    return SoundStage(output, chosen.cues, chosen.emitters, system.gain)


def _heard_about_the_head(scene: Scene, system: AudioSystem) -> bool:
    """Whether sounds are placed about the head: as the scene says, else as planned."""
    return scene.methods.get("spatialiser", "hrtf") == "hrtf" if system.hrtf == "auto" else system.hrtf


def _header(
    settings: RunSettings,
    scene: Scene,
    scenario: Scenario,
    plan: Plan,
    robot: Robot,
    patient: Patient,
    *,
    live: bool,
) -> dict[str, Any]:
    """What the recording keeps about the session."""
    safety = scene.components(Safety)
    person = (
        {"person": "at the pointer"} if robot.device == _POINTER else {"person": "simulated", "preset": patient.preset}
    )
    chosen = {name: str(value) if isinstance(value, Path) else value for name, value in asdict(settings).items()}
    return {
        "scene": {"name": scene.name, "file": str(scene.path), "hash": scene.hash, "document": scene.document},
        "seed": settings.seed,
        "profile": settings.profile,
        "live": live,
        "moved_by": {"device": robot.device, **person},
        "safety": msgspec.structs.asdict(safety[0][1] if safety else Safety()),
        "settings": chosen,
        "facts": scenario.facts,
        "plan": describe_plan(scene, plan.without_picture if live else plan),
    }
