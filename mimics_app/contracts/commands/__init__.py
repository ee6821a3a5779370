"""Commands to a running session: the vocabulary, who may give what, and the rings that carry them."""

__all__: list[str] = []
