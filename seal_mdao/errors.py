"""Errors that tell what was wrong, where, and what to do about it."""


class GeometryError(ValueError):
    """The particles cannot be analysed: a folded cell, an uncovered point, a body inside the door."""


class SingularMomentMatrixError(GeometryError):
    """The moment matrix M(x) of Eq. (8) cannot be inverted: the supports do not cover a point."""


class SealFileError(ValueError):
    """A seal file says what cannot be done: one line with the table, the key, the value, and what is
    allowed."""


class TooLargeError(ValueError):
    """An analysis that does not fit into the memory of the machine, or takes days."""


class LoadPathError(RuntimeError):
    """The load path could not be completed.

    Attributes
    ----------
    result : SealResult
        Everything that was computed up to the step that failed.
    """

    def __init__(self, message: str, result=None):
        super().__init__(message)
        self.result = result


class KinkWarning(UserWarning):
    """Derivatives were taken at a design at which the measures have a kink: those of the two sides
    differ."""
