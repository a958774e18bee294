"""Errors and warnings, whose messages state the cause, its location and a remedy."""


class GeometryError(ValueError):
    """Particles that cannot be analysed: a folded cell, an uncovered point, a body inside the door."""


class SingularMomentMatrixError(GeometryError):
    """The moment matrix M(x) of Eq. (8) cannot be inverted: the supports do not cover a point."""


class SealFileError(ValueError):
    """An invalid seal file: one line with the table, the key, the value, and what is allowed."""


class TooLargeError(ValueError):
    """An analysis that does not fit into the memory of the machine, or takes days."""


class LoadPathError(RuntimeError):
    """The load path could not be completed.

    Attributes
    ----------
    result : SealResult
        Result up to the step that failed.
    """

    def __init__(self, message: str, result=None):
        super().__init__(message)
        self.result = result


class KinkWarning(UserWarning):
    """Derivatives at a kink of the measures, where those of the two sides differ."""
