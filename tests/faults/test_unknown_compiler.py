"""A numba of another series than the known one: functions are compiled in each process, and do the same."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from mimics_app.compiled.cache_folder import KNOWN_SERIES, is_known_series
from tests.architecture.sources import ROOT
from tests.support.command import mimics

PLAIN = """
import numba

numba.__version__ = "0.999.0"  # no such series: none of the private names may be asked for

import json
import sys

import numpy as np

from mimics_app.compiled.atomics import load_acquire, store_release
from mimics_app.compiled.borrowed import borrowed
from mimics_app.compiled.kernel import kernel, typed_kernel
from mimics_app.contracts.loop.loop_ports import FIELD
from mimics_app.maths.vec import norm
from typing import NamedTuple


class Pair(NamedTuple):
    a: np.ndarray
    b: np.ndarray


@kernel
def dot_of(pair):
    pair = borrowed(pair)
    total = 0.0
    for i in range(len(pair.a)):
        total += pair.a[i] * pair.b[i]
    return total


@typed_kernel(FIELD)
def spring(parameters, p, v, t, out):
    for i in range(3):
        out[i] = -parameters[0] * p[i]


word = np.zeros(1, np.int64)


@kernel
def exchange(words):
    store_release(words, 0, 7)
    return load_acquire(words, 0)


force = np.zeros(3)
spring(np.full(8, 2.0), np.arange(3.0), np.zeros(3), 0.0, force)
three = np.array([3.0, 4.0, 12.0])
kept = "mimics_app.compiled.kernel_cache" in sys.modules
print(json.dumps([norm(three), dot_of(Pair(three, three)), force.tolist(), exchange(word), kept]))
"""


def test_the_pinned_compiler_is_of_the_known_series() -> None:
    assert is_known_series()
    assert f"numba=={KNOWN_SERIES}." in (ROOT / "requirements.txt").read_text(encoding="utf-8")


def test_another_series_compiles_plainly_and_does_the_same() -> None:
    done = subprocess.run(
        [sys.executable, "-c", PLAIN], cwd=ROOT, capture_output=True, text=True, timeout=240, check=False
    )
    assert done.returncode == 0, done.stderr
    length, dot, force, word, kept = json.loads(done.stdout)
    assert (length, dot, force, word) == (13.0, 169.0, [0.0, -2.0, -4.0], 7)
    assert not kept, "the modules that use private names are not even imported"


RUN = ["run", "wavy_tunnel", "--headless", "--seconds", "1", "--json"]


@pytest.mark.slow
def test_a_scene_ends_in_the_same_state(tmp_path: Path) -> None:
    """The whole loop, compiled without anything kept: some minutes."""
    source = f"import numba; numba.__version__ = '0.999.0'; from mimics_app.app.cli import main; main({RUN!r})"
    done = subprocess.run(
        [sys.executable, "-c", source],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=1800,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    known = mimics(*RUN, "--runs", tmp_path / "runs")
    assert json.loads(done.stdout)["state_hash"] == json.loads(known.stdout)["state_hash"]
