"""What a call that is refused says."""

import pytest

import rodimpact as ri


def problems(make):
    """Messages of the mistakes by their paths, each path once."""
    with pytest.raises(ri.InvalidModel) as caught:
        make()
    found = dict(caught.value.problems)
    assert len(found) == len(caught.value.problems)
    return found


def refused(match, function, *args, **options):
    """Paths of the mistakes of a call, whose message is as said."""
    with pytest.raises(ri.InvalidModel, match=match) as caught:
        function(*args, **options)
    return [path for path, _ in caught.value.problems]
