"""What flows between the stages of D2.1 Figure 1: one frozen message per arrow, left to right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.board import Board
from mimics_app.contracts.loop_fields import HapticSnapshot
from mimics_app.contracts.trial_state import TaskView

__all__ = [
    "Aim",
    "FeatureFrame",
    "HapticSnapshot",
    "PointerState",
    "SignalBlock",
    "SoundEvent",
    "SoundTrigger",
    "TactileEvent",
    "TaskAction",
    "TaskOrders",
    "UserState",
    "VRInput",
]

Vec3 = tuple[float, float, float]


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
    """Raw samples of one body signal: values [shape n] at `rate` [Hz], the first at `t_ns`."""

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
    """Features of the body signals at one time, by name, e.g. {"heart_rate": 72.0}."""

    t_ns: int
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class UserState:
    """Estimated state of the person, each in [0, 1], None where nothing is known."""

    t_ns: int
    arousal: float | None = None
    valence: float | None = None
    effort: float | None = None


@dataclass(frozen=True, slots=True)
class TaskAction:
    """One adaptation of a task: new values of named, limited parameters, e.g. {"radius": 1.2}.

    Attributes:
        values: New values by parameter name; parameters not named stay as they are.
        at_trial: Number of the trial (0 first) whose beginning the values wait for; None: from now on.
    """

    values: Mapping[str, float] = field(default_factory=dict)
    at_trial: int | None = None


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
        kind: Such as "step", "kick", "goal"; those of the haptic loop go their own way.
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
