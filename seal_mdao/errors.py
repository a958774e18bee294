"""Errors and warnings, whose messages state the cause, its location and a remedy."""


class GeometryError(ValueError):
    """Particles that cannot be analysed: a folded cell, an uncovered point, a body inside the door.

    Attributes
    ----------
    cell : tuple of int
        Particles of the background cell at which a section is folded; empty for other errors.
    """

    def __init__(self, message: str, cell: tuple[int, ...] = ()):
        super().__init__(message)
        self.cell = cell


class SingularMomentMatrixError(GeometryError):
    """The moment matrix M(x) of Eq. (8) cannot be inverted: the supports do not cover a point."""


class SealFileError(ValueError):
    """An invalid seal file: one line with the table, the key, the value, and what is allowed."""


class TooLargeError(ValueError):
    """An analysis that needs more than the memory of the machine, or more than the allowed
    hours."""


class LoadPathError(RuntimeError):
    """An analysis that could not be completed up to the last load step.

    Attributes
    ----------
    result : SealResult
        Result up to the step that failed.
    """

    def __init__(self, message: str, result=None):
        super().__init__(message)
        self.result = result


class KinkWarning(UserWarning):
    """Derivatives at a kink, where those on its two sides differ."""
