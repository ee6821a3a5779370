"""The picture of a session: drawing, board, developer's overlay, governor of its quality, videos."""

__all__: list[str] = []
