"""Binary search in sorted lists of particles and equations."""

from seal_mdao.compilation import internal


@internal
def first_not_below(values, wanted, begin, end):
    """Find the first index in the sorted ``values[begin:end]`` with a value of at least ``wanted``.

    ``end`` if there is none. ``np.searchsorted`` makes numba compile three times as much.
    """
    while begin < end:
        # bisection: values[:begin] < wanted <= values[end:]
        middle = (begin + end) // 2
        if values[middle] < wanted:
            begin = middle + 1
        else:
            end = middle
    return begin
