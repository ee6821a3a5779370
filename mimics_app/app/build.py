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

from mimics_app.app.parameter_desk import ParameterDesk
from mimics_app.app.scene_loading import load_checked_scene
from mimics_app.app.session import Session
from mimics_app.app.settings import RunSettings
from mimics_app.contracts.clock import Clock, MonotonicClock, VirtualClock
from mimics_app.contracts.session_memory import SessionMemory
from mimics_app.contracts.stages import Learning
from mimics_app.dsp.stage import NullDsp
from mimics_app.estimation.stage import NullEstimation
from mimics_app.inputs.interaction.simulated_patient import SimulatedPatient
from mimics_app.inputs.stage import Inputs
from mimics_app.learning.action_sequence import load_action_sequence
from mimics_app.learning.stage import NullLearning
from mimics_app.recording.recorder import Recorder
from mimics_app.recording.run_folder import create_run_folder
from mimics_app.rendering.haptic import scheduler
from mimics_app.rendering.haptic.devices.registry import build_device
from mimics_app.rendering.haptic.engine import HapticEngine
from mimics_app.scenarios.catalogue import open_scenario
from mimics_app.scenarios.scenario import Scenario
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.task_manager import TaskContext, TaskManager
from mimics_app.tasks.trial_file import resolve_trials
from mimics_app.world.components import Sound, SoundEmitter
from mimics_app.world.components_haptic import Patient, Robot
from mimics_app.world.components_systems import AudioSettings as AudioSystem
from mimics_app.world.scene import Scene
from mimics_app.world.scene_file import build_world
from mimics_app.world.world import World

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
    """Load the scene, start the recorder and the sound, build the loop and the stages. Nothing moves yet.

    Raises:
        SceneError: the scene or the action file is wrong.
        DeviceError: the robot cannot be had.
        UsageError: no room for the recording.
    """
    scene = load_checked_scene(settings.scene)
    world = build_world(scene)
    scenario = open_scenario(scene, world)
    with ExitStack() as stack:
        memory = SessionMemory()
        folder = create_run_folder(settings.runs, settings.seconds or 0.0)
        recorder = Recorder(memory, folder, _header(settings, scene, scenario, live=live))
        recorder.start()
        stack.callback(recorder.abandon)
        audio = _open_audio(settings, scene, memory, folder, live=live)
        if audio is not None:
            stack.callback(audio.stop)
        haptics = _build_haptics(settings, scene, scenario, memory, live=live)
        stack.callback(haptics.stop)
        desk = ParameterDesk(scenario.scene_block(), recorder.parameters, haptics.publish)
        tasks = TaskManager(
            resolve_trials(_task_of(scene), scene.path.parent, scene.root),
            TaskContext(scenario.start_joints),
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
            memory=memory,
            clock=_clock(live=live),
            desk=desk,
            haptics=haptics,
            tasks=tasks,
            inputs=Inputs([SimulatedPatient(intent=_intent(scene))]),
            dsp=NullDsp(),
            estimation=NullEstimation(),
            learning=_learning(settings, tasks),
            recorder=recorder,
            folder=folder,
            audio=audio,
        )
        session.on_close = stack.pop_all()
    desk.announce()
    return session


def start_loop(session: Session) -> str:
    """Start the live haptic loop and make way for it; the recipe granted, in words."""
    granted = session.haptics.start()
    if granted.lower_main:
        scheduler.lower_this_thread()
    session.recorder.journal("scheduler", {"recipe": granted.recipe})
    return granted.recipe


def _clock(*, live: bool) -> Clock:
    return MonotonicClock() if live else VirtualClock()


def _task_of(scene: Scene) -> TaskSpec:
    task = scene.sections.get("task")
    return task if isinstance(task, TaskSpec) else TaskSpec()


def _intent(scene: Scene) -> bool:
    patients = scene.components(Patient)
    return patients[0][1].intent if patients else True


def _learning(settings: RunSettings, tasks: TaskManager) -> Learning:
    if settings.action is None:
        return NullLearning()
    return load_action_sequence(settings.action, tasks.action_space)


def _build_haptics(
    settings: RunSettings, scene: Scene, scenario: Scenario, memory: SessionMemory, *, live: bool
) -> HapticEngine:
    robots, patients = scene.components(Robot), scene.components(Patient)
    robot = robots[0][1] if robots else Robot()
    patient = patients[0][1] if patients else Patient()
    if settings.patient:
        patient = msgspec.structs.replace(patient, preset=settings.patient)
    device = settings.device or (_POINTER if live and robot.device == _SIMULATED else robot.device)
    robot = msgspec.structs.replace(robot, device=device)
    plugin = build_device(robot, patient, scenario.via_points_world, settings.seed)
    return HapticEngine(memory, plugin, recipe=settings.recipe)


def _open_audio(
    settings: RunSettings, scene: Scene, memory: SessionMemory, folder: Path, *, live: bool
) -> AudioOutput | None:
    """The scene's sound, opening; None without imports where there is none."""
    sounds = scene.components(Sound)
    wanted = scene.systems.get("audio")
    wanted = wanted if isinstance(wanted, AudioSystem) else AudioSystem()
    if not sounds or not wanted.enabled or settings.sound == "off":
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
        hrtf=wanted.hrtf,
    )
    if chosen is None:
        return None
    audio: AudioOutput = AudioProcess(memory, chosen) if live else OfflineAudio(memory, chosen)
    audio.start()
    audio.master(wanted.gain)
    return audio


def _header(settings: RunSettings, scene: Scene, scenario: Scenario, *, live: bool) -> dict[str, Any]:
    """What the recording keeps about the session."""
    chosen = {name: str(value) if isinstance(value, Path) else value for name, value in asdict(settings).items()}
    return {
        "scene": {"name": scene.name, "file": str(scene.path), "hash": scene.hash, "document": scene.document},
        "seed": settings.seed,
        "profile": settings.profile,
        "live": live,
        "settings": chosen,
        "facts": scenario.facts,
    }
