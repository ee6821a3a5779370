"""Threads of the software rasteriser: placed for the length of a frame, and left to the system after it."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.software import raster_threads
from mimics_app.rendering.visual.software.raster_threads import RasterThreads
from mimics_app.rendering.visual.surfaces.contexts import create_surface
from mimics_app.rendering.visual.view import View
from mimics_app.world.content.meshes.primitives import icosphere
from mimics_app.world.content.world import World

pytestmark = pytest.mark.software

SETTINGS = RenderSettings(msaa=0, shadow_size=0)
LARGE, SMALL = (640, 480), (64, 36)


class Placing:
    """Stands for the system: the threads' cores when they are asked for, and all that was demanded of them."""

    def __init__(self, monkeypatch, on: dict[int, int], cores: int = 2) -> None:
        self.on, self.allowed, self.demands = on, {thread: {*range(cores)} for thread in on}, []
        monkeypatch.setattr(raster_threads, "_find_threads", lambda: sorted(on))
        monkeypatch.setattr(raster_threads, "_core_of", on.__getitem__)
        monkeypatch.setattr(os, "sched_getaffinity", lambda thread: self.allowed.get(thread, {*range(cores)}))
        monkeypatch.setattr(os, "sched_setaffinity", self.demand)

    def demand(self, thread, cores):
        if thread not in self.on:
            raise ProcessLookupError(thread)
        self.allowed[thread] = {*cores}
        self.demands.append((thread, {*cores}))


@pytest.mark.parametrize(
    ("on", "spread"),
    [({7: 0, 8: 0}, {7: {0}, 8: {1}}), ({7: 1, 8: 1}, {7: {1}, 8: {0}}), ({7: 1, 8: 0}, {7: {1}, 8: {0}})],
)
def test_threads_make_way_then_spread_and_move_only_where_two_share_a_core(monkeypatch, on, spread):
    system = Placing(monkeypatch, on)
    threads = RasterThreads()
    with threads.submitting(placed=True):
        (left,) = {frozenset(cores) for cores in system.allowed.values()}
        assert len(left) == 1
    assert system.allowed == spread
    threads.free()
    assert system.allowed == {7: {0, 1}, 8: {0, 1}}


@pytest.mark.parametrize(
    ("on", "cores", "few"),
    [
        ({7: 0, 8: 0}, 2, True),
        ({7: 0}, 1, False),
        ({7: 0, 8: 0}, 4, False),
        ({thread: 0 for thread in range(7, 15)}, 8, False),
        ({}, 2, False),
    ],
)
def test_nothing_is_demanded_elsewhere(monkeypatch, on, cores, few):
    """Few pixels, one core, threads of another number, many cores, no threads."""
    system = Placing(monkeypatch, on, cores)
    threads = RasterThreads()
    with threads.submitting(placed=not few):
        pass
    threads.free()
    assert not system.demands


def test_a_thread_that_ended_leaves_the_others_free(monkeypatch):
    system = Placing(monkeypatch, {7: 0, 8: 1})
    threads = RasterThreads()
    with threads.submitting(placed=True):
        del system.on[7]
        monkeypatch.setattr(raster_threads, "_core_of", lambda thread: system.on.get(thread, -1))
    assert system.allowed[8] == {0, 1}
    system.demands.clear()
    with threads.submitting(placed=True):
        pass
    assert not system.demands


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="only Linux lists the threads of a process")
@pytest.mark.parametrize("size", [LARGE, SMALL])
def test_the_drivers_threads_are_free_after_a_frame(monkeypatch, size):
    """And on cores of their own once a picture of some size is submitted."""
    world, seen = World(), []
    world.meshes["ball"] = icosphere(1.0, 2)
    world.root.create_child("", (0.0, 0.0, -4.0)).create_entity("ball")
    world.update()
    own_cores = RasterThreads._own_cores
    monkeypatch.setattr(RasterThreads, "_own_cores", lambda self: seen.append(own_cores(self)) or seen[-1])
    with create_surface("egl", size) as surface:
        threads = raster_threads._find_threads()
        before = {thread: os.sched_getaffinity(thread) for thread in threads}
        side = 0.5 * size[0] / size[1]
        Renderer(surface, world, SETTINGS).draw_finished([View(np.eye(4), (-side, side, -0.5, 0.5), (0, 0, *size))])
        assert {thread: os.sched_getaffinity(thread) for thread in threads} == before
    cores = len(os.sched_getaffinity(0))
    assert len(seen) == (size == LARGE and 2 <= cores == len(threads) <= 4)
    assert all(len(set(each)) == len(each) for each in seen)
