"""Motion capture in BVH files: a skeleton and its angles frame by frame, retargeted to the bones of a model.

The format has no specification but the description of Biovision (1996): offsets and channels of each joint, then
one line of numbers per frame. The file does not state its unit: the height of the hips sets the scale.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.contracts.system.read_budget import afford, over_budget
from mimics_app.world.content.motion.clip import Clip, clip_of_poses
from mimics_app.world.content.motion.humanoid import HumanoidMap, find_humanoid
from mimics_app.world.content.motion.pose import Pose
from mimics_app.world.content.motion.retarget import Retarget
from mimics_app.world.content.motion.rig import Rig
from mimics_app.world.files.reading.file_bytes import read_bytes

__all__ = ["MotionCapture", "capture_clip", "read_bvh"]


_MAX_BYTES = 64 * 1024 * 1024
_MAX_JOINTS, _MAX_FRAMES = 1000, 1_000_000
_JOINT_BYTES = 56
"""Memory of a joint in a frame: rotation and translation."""
_MAX_NUMBER = 1e9
"""Bound of all numbers, far beyond any angle or length: products of a few stay finite in single precision."""
_AXES = {"Xrotation": 0, "Yrotation": 1, "Zrotation": 2}
_SHIFTS = {"Xposition": 0, "Yposition": 1, "Zposition": 2}


@dataclass(frozen=True, eq=False)
class MotionCapture:
    """A recorded motion.

    Attributes:
        rig: The recorded skeleton, without entities.
        seconds: Duration of a frame [s].
        rotations: Local rotations xyzw, [frames, joints, 4].
        translations: Local translations in the file's unit, [frames, joints, 3].
    """

    rig: Rig
    seconds: float
    rotations: F8
    translations: F8


@dataclass
class _Joint:
    name: str
    parent: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    channels: tuple[str, ...] = ()
    end: bool = False


def read_bvh(path: Path) -> MotionCapture:
    """Read a BVH file.

    Raises:
        SceneError: it cannot be read, or is not a BVH file; the pointer is the line.
    """
    text = read_bytes(path, str(path), _MAX_BYTES).decode("utf-8", errors="replace")
    return _Reader(str(path), text.splitlines()).read()


def capture_clip(capture: MotionCapture, name: str, target: Rig, bones: HumanoidMap) -> tuple[Clip, list[str]]:
    """Retarget a recording to a model; return the clip and a report of the mapping.

    Args:
        capture: The recording.
        name: Name of the clip.
        target: Nodes of the model.
        bones: Bones of the model.

    Raises:
        ValueError: the recorded skeleton is not humanoid, or the model has too many nodes for so many frames.
    """
    found = find_humanoid(capture.rig)
    if found.missing:
        raise ValueError(f"the recorded skeleton has no {', '.join(found.missing)}")
    frames = len(capture.rotations)
    if what := over_budget(frames * len(target.names) * _JOINT_BYTES):
        raise ValueError(f"{frames} frames of {len(target.names)} nodes {what}")
    retarget = Retarget(capture.rig, found, target, bones)
    pose = target.rest.copy()
    rotations = np.zeros((frames, len(target.names), 4))
    places = np.zeros((frames, 3))
    for k in range(frames):
        retarget.apply(capture.rotations[k], capture.translations[k], pose)
        rotations[k], places[k] = pose.rotations, pose.translations[bones.slots["hips"]]
    moved = [bones.slots[bone] for bone in bones.slots if bone in found.slots]
    clip = clip_of_poses(name, capture.seconds, rotations, places, moved, bones.slots["hips"])
    return clip, [*found.guesses, *retarget.report]


class _Reader:
    """Parser of the lines of a file."""

    def __init__(self, file: str, lines: list[str]) -> None:
        self._file, self._lines, self._at = file, lines, 0
        self._joints: list[_Joint] = []

    def read(self) -> MotionCapture:
        if self._next() != ["HIERARCHY"]:
            self._fail("is not a BVH file: it does not begin with HIERARCHY")
        self._read_joints()
        frames = self._numbers(self._labelled("Frames:"), 1)[0]
        seconds = self._numbers(self._labelled("Frame", "Time:"), 1)[0]
        if not (1 <= frames <= _MAX_FRAMES and 0.0 < seconds < 10.0):
            self._fail(f"{frames:g} frames of {seconds:g} s are out of range")
        width, count = sum(len(joint.channels) for joint in self._joints), int(frames)
        fix = "cut the recording, or leave out joints"
        afford(self._file, f"line {self._at}", count * (_JOINT_BYTES * len(self._joints) + 8 * width), fix)
        if count > len(self._lines) - self._at:
            self._fail(f"ends too early: {len(self._lines) - self._at} lines for {count} frames")
        values = np.empty((count, width))
        for row in values:
            row[:] = self._numbers(self._next(), width)
        return self._capture(values, seconds)

    def _read_joints(self) -> None:
        """Read the tree without recursion; end sites become joints without channels."""
        above: list[int] = []
        while (words := self._next()) != ["MOTION"]:
            if words[0] in ("ROOT", "JOINT", "End"):
                if len(self._joints) >= _MAX_JOINTS:
                    self._fail(f"more than {_MAX_JOINTS} joints")
                name = " ".join(words[1:]) if words[0] != "End" else ""
                self._joints.append(_Joint(name, above[-1] if above else -1, end=words[0] == "End"))
            elif words[0] == "{":
                above.append(len(self._joints) - 1)
            elif words[0] == "}" and above:
                above.pop()
            elif words[0] == "OFFSET" and self._joints:
                x, y, z = self._numbers(words[1:], 3)
                self._joints[-1].offset = (x, y, z)
            elif words[0] == "CHANNELS" and self._joints:
                self._joints[-1].channels = self._channels(words[1:])
            else:
                self._fail(f'"{" ".join(words)[:40]}" is not understood')
        if above or not self._joints:
            self._fail("the braces of its joints do not match")

    def _channels(self, words: list[str]) -> tuple[str, ...]:
        count = self._numbers(words[:1], 1)[0]
        names = tuple(words[1:])
        if len(names) != count or any(name not in _AXES and name not in _SHIFTS for name in names):
            self._fail("its channels differ from their number, or have other names than Xposition, Zrotation ...")
        return names

    def _capture(self, values: F8, seconds: float) -> MotionCapture:
        joints = self._joints
        frames, count = len(values), len(joints)
        rotations = np.tile([0.0, 0.0, 0.0, 1.0], (frames, count, 1))
        translations = np.tile(np.array([joint.offset for joint in joints]), (frames, 1, 1))
        column = 0
        for k, joint in enumerate(joints):
            for channel in joint.channels:
                if channel in _SHIFTS:
                    translations[:, k, _SHIFTS[channel]] = values[:, column]
                else:
                    rotations[:, k] = _turned(rotations[:, k], _AXES[channel], np.radians(values[:, column]))
                column += 1
        rest = Pose(
            np.array([joint.offset for joint in joints]),
            np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)),
            np.ones((count, 3)),
            np.zeros(0),
        )
        rest.translations[0] = self._standing_root()
        names = tuple(joint.name for joint in joints)
        parents = np.array([joint.parent for joint in joints], np.int32)
        rig = Rig(names, np.full(count, -1, np.int32), parents, rest, np.zeros(count + 1, np.int32), ())
        return MotionCapture(rig, seconds, rotations, translations)

    def _standing_root(self) -> tuple[float, float, float]:
        """Return the root's position with the lowest joint on the ground: most files have the root at the origin."""
        heights = np.zeros(len(self._joints))
        for k, joint in enumerate(self._joints):
            heights[k] = (heights[joint.parent] + joint.offset[1]) if joint.parent >= 0 else 0.0
        return 0.0, -float(heights.min()), 0.0

    def _next(self) -> list[str]:
        """Return the words of the next line that is not empty."""
        while self._at < len(self._lines):
            words = self._lines[self._at].split()
            self._at += 1
            if words:
                return words
        self._fail("ends too early")
        return []

    def _labelled(self, *label: str) -> list[str]:
        words = self._next()
        if tuple(words[: len(label)]) != label:
            self._fail(f'"{" ".join(label)}" is missing')
        return words[len(label) :]

    def _numbers(self, words: list[str], count: int) -> list[float]:
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            numbers = []
        if len(numbers) != count or not all(abs(number) <= _MAX_NUMBER for number in numbers):
            self._fail(f"{count} numbers are required, none above {_MAX_NUMBER:g}")
        return numbers

    def _fail(self, what: str) -> None:
        raise SceneError(Issue(self._file, f"line {self._at}", what))


def _turned(q: F8, axis: int, angles: F8) -> F8:
    """Append rotations about a local axis: channels apply in the order they are written."""
    turn = np.zeros_like(q)
    turn[:, axis], turn[:, 3] = np.sin(0.5 * angles), np.cos(0.5 * angles)
    vector = q[:, 3:] * turn[:, :3] + turn[:, 3:] * q[:, :3] + np.cross(q[:, :3], turn[:, :3])
    scalar = q[:, 3:] * turn[:, 3:] - np.sum(q[:, :3] * turn[:, :3], axis=1, keepdims=True)
    return np.concatenate([vector, scalar], axis=1)
