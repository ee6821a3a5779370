"""The memory that the processes of a session share: segment, rings, triple buffers."""

__all__: list[str] = []
