"""The launcher: pages to choose a scene, to wait for it, and to show its result."""

__all__: list[str] = []
