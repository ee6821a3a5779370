"""What a developer wants to see over the picture: wires, bounds, lights, forces, shadow maps, and what a frame costs."""

__all__: list[str] = []
