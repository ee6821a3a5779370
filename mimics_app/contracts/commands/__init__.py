"""Commands to a running session: the vocabulary, and who may give what."""

__all__: list[str] = []
