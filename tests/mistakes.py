"""What a call that is refused says."""

import pytest

import rodimpact as ri


def problems(make):
    """Messages of the mistakes by their paths, each path once."""
    with pytest.raises(ri.InvalidModel) as caught:
        make()
    messages = dict(caught.value.problems)
    assert len(messages) == len(caught.value.problems)
    return messages


def assert_told(make, expected):
    """That these mistakes are told, by their paths: a part of each message, or = and
    all of it.
    """
    messages = problems(make)
    assert list(messages) == list(expected)
    for path, text in expected.items():
        if text.startswith("="):
            assert messages[path] == text[1:]
        else:
            assert text in messages[path]


def refused(match, function, *args, **options):
    """Paths of the mistakes of a call, whose message is as said."""
    with pytest.raises(ri.InvalidModel, match=match) as caught:
        function(*args, **options)
    return [path for path, _ in caught.value.problems]
