"""However many mistakes there are and whatever was given, what is told stays short."""

import pytest
from case_texts import A_ROD, HEAD, problems, with_area
from exhaustive import few_of

import rodimpact as ri
from rodimpact.storage.casefile import parse_case

DEEP = "." + ".".join(["a"] * 1200) + " = 1"


def error_of(text, vary=None):
    """The error with which the text of a case is refused."""
    with pytest.raises(ri.InvalidModel) as caught:
        parse_case(text, vary=vary)
    return caught.value


@pytest.mark.parametrize(
    ("text", "first"),
    [
        (
            HEAD + A_ROD + "".join(f"k{i} = 1\n" for i in range(2_000)),
            "bodies.0.k0: unknown key; use one of kind, ",
        ),
        (
            HEAD + A_ROD + "strain = {samples = [" + "'1 m'," * 2_000 + "]}",
            "bodies.0.strain.samples.0: cannot read '1 m' as dimensionless",
        ),
        pytest.param(
            HEAD
            + with_area(
                "{values = ["
                + "-1," * 2_000
                + "], at = ["
                + ", ".join(f"{1e-4 * (i + 1)}" for i in range(1_999))
                + "]}"
            ),
            "bodies.0.area.values.0: must be a finite positive number",
            marks=pytest.mark.exhaustive,
        ),
        (
            HEAD
            + "".join(A_ROD.replace("steel", f"x{i}") for i in range(200))
            + "".join(f"[materials.y{i}]\nyoungs_modulus = 1\n" for i in range(1_800)),
            "materials.y0.density: is missing",
        ),
    ],
)
def test_of_2000_mistakes_the_first_are_told_and_the_rest_counted(text, first):
    """The message has 20 lines of mistakes and one with the number of the others."""
    error = error_of(text)
    lines = str(error).split("\n")
    assert len(error.problems) == 2_000
    assert lines[0].startswith(first)
    assert len(lines) == 21
    assert lines[20] == "...: and 1980 mistakes more"
    assert len(str(error)) < 4000


DEEP_KEYS = [
    "schema" + DEEP + "\n" + A_ROD,
    HEAD + "gravity" + DEEP + "\n" + A_ROD,
    HEAD + "bodies" + DEEP,
    HEAD + "materials" + DEEP + "\n" + A_ROD,
    HEAD + A_ROD + "strain" + DEEP,
    HEAD + A_ROD + "polar_moment" + DEEP,
    HEAD + A_ROD + "[[bodies]]\nkind" + DEEP,
    HEAD + A_ROD.replace("= 0.4", DEEP),
    HEAD + A_ROD + "[ends.left]\nkind" + DEEP,
    HEAD + A_ROD + "[a" + DEEP.replace(" = 1", "]"),
    *(
        HEAD + A_ROD + f"[solve]\n{key}{DEEP}"
        for key in (
            "until",
            "method",
            "max_events",
            "dt",
            "rtol",
            "cells",
            "snapshots",
        )
    ),
    HEAD + A_ROD + "[output]\nplot" + DEEP,
]


@pytest.mark.parametrize("text", few_of(DEEP_KEYS, DEEP_KEYS[::3]))
def test_keys_1200_deep_are_told_shortly(text):
    """Each message has fewer than 300 characters."""
    for message in problems(text).values():
        assert len(message) < 300


@pytest.mark.parametrize(
    "key", ["until", "dt", "rtol", "max_events", "cells", "snapshots"]
)
@pytest.mark.parametrize("number", [10**400, 10**30 - 1])
def test_integers_of_many_digits_are_refused_shortly(key, number):
    """A number of many digits for an option is refused at its path in less than 250
    characters.
    """
    if number < 10**31 and key in ("until", "dt", "rtol"):
        # These are floats, and large ones are right: it is refused for its sign.
        number = -number
    path = f"solve.{key}"

    messages = problems(HEAD + A_ROD + f"[solve]\n{key} = {number}")

    assert list(messages) == [path]
    message = messages[path]
    assert "got " in message or "cannot read " in message
    assert len(message) < 250


def test_keys_are_told_in_one_line_without_control_characters():
    """An unknown key with an escape sequence, a line break and a mark of direction is
    reported in one line that shows them escaped or as a space.
    """
    key = r'"a\u001b[31m\n\u202e"'

    error = error_of(HEAD + A_ROD + key + " = 1\nkind2 = 2")

    first_line = str(error).split("\n")[0]
    assert first_line.startswith(r"bodies.0.a\x1b[31m \u202e: unknown key")


def test_keys_and_values_of_100000_characters_are_told_shortly():
    """A key, name or word of 100,000 characters in a case file or a grid is refused in
    less than 400 characters.
    """
    name = "y" * 10**5
    long_key = HEAD + A_ROD + f'"{name}" = 1'
    assert len(str(error_of(long_key))) < 300
    for text in (
        A_ROD.replace("steel", name),
        A_ROD + f'[[bodies]]\nkind = "{name}"',
        A_ROD + f'polar_moment = "{name}"',
        A_ROD + f'strain = "{name}"',
        A_ROD + f'[[contacts]]\nlaw = "{name}"',
        A_ROD + f'[solve]\nmethod = "{name}"',
        A_ROD + f"[materials.{name}]\nyoungs_modulus = 1\ndensity = -1",
    ):
        assert len(str(error_of(HEAD + text))) < 400
    for vary in ({name: "1,2"}, {"bodies.0.length": name}):
        assert len(str(error_of(HEAD + A_ROD, vary))) < 400


def test_a_gauge_without_a_place_is_told_so():
    messages = problems(HEAD + A_ROD + "[[gauges]]\nbody = 0\nx = 0.1")
    assert messages["gauges.0.fraction"].startswith("give the place")
    assert messages["gauges.0.x"] == "unknown key; use one of body, fraction, name"
