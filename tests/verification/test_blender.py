"""Posed vertices against Blender's evaluation of the same file and time, where a Python with bpy is available.

At a clip's keys both say the same, vertex by vertex. Between keys glTF turns joints along the shortest arc (slerp),
Blender goes straight through the four numbers of the quaternion; with these numbers written into our clip both agree
there too, which shows that nothing else differs.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.viewer.playing import animators_of, play_clip, write_vertices
from mimics_app.app.viewer.shown import open_shown
from mimics_app.contracts.system.resources import root
from mimics_app.world.content.motion.clip import Clip, Interpolation, MotionTrack, TrackPath, pack_clip
from mimics_app.world.files.scene.model_world import load_model_world
from tests.support.shared_data import shared_folder

AVATARS = root() / "assets" / "models" / "avatars"
SIZE_SHARE = 1e-5

Places = dict[str, np.ndarray]
"""Vertices by the name of their node."""


def _blender() -> str:
    reported = os.environ.get("BLENDER_PYTHON")
    if reported is None and importlib.util.find_spec("bpy") is None:
        pytest.skip("no bpy here; BLENDER_PYTHON may name a Python that has it")
    return reported or sys.executable


def _by_blender(file: Path, asked: list[tuple[str, float]], folder: Path) -> list[Places]:
    program, out = Path(__file__).with_name("blender_pose.py"), folder / "blender.npz"
    words = [f"{clip}@{at!r}" for clip, at in asked]
    command = [_blender(), str(program), str(file), str(out), *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    found = np.load(out)
    return [{key.rsplit("/", 1)[1]: found[key] for key in found if key.startswith(f"{word}/")} for word in words]


def _by_us(
    file: Path, clip: str, at: float, folder: Path, change: Callable[[Clip, float], Clip] = lambda clip, at: clip
) -> Places:
    """What `mimics view --clip --at --vertices` writes."""
    shown = open_shown(file)
    for animator in animators_of(shown):
        animator.clips = {name: change(each, at) if name == clip else each for name, each in animator.clips.items()}
    play_clip(shown, clip, at, speed=0.0)
    write_vertices(shown, folder / "ours.npz")
    written = np.load(folder / "ours.npz")
    names = np.where(written["node"] == "", written["mesh"], written["node"])
    return {str(name): written["positions"][names == name] for name in np.unique(names)}


def _tracks(clip: Clip) -> list[MotionTrack]:
    """A packed clip's tracks one by one."""
    found = []
    for target, path, kind, first, keys, value, width in clip.tracks.tolist():
        parts = 3 if kind == Interpolation.CUBIC else 1
        values = clip.values[value : value + keys * parts * width].reshape(keys, parts, width)
        found.append(
            MotionTrack(target, TrackPath(path), Interpolation(kind), clip.times[first : first + keys], values)
        )
    return found


def _straight(clip: Clip, at: float) -> Clip:
    """The clip with one key for each turn: at a time, as Blender goes from key to key."""
    tracks = []
    for track in _tracks(clip):
        if track.path is TrackPath.ROTATION and track.interpolation is Interpolation.LINEAR and len(track.times) > 1:
            values = track.values[:, 0].astype(np.float64)
            flips = np.cumprod(np.append(1.0, np.sign(np.sum(values[1:] * values[:-1], axis=1))))
            mixed = np.array([np.interp(at, track.times, part) for part in (values * flips[:, None]).T])
            track = replace(track, times=track.times[:1], values=mixed[None, None, :].astype(np.float32))
        tracks.append(MotionTrack(track.target, track.path, track.interpolation, track.times, track.values))
    return replace(pack_clip(clip.name, tracks), duration=clip.duration)


def _apart(ours: Places, theirs: Places) -> float:
    """Largest distance of a vertex from the same one, in shares of the model's size."""
    worst, everything = 0.0, np.concatenate(list(ours.values()))
    for name, places in ours.items():
        assert places.shape == theirs[name].shape, name
        worst = max(worst, float(np.linalg.norm(places - theirs[name], axis=1).max()))
    return worst / float(np.ptp(everything, axis=0).max())


def _keys(file: Path, clip: str) -> np.ndarray:
    (animator,) = load_model_world(file).motion.animators.values()
    return max((track.times for track in _tracks(animator.clips[clip])), key=len)


@pytest.mark.slow
def test_people_are_posed_as_blender_poses_them(tmp_path: Path) -> None:
    file = AVATARS / "woman_anna.glb"
    (animator,) = load_model_world(file).motion.animators.values()
    turning = {
        name: next(track.times for track in _tracks(clip) if track.path is TrackPath.ROTATION and len(track.times) > 1)
        for name, clip in animator.clips.items()
    }
    asked = [(name, float(times[k])) for name, times in turning.items() for k in (0, len(times) // 3, len(times) - 1)]
    for (clip, at), theirs in zip(asked, _by_blender(file, asked, tmp_path), strict=True):
        assert _apart(_by_us(file, clip, at, tmp_path), theirs) <= SIZE_SHARE, (clip, at)


def test_between_keys_blender_goes_straight_where_gltf_turns(tmp_path: Path) -> None:
    file = AVATARS / "player_white.glb"
    asked = [("kick", 0.462), ("run", 0.31)]
    for (clip, at), theirs in zip(asked, _by_blender(file, asked, tmp_path), strict=True):
        assert _apart(_by_us(file, clip, at, tmp_path, _straight), theirs) <= SIZE_SHARE, clip
        assert 1e-5 < _apart(_by_us(file, clip, at, tmp_path), theirs) < 1e-3, clip


@pytest.mark.parametrize("name", ["RiggedSimple.glb", "AnimatedMorphCube.glb", "BoxAnimated.glb"])
def test_models_of_others_are_posed_as_blender_poses_them(tmp_path: Path, name: str) -> None:
    file = shared_folder("gltf") / name
    (clip, *_) = next(iter(load_model_world(file).motion.animators.values())).clips
    keys = _keys(file, clip)
    asked = [(clip, float(keys[k])) for k in (0, len(keys) // 2, len(keys) - 1)]
    for (_, at), theirs in zip(asked, _by_blender(file, asked, tmp_path), strict=True):
        assert _apart(_by_us(file, clip, at, tmp_path), theirs) <= SIZE_SHARE, at
