"""Messages between the stages of D2.1 Figure 1: one frozen type per arrow, left to right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.commands.vocabulary import Command, Reply
from mimics_app.contracts.loop.loop_fields import HapticSnapshot
from mimics_app.contracts.messages.board import Board
from mimics_app.contracts.messages.head_place import HeadPlace
from mimics_app.contracts.messages.orders import Feature, HapticOrder, VisualOrder
from mimics_app.contracts.messages.trial_state import TaskView

__all__ = [
    "GAIN",
    "Aim",
    "AudioOrder",
    "Estimate",
    "Experience",
    "FeatureFrame",
    "HapticSnapshot",
    "PointTarget",
    "PointerState",
    "SignalBlock",
    "SoundEvent",
    "SoundTrigger",
    "TactileEvent",
    "TactileOrder",
    "TaskAction",
    "TaskOrders",
    "TrialResult",
    "UserState",
    "VRInput",
]


@dataclass(frozen=True, slots=True)
class PointTarget:
    """Target of one point of contact [m], and grasp force there [N]."""

    target_world: Vec3
    grasp: float


@dataclass(frozen=True, slots=True)
class PointerState:
    """State of a pointing device in one frame.

    Attributes:
        target_world: Target of the first point of contact [m].
        grasp: Grasp force there [N].
        active: Whether it is held.
        further: Targets of the points of contact after the first; one without a target moves beside the first.
    """

    target_world: Vec3
    grasp: float
    active: bool
    further: tuple[PointTarget, ...] = ()


@dataclass(frozen=True, slots=True)
class Aim:
    """Next action of the hand in the scene.

    Attributes:
        target_world: Target of the hand [m].
        close: True if the hand closes, or stays closed.
        further: The same for the points of contact after the first; one without a target moves beside the first.
        strain: Force of a closing hand: 0 usual, 1 all the person's strength.
    """

    target_world: Vec3
    close: bool
    further: tuple[Aim, ...] = ()
    strain: float = 0.0


@dataclass(frozen=True, slots=True)
class SignalBlock:
    """Raw samples of one signal: values [shape n] at `rate` [Hz], the first at `t_ns`; NaN: missing.

    Body signals are "ecg" [mV], "gsr" [uS], "emg" [mV], "resp" [any unit]; of the movement "speed" [m/s] and
    "power" [W] of the hand, or "speed" of the belt and "leg_power" [W], and "head" [rad/s].
    """

    name: str
    rate: float
    t_ns: int
    values: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class VRInput:
    """Inputs of one frame: body signals for the DSP, pointer and keys for the task.

    Attributes:
        signals: Blocks received since the last frame.
        pointer: The pointing device, or None.
        pressed: Names of keys and buttons pressed since the last frame (see contracts.messages.window_input), in order.
        commands: Commands for the task, in the order in which they were given.
        head: The person's tracked head; None: not tracked.
    """

    signals: tuple[SignalBlock, ...] = ()
    pointer: PointerState | None = None
    pressed: tuple[str, ...] = ()
    commands: tuple[Command, ...] = ()
    head: HeadPlace | None = None


@dataclass(frozen=True, slots=True)
class FeatureFrame:
    """Features of the signals at one time.

    Attributes:
        t_ns: Time up to which they are computed; the same frame is repeated until there is a newer one.
        values: Features by name, e.g. {"heart_rate": 72.0}; unknown ones are missing.
        quality: Quality of each signal by name, 0 (useless) to 1.
    """

    t_ns: int
    values: Mapping[str, float] = field(default_factory=dict)
    quality: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Estimate:
    """Estimate of one quantity."""

    mean: float
    variance: float


@dataclass(frozen=True, slots=True)
class UserState:
    """Estimated state of the person; None for unknown quantities.

    Attributes:
        t_ns: Time of the features.
        arousal: Arousal in [-1, 1], 0 at rest in the calibration.
        valence: Valence in [-1, 1].
        effort: Physical effort in [-1, 1], 0 at rest.
        load: Probabilities that the task underchallenges, challenges and overchallenges the person, summing to 1.
        quality: Quality of the signals, 0 to 1.
    """

    t_ns: int
    arousal: Estimate | None = None
    valence: Estimate | None = None
    effort: Estimate | None = None
    load: tuple[float, float, float] | None = None
    quality: float = 0.0


@dataclass(frozen=True, slots=True)
class TrialResult:
    """Result of a trial, reported in the frame in which it ends.

    Attributes:
        trial: Number of the trial, from 0.
        t_ns: End of the trial.
        outcome: "finished" or "timeout"; "step" for a step inside a trial.
        performance: 0 to 1: the score as a share, else whether the goal was reached.
        reward: Reward defined by the task, for a learning system with the task's goal.
        practice: True for a practice trial, which does not count.
        values: Values of the adaptable parameters during the trial.
        observed: Observations of the task by name, for actions per step; only with outcome "step".
    """

    trial: int
    t_ns: int
    outcome: str
    performance: float
    reward: float
    practice: bool = False
    values: Mapping[str, float] = field(default_factory=dict)
    observed: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Experience:
    """Experience of a person in one frame: the movement and the demand of the task.

    Attributes:
        t_ns: Time of the frame.
        speed: Speed of the hand, or of the treadmill's belt [m/s].
        power: Mechanical power from the person into the robot [W]; negative power counts as 0.
        legs: Whether the person walks in a gait orthosis: `power` is that of both legs.
        head: room_from_head, float64 [4, 4]; None: not tracked in this frame.
        demand: Difficulty of the task, 0 to 1 within the range of its parameters; None: not known.
        acting: True while the person may act.
        result: Result of a trial that ended in this frame.
    """

    t_ns: int
    speed: float = 0.0
    power: float = 0.0
    legs: bool = False
    head: NDArray[np.float64] | None = None
    demand: float | None = None
    acting: bool = False
    result: TrialResult | None = None


@dataclass(frozen=True, slots=True)
class TaskAction:
    """One adaptation of a task: new values of named, limited parameters, e.g. {"radius": 1.2}.

    Attributes:
        values: New values by parameter name; parameters not named stay as they are.
        at_trial: Trial (from 0) at whose start the values apply; None: at once.
        propensity: Probability, or density of a continuous action, with which the policy chose this; 1: deterministic.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    at_trial: int | None = None
    propensity: float = 1.0


@dataclass(frozen=True, slots=True)
class SoundEvent:
    """A sound to start.

    Attributes:
        sound: Name of a sound of the scene.
        t_ns: Time of the sound, on the session's clock.
        position_world: Position [m], or None to play it at the listener.
        gain: Linear gain, 1 = as authored.
    """

    sound: str
    t_ns: int
    position_world: Vec3 | None = None
    gain: float = 1.0


@dataclass(frozen=True, slots=True)
class SoundTrigger:
    """An event that may have a sound, which the scene assigns by kind and material.

    Attributes:
        kind: Such as "step", "kick", "goal"; events of the haptic loop have their own ring.
        t_ns: Time of the event, on the session's clock.
        position_world: Position [m], or None to play it at the listener.
        material: Such as "grass"; "" if it does not matter.
        strength: Linear factor on the sound's level, 1 = as authored.
    """

    kind: str
    t_ns: int
    position_world: Vec3 | None = None
    material: str = ""
    strength: float = 1.0


@dataclass(frozen=True, slots=True)
class TactileEvent:
    """A tap of a vibrator.

    Attributes:
        place: Place of the body, e.g. "back"; the session assigns the vibrator.
        t_ns: Time of the tap, on the session's clock; up to a frame ahead.
        strength: 0 to 1.
        seconds: Duration [s].
        number: Number of the tap, for the journal.
    """

    place: str
    t_ns: int
    strength: float = 1.0
    seconds: float = 0.05
    number: int = 0


GAIN = Feature("gain", 1.0)
"""Linear gain of all sound, 1 = as authored: the one feature of the mixer."""


@dataclass(frozen=True, slots=True)
class AudioOrder:
    """Orders to the sound.

    Attributes:
        gain: New value of `GAIN`; None: unchanged.
        sounds: Sounds to start.
        cues: Events of the task's kind whose sounds the scene assigns.
    """

    gain: float | None = None
    sounds: tuple[SoundEvent, ...] = ()
    cues: tuple[SoundTrigger, ...] = ()


@dataclass(frozen=True, slots=True)
class TactileOrder:
    """Orders to the vibrators.

    Attributes:
        taps: Taps, each with its time.
    """

    taps: tuple[TactileEvent, ...] = ()


@dataclass(frozen=True, slots=True)
class TaskOrders:
    """Orders of the task manager to the renderers for one frame.

    Attributes:
        haptic: New numbers of the haptic scene.
        visual: New values of the scenario's features.
        audio: Gain, and sounds to start.
        tactile: Taps of vibrators.
        view: State of the task.
        board: Heads-up display.
        person_may_act: True while the pointer or the simulated person may move the robot (INBOX.active).
        finished: True when the last trial is over.
        result: Result of the trial that ended in this frame.
        demand: Difficulty by the adaptable parameters, 0 to 1; None if none of them affects it.
        replies: What became of each of the frame's commands, in their order.
    """

    haptic: HapticOrder = field(default_factory=HapticOrder)
    visual: VisualOrder = field(default_factory=VisualOrder)
    audio: AudioOrder = field(default_factory=AudioOrder)
    tactile: TactileOrder = field(default_factory=TactileOrder)
    view: TaskView = field(default_factory=TaskView)
    board: Board = field(default_factory=Board)
    person_may_act: bool = False
    finished: bool = False
    result: TrialResult | None = None
    demand: float | None = None
    replies: tuple[Reply, ...] = ()
