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


def assert_told(make, wanted):
    """That these mistakes are told, by their paths: a part of each message, or = and all of it."""
    found = problems(make)
    assert list(found) == list(wanted)
    for path, said in wanted.items():
        assert found[path] == said[1:] if said[:1] == "=" else said in found[path]


def refused(match, function, *args, **options):
    """Paths of the mistakes of a call, whose message is as said."""
    with pytest.raises(ri.InvalidModel, match=match) as caught:
        function(*args, **options)
    return [path for path, _ in caught.value.problems]
