"""Places in sorted lists of particles and equations."""

from seal_mdao.compilation import internal


@internal
def first_not_below(values, wanted, begin, end):
    """First place of the sorted ``values[begin:end]`` that holds no less than ``wanted``, else ``end``.

    NumPy's own function makes numba compile three times as much.
    """
    while begin < end:
        middle = (begin + end) // 2
        if values[middle] < wanted:
            begin = middle + 1
        else:
            end = middle
    return begin
