"""What is seen but is no body: sprites, particles, what projectors throw."""

__all__: list[str] = []
