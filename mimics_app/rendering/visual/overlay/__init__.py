"""What a developer wants to see over the picture: wires, bounds, lights, forces, shadow maps, the cost of a frame."""

__all__: list[str] = []
