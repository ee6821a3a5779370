"""Work of the Python interpreter in a frame, counted instead of timed: the same on every machine and under any load."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType

from mimics_app.app.picture.board import BoardLayout
from mimics_app.contracts.messages.board import Board, Card
from mimics_app.contracts.system.machine import describe_machine
from mimics_app.lab.figure import Figure, write_figure
from mimics_app.lab.groups.frame_of_nodes import node_world
from mimics_app.lab.panel import Panel
from mimics_app.plotting.axis import Axis
from mimics_app.plotting.drawing import document, legend
from mimics_app.rendering.visual.renderer import Renderer
from mimics_app.rendering.visual.settings import RenderSettings
from mimics_app.rendering.visual.surfaces.headless import open_offscreen

__all__ = ["FrameCounts", "count_cards", "count_frame", "count_nodes", "draw_counts"]

_SIZE = (64, 36)
_FRAMES, _WARM_UP = 30, 3
_CUBES = 256
"""Number of cubes that share the materials."""
_SETTINGS = RenderSettings(msaa=0, shadow_size=0)
_COUNTS = {
    "nodes that all move": (1, 10, 100, 1000, 10_000),
    "materials, one draw each": (1, 4, 16, 64, _CUBES),
    "cards of the board, as they were": (1, 2, 4, 8),
    "cards of the board, each another": (1, 2, 4, 8),
}
_COMMAND = "mimics bench frame --charts DIR"
_WIDTH, _HEIGHT = 1000.0, 360.0


@dataclass(frozen=True)
class FrameCounts:
    """Counts of one frame.

    Attributes:
        calls: Calls of functions of Python and of C.
        blocks: Memory blocks that are kept beyond the frame.
        collections: Runs of the garbage collector.
    """

    calls: int
    blocks: float
    collections: float


def count_frame(draw: Callable[[int], object]) -> FrameCounts:
    """Count the work of drawing a frame, after some warm-up frames; `draw` takes the number of the frame."""
    for frame in range(_WARM_UP):
        draw(frame)
    gc.collect()
    held, collected = sys.getallocatedblocks(), _collections()
    for frame in range(_FRAMES):
        draw(_WARM_UP + frame)
    blocks, runs = sys.getallocatedblocks() - held, _collections() - collected
    calls = _count_calls(partial(draw, _WARM_UP + _FRAMES))
    return FrameCounts(calls, blocks / _FRAMES, runs / _FRAMES)


def count_nodes(count: int, materials: int = 1) -> FrameCounts:
    """Count a frame of rotating cubes of some materials."""
    world, move = node_world(count, materials)
    with open_offscreen("egl", _SIZE) as surface:
        renderer = Renderer(surface, world, _SETTINGS)
        counts = count_frame(lambda frame: renderer.draw([move(frame)]))
        renderer.release()
    return counts


def count_cards(count: int, *, changing: bool) -> FrameCounts:
    """Count a frame of one cube under a number of cards, whose texts change in every frame or never."""
    world, move = node_world(1)
    with open_offscreen("egl", _SIZE) as surface:
        renderer, layout = Renderer(surface, world, _SETTINGS), BoardLayout()

        def draw(frame: int) -> None:
            names = [f"{number}" for number in range(count)]
            board = Board({name: Card("Time", f"{frame * changing:.1f} s") for name in names})
            layout.lay(renderer.hud, board, names, 1.0)
            renderer.draw([move(frame)])

        counts = count_frame(draw)
        renderer.release()
    return counts


def draw_counts(folder: Path) -> Path:
    """Write the figure of calls against nodes, materials and cards; return the drawing."""
    return write_figure(_figure(), folder)[1]


def _figure() -> Figure:
    counters: tuple[Callable[[int], FrameCounts], ...] = (
        count_nodes,
        lambda count: count_nodes(_CUBES, count),
        lambda count: count_cards(count, changing=False),
        lambda count: count_cards(count, changing=True),
    )
    counted = {
        name: [(float(count), count_of(count)) for count in counts]
        for (name, counts), count_of in zip(_COUNTS.items(), counters, strict=True)
    }
    lines = {name: [(x, float(each.calls)) for x, each in rows] for name, rows in counted.items()}
    rows = [
        {"method": name, "x": x, "calls": each.calls, "blocks": each.blocks, "collections": each.collections}
        | {"cost_ns": None, "error": None, "valid": True}
        for name, found in counted.items()
        for x, each in found
    ]
    more = {"what": "Calls of Python a frame", "unit": "calls"}
    return Figure("figure", "python of a frame", _COMMAND, str(describe_machine()), rows, _svg(lines), more=more)


def _svg(lines: dict[str, list[tuple[float, float]]]) -> str:
    x = Axis.around("how many of them", [1.0, 10_000.0], log=True)
    y = Axis.around("calls a frame", [value for points in lines.values() for _, value in points], log=True)
    panel = Panel(6.0, 100.0, _WIDTH - 20.0, _HEIGHT, x, y)
    for k, (name, points) in enumerate(lines.items()):
        panel.line(points, f"line s{k}", name)
        for place, value in points:
            panel.dot(place, value, f"dot s{k}", f"{name}: {place:g}, {value:g} calls")
    entries = [("line", f"line s{k}", name) for k, name in enumerate(lines)]
    parts = [legend(20.0, 52.0, entries), panel.svg()]
    return str(document(_WIDTH, _HEIGHT + 140.0, "Calls of Python a frame", parts, [_COMMAND]))


def _count_calls(draw: Callable[[], object]) -> int:
    """Return the number of calls made by one call of a function, itself included."""
    calls, before = -1, sys.getprofile()  # the end of counting is a call too

    def count(_: FrameType, event: str, __: object) -> None:
        nonlocal calls
        calls += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        draw()
    finally:
        sys.setprofile(before)
    return calls


def _collections() -> int:
    return sum(int(each["collections"]) for each in gc.get_stats())
