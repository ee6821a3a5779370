"""State mirror: a session's scene on a second display, which receives its state and sends nothing to it."""

__all__: list[str] = []
