"""Power wall and CAVE: any number of flat screens in a room, seen from the tracked head."""

from __future__ import annotations

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.ports.display_port import Composing, Eye, Rect, Size, Viewpoint, WindowPlace
from mimics_app.rendering.visual.displays.off_axis import frustum_of
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay, eye_offset
from mimics_app.rendering.visual.displays.wall_file import WallSpec, WallsSpec, rectangle_of

__all__ = ["WallDisplay"]

_SIDES: dict[bool, tuple[tuple[str, float], ...]] = {False: (("", 0.0),), True: (("_left", -0.5), ("_right", 0.5))}


class WallDisplay(PlainDisplay):
    """Screens as walls. The eyes' separation rotates with the head, not with a wall.

    The drawn picture has all walls side by side, those of the right eye above.

    Args:
        kind: "wall" or "cave", which do not differ.
        spec: The walls.
    """

    def __init__(self, kind: str, spec: WallsSpec) -> None:
        super().__init__()
        self.kind, self.spec = kind, spec
        self._walls = [(wall, rectangle_of(wall)) for wall in spec.walls]
        # The right eye's window is beside the left eye's, or on the next monitor.
        self.windows = [
            WindowPlace(f"wall_{wall.name}{side}", _beside(wall, row), wall.pixels)
            for row, (side, _) in enumerate(_SIDES[spec.stereo])
            for wall in spec.walls
        ]
        self.composing = Composing("display/test_pattern.frag", {}, each_eye=True) if spec.test_pattern else None

    def pixels(self, shown: Size) -> list[Size]:
        """Return the size of each wall's picture [px] for a requested height of `shown`."""
        return [
            wall.pixels or (max(1, round(shown[1] * place.width / place.height)), shown[1])
            for wall, place in self._walls
        ]

    def drawn_size(self, shown: Size) -> Size:
        sizes = self.pixels(shown)
        return sum(size[0] for size in sizes), len(_SIDES[self.spec.stereo]) * max(size[1] for size in sizes)

    def eyes(self, viewpoint: Viewpoint, drawn: Size, display_ns: int) -> list[Eye]:
        rest = np.eye(4)
        rest[:3, 3] = self.spec.head
        head = self.head(display_ns)
        room_from_head = rest if head is None else head
        world_from_room = viewpoint.world_from_rest @ np.linalg.inv(rest)
        eyes: list[Eye] = []
        for row, (side, share) in enumerate(_SIDES[self.spec.stereo]):
            eye = (room_from_head @ eye_offset(share * self.spec.ipd))[:3, 3]
            for number, rectangle in enumerate(self._rectangles(drawn, row)):
                eyes.append(self._eye(number, side, eye, rectangle, world_from_room))
        return eyes

    def _eye(self, number: int, side: str, eye: F8, rectangle: Rect, world_from_room: F8) -> Eye:
        wall, place = self._walls[number]
        frustum = frustum_of(place, eye)
        if frustum.fault:
            self.note(f'wall "{wall.name}": {frustum.fault}')
        # Only the first wall has a heads-up display: it would be overlooked on the floor.
        screen = 0 if number == 0 else -1
        pair = number if self.spec.stereo else -1
        return Eye(f"wall_{wall.name}{side}", world_from_room @ frustum.pose, frustum.tangents, rectangle, screen, pair)

    def _rectangles(self, drawn: Size, row: int) -> list[Rect]:
        """Return the rectangles of a row of pictures in the drawn picture [px]."""
        height = drawn[1] // len(_SIDES[self.spec.stereo])
        sizes = self._sizes_in(drawn, height)
        lefts = np.cumsum([0, *(width for width, _ in sizes[:-1])]).tolist()
        return [(left, row * height, *size) for left, size in zip(lefts, sizes, strict=True)]

    def _sizes_in(self, drawn: Size, height: int) -> list[Size]:
        """Return the sizes of the walls' pictures in a drawn picture of a size [px]."""
        sizes = self.pixels((0, height))
        total, highest = sum(width for width, _ in sizes), max(each for _, each in sizes)
        if (total, highest) == (drawn[0], height):
            return sizes
        # In a window of another aspect ratio all of them are scaled down.
        across, down = drawn[0] / total, height / highest
        return [(max(1, int(width * across)), max(1, int(each * down))) for width, each in sizes]


def _beside(wall: WallSpec, row: int) -> tuple[int, int] | None:
    """Return the upper left corner of a wall's window [px]; the right eye's is one width further to the right."""
    if wall.window is None:
        return None
    return wall.window[0] + row * (wall.pixels[0] if wall.pixels else 0), wall.window[1]
