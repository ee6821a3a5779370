"""A run from its first frame to its result, still pictures and sound of a scene, and the contents of the launcher."""

__all__: list[str] = []
