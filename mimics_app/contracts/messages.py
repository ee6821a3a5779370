"""What flows between the stages of D2.1 Figure 1: one frozen message per arrow, left to right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import Vec3
from mimics_app.contracts.board import Board
from mimics_app.contracts.loop_fields import HapticSnapshot
from mimics_app.contracts.trial_state import TaskView

__all__ = [
    "LOADS",
    "Aim",
    "Estimate",
    "Experience",
    "FeatureFrame",
    "HapticSnapshot",
    "PointerState",
    "SignalBlock",
    "SoundEvent",
    "SoundTrigger",
    "TactileEvent",
    "TaskAction",
    "TaskOrders",
    "TrialResult",
    "UserState",
    "VRInput",
]


@dataclass(frozen=True, slots=True)
class PointerState:
    """A person's pointing device at one frame: where it points, how hard it grasps, what is pressed."""

    target_world: Vec3
    grasp: float
    active: bool
    stop: bool = False


@dataclass(frozen=True, slots=True)
class Aim:
    """What a person in the scene does next with the hand.

    Attributes:
        target_world: Where the hand goes [m].
        close: The hand closes, or stays closed.
    """

    target_world: Vec3
    close: bool


@dataclass(frozen=True, slots=True)
class SignalBlock:
    """Raw samples of one signal: values [shape n] at `rate` [Hz], the first at `t_ns`; NaN: the sensor gave nothing.

    Body signals are "ecg" [mV], "gsr" [uS], "emg" [mV], "resp" [any unit]; of the movement "speed" [m/s], "power" [W].
    """

    name: str
    rate: float
    t_ns: int
    values: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class VRInput:
    """What the input stage gathered for one frame: body signals to the DSP, the pointer and the keys to the task.

    Attributes:
        signals: Blocks that arrived since the last frame.
        pointer: The pointing device, or None where there is none.
        pressed: Names of keys and buttons that went down since the last frame (see contracts.input_port), in order.
    """

    signals: tuple[SignalBlock, ...] = ()
    pointer: PointerState | None = None
    pressed: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class FeatureFrame:
    """Features of the signals at one time.

    Attributes:
        t_ns: The time up to which they are computed; the same frame comes again until there is a newer one.
        values: By name, e.g. {"heart_rate": 72.0}; what is not known is not there.
        quality: Of each signal by its name, 0 (says nothing) to 1.
    """

    t_ns: int
    values: Mapping[str, float] = field(default_factory=dict)
    quality: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Estimate:
    """What is believed of one quantity."""

    mean: float
    variance: float


LOADS = ("under", "challenged", "over")
"""Classes of the load a task puts on a person, in the order of `UserState.load`."""


@dataclass(frozen=True, slots=True)
class UserState:
    """Estimated state of the person; None where nothing is known.

    Attributes:
        t_ns: Of the features it comes from.
        arousal: In [-1, 1], 0 as at rest in the calibration.
        valence: In [-1, 1].
        effort: Bodily effort, in [-1, 1], 0 at rest.
        load: Probability of each of LOADS, adding up to 1.
        quality: Of the signals it comes from, 0 to 1.
    """

    t_ns: int
    arousal: Estimate | None = None
    valence: Estimate | None = None
    effort: Estimate | None = None
    load: tuple[float, float, float] | None = None
    quality: float = 0.0


@dataclass(frozen=True, slots=True)
class TrialResult:
    """What a trial came to, reported in the frame in which it ends.

    Attributes:
        trial: Its number, 0 first.
        t_ns: When it ended.
        outcome: "finished" or "timeout"; "step" where a step inside a trial ended, not the trial.
        performance: How well it went, 0 to 1: the score's share, else whether the goal was reached.
        reward: What the task itself finds it worth, for a learning system whose goal is the task's.
        practice: Not a trial that counts.
        values: The adaptable parameters as they were.
        observed: What a task that is chosen for step by step sees of itself, by name; only with outcome "step".
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
    """What a person went through in one frame: the movement, and what the task asked of them.

    Attributes:
        t_ns: Of the frame.
        speed: Of the hand [m/s].
        power: Mechanical power the person puts into the robot [W]; what is taken out of it counts as 0.
        demand: How hard the task is, 0 easiest to 1 hardest of what its parameters allow; None: nothing says.
        acting: The person was let act.
        result: Of a trial that ended in this frame.
    """

    t_ns: int
    speed: float = 0.0
    power: float = 0.0
    demand: float | None = None
    acting: bool = False
    result: TrialResult | None = None


@dataclass(frozen=True, slots=True)
class TaskAction:
    """One adaptation of a task: new values of named, limited parameters, e.g. {"radius": 1.2}.

    Attributes:
        values: New values by parameter name; parameters not named stay as they are.
        at_trial: Number of the trial (0 first) whose beginning the values wait for; None: from now on.
        propensity: With which probability, or density where continuous, the policy chose this; 1: it could not but.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    at_trial: int | None = None
    propensity: float = 1.0


@dataclass(frozen=True, slots=True)
class SoundEvent:
    """A sound to start.

    Attributes:
        sound: Name of a sound of the scene.
        t_ns: When it belongs, on the session's clock.
        position_world: Where it is [m], or None to play it at the listener.
        gain: Linear, 1 = as authored.
    """

    sound: str
    t_ns: int
    position_world: Vec3 | None = None
    gain: float = 1.0


@dataclass(frozen=True, slots=True)
class SoundTrigger:
    """Something that happened and may have a sound: which one, the scene says by kind and material.

    Attributes:
        kind: Such as "step", "kick", "goal"; those of the haptic loop have a ring of their own.
        t_ns: When, on the session's clock.
        position_world: Where [m], or None to play it at the listener.
        material: What of, such as "grass"; "" where it does not matter.
        strength: Linear factor on the sound's level, 1 = as authored.
    """

    kind: str
    t_ns: int
    position_world: Vec3 | None = None
    material: str = ""
    strength: float = 1.0


@dataclass(frozen=True, slots=True)
class TactileEvent:
    """A tap to be felt.

    Attributes:
        place: Of the body, e.g. "back"; the session knows which vibrator is there.
        t_ns: When it belongs, on the session's clock; up to a frame ahead.
        strength: 0 to 1.
        seconds: How long it lasts [s].
        number: Of the tap, for the journal.
    """

    place: str
    t_ns: int
    strength: float = 1.0
    seconds: float = 0.05
    number: int = 0


@dataclass(frozen=True, slots=True)
class TaskOrders:
    """What the task manager wants of the renderers for one frame.

    Attributes:
        haptic: New values of SCENE fields by dotted name, e.g. {"tunnel.stiffness": 1500.0}; empty: unchanged.
        visual: New values of named scene parameters, e.g. {"tunnel.radius_scale": 1.2}.
        audio: New values of mixer parameters, e.g. {"gain": 0.5}.
        sounds: Sounds to start.
        touches: Taps to be felt.
        view: How the task stands.
        board: What a person reads over the picture.
        person_may_act: True while the pointer or the simulated person is let through to the robot (INBOX.active).
        finished: True when the last trial is over.
        result: Of the trial that ended in this frame.
        demand: How hard the adaptable parameters make the task, 0 to 1; None where none of them says.
    """

    haptic: Mapping[str, object] = field(default_factory=dict)
    visual: Mapping[str, object] = field(default_factory=dict)
    audio: Mapping[str, object] = field(default_factory=dict)
    sounds: tuple[SoundEvent, ...] = ()
    touches: tuple[TactileEvent, ...] = ()
    view: TaskView = field(default_factory=TaskView)
    board: Board = field(default_factory=Board)
    person_may_act: bool = False
    finished: bool = False
    result: TrialResult | None = None
    demand: float | None = None
