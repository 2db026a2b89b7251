"""What a call that is refused says."""

import pytest

import rodimpact as ri


def problems(make):
    """{path: message} of the mistakes for which `make()` is refused.

    It fails if `make()` is not refused, or names a path twice.
    """
    with pytest.raises(ri.InvalidModel) as caught:
        make()
    messages = dict(caught.value.problems)
    assert len(messages) == len(caught.value.problems)
    return messages


def assert_told(make, expected):
    """`make()` is refused for exactly the mistakes of `expected`, {path: text}, in this
    order. A text is a part of the message, or all of it if it begins with "=".
    """
    messages = problems(make)
    assert list(messages) == list(expected)
    for path, text in expected.items():
        if text.startswith("="):
            assert messages[path] == text[1:]
        else:
            assert text in messages[path]


def refused(match, function, *args, **options):
    """Paths of the mistakes for which a call is refused; the whole message must match.

    Arguments after `function` are handed to it.
    """
    with pytest.raises(ri.InvalidModel, match=match) as caught:
        function(*args, **options)
    return [path for path, _ in caught.value.problems]
