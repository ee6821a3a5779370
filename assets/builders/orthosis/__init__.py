"""The gait orthosis: treadmill, frame with body-weight support, harness, and for each leg bars, cuffs and drives."""

__all__: list[str] = []
