"""Two step signals summed on a grid of places and times: the fields on an open (x, t) grid.

A kernel: plain Python and compiled alike.
"""

from __future__ import annotations

from typing import Any


def first_at_or_after(times: Any, tick: int, low: int) -> int:
    """Index of the first of the sorted `times`, from `low` on, that is not before `tick`."""
    high = len(times)
    while low < high:
        middle = (low + high) // 2
        if times[middle] < tick:
            low = middle + 1
        else:
            high = middle
    return low


def sum_on_grid(
    out: Any, times: Any, ticks_a: Any, a: Any, delay_a: Any, ticks_b: Any, b: Any, delay_b: Any,
    factor: float, shift: float,
) -> None:
    """Set out[i, j] = (A(times[j] - delay_a[i]) + B(times[j] - delay_b[i])) * factor + shift.

    Parameters
    ----------
    out : [places, times] float
        Result.
    times : [times] int
        Increasing.
    ticks_a, a, ticks_b, b : [fronts]
        Step signals: a[r] holds from ticks_a[r] on, a[0] before that too.
    delay_a, delay_b : [places] int
    """
    end = len(times)
    for i in range(len(delay_a)):
        ra = rb = 0
        j = 0
        next_a = first_at_or_after(times, ticks_a[1] + delay_a[i], 0) if len(a) > 1 else end
        next_b = first_at_or_after(times, ticks_b[1] + delay_b[i], 0) if len(b) > 1 else end
        while j < end:
            while next_a <= j:
                ra += 1
                next_a = end
                if ra + 1 < len(a):
                    next_a = first_at_or_after(times, ticks_a[ra + 1] + delay_a[i], j)
            while next_b <= j:
                rb += 1
                next_b = end
                if rb + 1 < len(b):
                    next_b = first_at_or_after(times, ticks_b[rb + 1] + delay_b[i], j)
            stop = min(next_a, next_b)
            out[i, j:stop] = (a[ra] + b[rb]) * factor + shift
            j = stop
