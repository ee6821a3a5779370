"""Files as bytes, JSON and structs, each fault with its place."""

__all__: list[str] = []
