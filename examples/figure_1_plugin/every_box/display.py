"""Display: a letterbox, the picture in the middle half of the screen."""

from __future__ import annotations

from mimics_app.contracts.ports.display_port import Eye
from mimics_app.rendering.visual.displays.plain_display import PlainDisplay


class Letterbox(PlainDisplay):
    """One eye in the middle half of the height."""

    def __init__(self, request):
        super().__init__()
        self.kind = request.kind

    def eyes(self, viewpoint, drawn, display_ns):
        """Return the one eye, with square pixels."""
        width, height = drawn[0], drawn[1] // 2
        across = 0.36 * width / height
        return [Eye("", viewpoint.world_from_head, (-across, across, -0.36, 0.36), (0, height // 2, width, height))]
