"""Estimators of the person's state: a module each, named as the estimator, with its function `build`."""

__all__: list[str] = []
