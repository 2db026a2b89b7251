"""Tests of one claim on many cases: a few of them by default, the rest under
`exhaustive`.
"""

import pytest


def few_of(cases, usual):
    """Cases for `parametrize`: those that are `usual` run always, the others only under
    the marker `exhaustive`.
    """
    marked_cases = []
    for case in cases:
        if case in usual:
            marked_cases.append(case)
        else:
            marked_cases.append(pytest.param(case, marks=pytest.mark.exhaustive))
    return marked_cases
