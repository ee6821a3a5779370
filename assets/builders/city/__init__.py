"""The city: streets with rows of houses, trees on both sidewalks, furniture, parked cars, a skyline."""

__all__: list[str] = []
