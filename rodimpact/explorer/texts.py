"""Names and quantities in sentences. The page has these functions as JavaScript."""

import math

from ..units import format_si


def name_of(kind: str, number: str) -> str:
    """The name of a body in a sentence: "the wall", or its kind and its number."""
    if number == "wall":
        return "the wall"
    return f"{kind} {number}"


def capital(word: str) -> str:
    """A text with its first letter as a capital; "" for ""."""
    return f"{word[:1].upper()}{word[1:]}"


def as_sentence(text: str) -> str:
    """The text as a sentence, with a capital letter and a full stop; "" for ""."""
    if text == "" or text[-1] == ".":
        return capital(text)
    return f"{capital(text)}."


def format_quantity(value: float, unit: str, digits: int) -> str:
    """A quantity to `digits` significant digits with an SI prefix, such as "12 µs".

    Micro is written µ. A quantity without a unit has only the number.
    """
    number, _, prefixed = format_si(value, unit, digits).partition(" ")
    if prefixed.startswith("u"):  # `format_si` writes micro as u
        prefixed = f"µ{prefixed[1:]}"
    return f"{number} {prefixed}".strip()  # there may be no unit


def error_text(value: float, digits: int, error: float, unit: str) -> str:
    """Text of the error of a value in its unit, with one digit; "" if it is small.

    An error is small up to half of the last of the `digits` significant digits with
    which the value is shown. The error of the value 0 is never shown.
    """
    if value == 0:
        return ""
    # The last of the digits that are shown stands for 10^last_digit.
    last_digit = math.floor(math.log10(abs(value))) + 1 - digits
    if error <= 0.5 * 10.0**last_digit:
        return ""
    return format_quantity(error, unit, 1)


def with_error(text: str, value: float, digits: int, error: float, unit: str) -> str:
    """`text` of a value followed by ± and its error; `text` alone for a small error.

    `digits` is the number of significant digits in `text`. The error, whose text is
    that of `error_text`, has a prefix of its own before the unit.
    """
    error_shown = error_text(value, digits, error, unit)
    if error_shown == "":
        return text
    return f"{text} ± {error_shown}"
