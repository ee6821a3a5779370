"""What stages tell each other, one frozen type per arrow, and what people read of it."""

__all__: list[str] = []
