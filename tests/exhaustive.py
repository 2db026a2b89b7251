"""Tests of one claim on many cases: a few of them by default, the rest under
`exhaustive`.
"""

import pytest


def few_of(cases, usual):
    """Cases for `parametrize`: those that are `usual` run always, the others under the
    marker.
    """
    return [
        case if case in usual else pytest.param(case, marks=pytest.mark.exhaustive)
        for case in cases
    ]
