"""Controllers of the HapticMaster, compiled: joint PD, world PD, admittance (D2.1 4.2.5-4.2.7)."""

__all__: list[str] = []
