"""The developer's overlay: wireframe, bounds, lights, forces, shadow atlas, frame graph."""

__all__: list[str] = []
