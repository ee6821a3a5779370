"""Every array of a session has one writer: what the loop writes, nobody outside the loop's own stage writes."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Iterator

import pytest

from tests.architecture.sources import imports, modules, nodes

WRITER = "rendering/haptic/"
"""The loop, its engine and its recorder-free play."""

RINGS = ("sample", "main_event", "audio_event", "audio_force", "recorder_event")
LOOP_WRITES = {"poses", "snapshots", "snapshot_words", "audio_snapshots", "audio_words", "lateness", "duration"}
LOOP_WRITES |= {f"{ring}s" for ring in RINGS} | {f"{ring}_words" for ring in RINGS}
"""Fields of `SessionMemory` that are written in a tick."""

READERS = {
    "app/bench/fault_bench.py",
    "app/session/memory_recorder.py",
    "app/session/switched_off.py",
    "console/telemetry.py",
    "lab/groups/haptic_tick.py",
    "lab/haptic/points_bench.py",
    "lab/stability/s15_late_ticks.py",
    "recording/recorder.py",
    "recording/recorder_process.py",
    "rendering/audio/director.py",
    "rendering/audio/offline.py",
    "rendering/audio/worker.py",
}
"""Modules that drain a ring or read a snapshot: they name these arrays and hand them to the reading calls alone."""

PLAYS_THE_LOOP = {"app/replay_view/replay_sound.py", "lab/audio/live_latency.py"}
"""A recording's view and a bench have no loop, and push the events themselves, into a memory of their own."""

READING = {"drain", "peek", "room", "waiting", "acquire", "len", "wait_for_records", "RingReader", "RingHistory"}
"""Calls that take such an array and leave it alone but for the reader's own words."""


def _chain(node: ast.expr) -> list[str]:
    """Names of an attribute chain from its end: `a.b[0].c` gives c, b, a."""
    names = []
    while isinstance(node, (ast.Attribute, ast.Subscript)):
        if isinstance(node, ast.Attribute):
            names.append(node.attr)
        node = node.value
    return [*names, node.id] if isinstance(node, ast.Name) else names


def _is_loops(node: ast.AST) -> bool:
    """Whether an expression is one of the loop's arrays, by way of a session's memory."""
    if not isinstance(node, ast.Attribute) or node.attr not in LOOP_WRITES:
        return False
    above = _chain(node.value)
    return bool(above) and above[0].lstrip("_") == "memory"


def _stores(node: ast.AST) -> Iterator[ast.expr]:
    """Targets of an assignment that lie in one of the loop's arrays, or in the picture's copy of one."""
    targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
    for target in targets:
        if isinstance(node, (ast.Assign, ast.AugAssign)) and isinstance(target, (ast.Subscript, ast.Attribute)):
            names = [name.lstrip("_") for name in _chain(target)]
            owned = {after for name, after in itertools.pairwise(names) if name in LOOP_WRITES}
            if owned & {"memory", "snapshot"}:
                yield target


def trespasses(path: str, tree: ast.Module) -> Iterator[str]:
    """Places where a module outside the loop's stage writes what the loop writes, or takes hold of it to do so."""
    if path.startswith(WRITER) or path in PLAYS_THE_LOOP:
        return
    for line, name in imports(tree):
        if name.startswith("mimics_app.rendering.haptic.channels"):
            yield f"{path}:{line} takes the loop's own channels"
    for node in nodes(tree):
        if _is_loops(node) and path not in READERS:
            yield f"{path}:{node.lineno} takes hold of {ast.unparse(node)}"  # type: ignore[attr-defined]
        yield from (f"{path}:{target.lineno} writes {ast.unparse(target)}" for target in _stores(node))
        if isinstance(node, ast.Call) and any(map(_is_loops, node.args)):
            called = _chain(node.func)[:1] or [ast.unparse(node.func)]
            if called[0] not in READING:
                yield f"{path}:{node.lineno} hands the loop's array to {ast.unparse(node.func)}"


def test_what_the_loop_writes_has_no_other_writer() -> None:
    assert not [found for path, tree in modules().items() for found in trespasses(path, tree)]


def test_every_reader_named_here_reads() -> None:
    """A name that is stale would let a module of that name write."""
    for path in READERS:
        assert any(_is_loops(node) for node in nodes(modules()[path])), path


PLANTED = {
    "a row": "def f(session):\n    session.memory.poses[0, 1, :3] = 0.0\n",
    "a row under another name": "def f(self):\n    rows = self._memory.poses\n    rows[0] = 1.0\n",
    "in place": "def f(memory, way):\n    memory.poses[0] += way\n",
    "a field of a snapshot": "def f(memory, k):\n    memory.snapshots[k]['state'] = 4\n",
    "a call": "import numpy as np\ndef f(memory, way):\n    np.copyto(memory.poses[0], way)\n",
    "a publish": "from mimics_app.contracts.shared_memory import triple_buffer\n"
    "def f(memory):\n    triple_buffer.publish(memory.snapshot_words)\n",
    "the channels": "from mimics_app.rendering.haptic.channels import channels_of\n",
    "the picture's copy": "def f(snapshot):\n    snapshot.poses[2] = 0.0\n",
}


@pytest.mark.parametrize("what", PLANTED)
@pytest.mark.parametrize("path", ["app/planted.py", "scenarios/planted.py"])
def test_a_planted_writer_is_found(path: str, what: str) -> None:
    assert list(trespasses(path, ast.parse(PLANTED[what])))


@pytest.mark.parametrize("code", ["memory.samples[0] = 0.0", "push(memory.sample_words, memory.samples, row)"])
def test_a_reader_that_writes_is_found(code: str) -> None:
    planted = ast.parse(f"def f(memory, row):\n    {code}\n")
    assert list(trespasses("recording/recorder.py", planted))
