"""What is seen but is no body: sprites, particles, projected pictures."""

__all__: list[str] = []
