"""Names and quantities in sentences. Plain Python, which the page has as JavaScript."""

import math

from ..units import format_si


def name_of(kind: str, number: str) -> str:
    """The name of a body in a sentence."""
    return "the wall" if number == "wall" else f"{kind} {number}"


def capital(word: str) -> str:
    """The word at the head of a line."""
    return f"{word[:1].upper()}{word[1:]}"


def written(value: float, unit: str, digits: int) -> str:
    """A quantity for people, with a µ."""
    number, _, prefixed = format_si(value, unit, digits).partition(" ")
    return f"{number} {'µ' + prefixed[1:] if prefixed.startswith('u') else prefixed}".strip()


def stated(text: str, value: float, digits: int, error: float, unit: str) -> str:
    """The text of a value of so many digits, with its error if that is above half of the last."""
    if value == 0 or not error > 0.5 * 10.0 ** (
        math.floor(math.log10(abs(value))) + 1 - digits
    ):
        return text
    return f"{text} ± {written(error, unit, 1)}"
