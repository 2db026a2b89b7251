"""Results of a collision without rounding: fractions, or formulas for them."""

from collections.abc import Callable
from typing import Any, NamedTuple

from ..hints import explain_missing


@explain_missing()
class Exact(NamedTuple):
    """A collision in fractions: nothing in it is rounded.

    Attributes
    ----------
    restitution : Fraction or None
        e; None where not exactly one contact can open, or nothing collides.
    velocities_after : tuple of Fraction
        Velocity of the centre of mass of each body, m/s.
    impulses : tuple of Fraction
        Impulse of each contact, N s. The force of a bond goes on with the vibration:
        its impulse is the average.
    contact_times : tuple of tuple of (Fraction, Fraction)
        Start and end of the force of each contact, for each of its episodes, in units
        of `time_unit`.
    time_unit : float
        Unit of time, s. It is 1 if wave speeds are rational or transit times are given.
        Otherwise it is the time in which a wave runs 1 m in the first rod. Only this
        number may be rounded.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> collision = ri.exact(ri.System([left, right]))
    >>> collision.velocities_after
    (Fraction(0, 1), Fraction(2, 5))
    """

    restitution: Any
    velocities_after: tuple[Any, ...]
    impulses: tuple[Any, ...]
    contact_times: tuple[tuple[tuple[Any, Any], ...], ...]
    time_unit: float = 1.0


def map_numbers(results: Exact, convert: Callable[[Any], Any]) -> Exact:
    """Results with each number converted; None stays, and `time_unit` becomes 1."""

    def converted(x: Any) -> Any:
        """A number converted, None, or a tuple of them."""
        if isinstance(x, tuple):
            return tuple(map(converted, x))
        if x is None:
            return None
        return convert(x)

    return Exact(
        converted(results.restitution),
        converted(results.velocities_after),
        converted(results.impulses),
        converted(results.contact_times),
    )


def numbers_of(results: Exact) -> list[Any]:
    """All numbers of the results in one list, in the order of `map_numbers`.

    None is left out.
    """
    numbers: list[Any] = []
    map_numbers(results, numbers.append)
    return numbers
