"""The quiet room of the examples, and models of what is felt: surfaces, spring, magnet, arrow."""

__all__: list[str] = []
