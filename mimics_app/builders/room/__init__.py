"""The quiet room of the examples, and what stands for a feeling: surfaces, spring, magnet, arrow."""

__all__: list[str] = []
