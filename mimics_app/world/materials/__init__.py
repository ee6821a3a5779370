"""How surfaces look: materials, and the techniques that draw them."""

__all__: list[str] = []
