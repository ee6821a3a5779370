"""Letters of captions and of the board, as an atlas of distances."""

__all__: list[str] = []
