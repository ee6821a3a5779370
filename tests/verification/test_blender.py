"""Posed vertices against Blender's evaluation of the same file and time, where a Python with bpy is at hand."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from mimics_app.app.cli import main
from mimics_app.contracts.resources import root

PERSON = root() / "assets" / "models" / "avatars" / "woman_anna.glb"
CLIP, AT = "idle", "3.0"
"""A time that is a key of the clip and a frame of Blender's: between keys Blender mixes numbers of quaternions."""


def _blender() -> str:
    told = os.environ.get("BLENDER_PYTHON")
    if told is None and importlib.util.find_spec("bpy") is None:
        pytest.skip("no bpy here; BLENDER_PYTHON may name a Python that has it")
    return told or sys.executable


def test_a_person_is_posed_as_blender_poses_it(tmp_path: Path) -> None:
    program = Path(__file__).with_name("blender_pose.py")
    blender, ours = tmp_path / "blender.npz", tmp_path / "ours.npz"
    command = [_blender(), str(program), str(PERSON), CLIP, AT, str(blender)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert main(["view", str(PERSON), "--clip", CLIP, "--at", AT, "--vertices", str(ours)]) == 0
    positions = np.load(ours)["positions"]
    away, _ = cKDTree(np.load(blender)["positions"]).query(positions)
    size = float(np.ptp(positions, axis=0).max())
    assert len(positions) > 5000 and away.max() <= 1e-5 * size
