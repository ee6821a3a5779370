"""MIMICS: one shared scene rendered as touch (1 kHz), picture (~60 Hz) and sound (<= 20 ms).

The package imports nothing heavy: numpy, numba, OpenGL and OpenAL come in when a part that needs them does.
"""

__all__ = ["__version__"]

__version__ = "0.1.0"
