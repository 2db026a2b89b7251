"""Which numbers of a system have a name, and the run of a row with these names.

Transit times are called T, impedances Z, lengths l, areas A, Young's moduli E, densities rho,
velocities v and gaps g, each with its number from left to right: of the segment, the material, the
body or the contact. A wave speed that is no fraction has a name of its own, c, for it stands for
sqrt(E/rho).
"""

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from ..methods.walk import walk
from ..model import System
from ..model.frozen import InvalidModel
from ..model.paths import places_of, suggestion
from ..units import shown
from .exact import ExactRun, Numbers, check, read, root, run, written
from .numbers import ZERO, Number, Program

LETTERS = {
    "transit_time": "T",
    "impedance": "Z",
    "length": "l",
    "area": "A",
    "youngs_modulus": "E",
    "density": "rho",
    "velocity": "v",
    "gap": "g",
}
DIGITS = 400  # bits of a wave speed that is no fraction


class Naming:
    """The named numbers of a system.

    Parameters
    ----------
    system : System
    symbols : sequence of str
        Paths of numbers, such as ``bodies.0.length`` or ``materials.steel.density``, or the last
        words of such paths.

    Attributes
    ----------
    row : Row
    paths : dict of str to str
        What each name stands for; of several numbers the first.
    base : dict of str to Fraction
        Values in the system.
    speeds : dict of str to (Fraction or str, Fraction or str)
        E and rho of the wave speeds that have names, themselves or their names.
    """

    def __init__(self, system: System, symbols: Sequence[str]) -> None:
        check(system)
        if not isinstance(symbols, list | tuple) or not all(
            isinstance(x, str) for x in symbols
        ):
            message = f"must be a list of paths or words, such as ['length'], got {shown(symbols)}"
            raise InvalidModel([("symbols", message)])
        self.row, self.symbols = walk(system), list(symbols)
        self.paths: dict[str, str] = {}
        self.base: dict[str, Fraction] = {}
        self.speeds: dict[str, tuple[Any, Any]] = {}
        self._asked: list[str] = []
        self._named: list[str] = []
        self._of_material = {
            place: path
            for path, places in places_of(system).items()
            if path.startswith("materials.")
            for place in places
        }
        self._materials: dict[Any, int] = {}
        self._roots: dict[Fraction, Fraction] = {}
        self._numbers = read(self.row, self._take, self._material)
        known, named = (
            dict.fromkeys(word for path in paths for word in self._words(path))
            for paths in (self._asked, self._named)
        )
        problems = [
            (
                "symbols",
                f"{shown(symbol)} names no number of the formula beside the other "
                f"symbols; {suggestion(symbol, known)}",
            )
            for symbol in self.symbols
            if symbol not in named
        ]
        if problems or not symbols:
            raise InvalidModel(problems or [("symbols", "must name a number")])

    @property
    def free(self) -> list[str]:
        """Names of the numbers in the run that can be shifted, each on its own."""
        own = [name for name in self.base if name[0] not in "Er"]
        both = [
            rho
            for E, rho in self.speeds.values()
            if isinstance(E, str) and rho in self.base
        ]
        stand_ins = [
            c for c, of in self.speeds.items() if any(isinstance(x, str) for x in of)
        ]
        return [*own, *map(str, both), *stand_ins]

    def values(self, given: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """Numbers in the run, of other values of named numbers, and of wave speeds if given."""
        known = {**self.base, **given}
        for c, (E, rho) in self.speeds.items():
            modulus, density = (Fraction(known.get(x, x)) for x in (E, rho))
            if c not in given:  # where there are no waves it is 0
                known[c] = (
                    self._root(modulus / density)
                    if modulus > 0 < density
                    else Fraction(0)
                )
        return known

    def run(self, values: Mapping[str, Fraction], max_events: int) -> ExactRun:
        """Run the row, with these values of named numbers and wave speeds."""
        names = {name: Number(value, (name,)) for name, value in values.items()}
        numbers = Numbers(*(Program(of, Number)(names) for of in self._numbers))
        return run(self.row, numbers, max_events)

    def _name(self, name: str, path: str, value: Fraction) -> Any:
        """The name of the number at a path, or the number itself if it has none."""
        if not self.symbol_of(path) and name not in self.base:
            return value
        self._named.append(path)
        self.paths.setdefault(name, path)
        self.base[name] = value
        return name

    def _words(self, path: str) -> list[str]:
        """What may name the number at a path: the path, that of its material, and its last word."""
        return list(
            filter(None, (path, self._of_material.get(path), path.rpartition(".")[2]))
        )

    def symbol_of(self, path: str) -> str | None:
        """The symbol that names the number at a path."""
        return next((word for word in self._words(path) if word in self.symbols), None)

    def _take(self, path: str, value: float) -> Any:
        quantity = path.rpartition(".")[2]
        if (
            quantity == "gap" and value == 0
        ):  # bodies that touch have no gap to be named
            return ZERO
        self._asked.append(path)
        derived = quantity in ("transit_time", "impedance")
        if not self.symbol_of(path):
            return None if derived else Number(written(value))
        if quantity in ("velocity", "gap"):
            place = int(path.split(".")[1]) + 1
        else:
            place = self.row.paths.index(path.rpartition(".")[0])
        name = f"{LETTERS[quantity]}{place}"
        self._name(
            name, path, self._derived(quantity, place) if derived else written(value)
        )
        return Number(self.base[name], (name,))

    def _derived(self, quantity: str, place: int) -> Fraction:
        """Transit time L/c or impedance rho A c of a segment, of numbers as they are written."""
        s = self.row.segments[place - 1]
        E, rho = written(s.material.youngs_modulus), written(s.material.density)
        c = self._root(E / rho)
        return (
            written(s.length) / c
            if quantity == "transit_time"
            else rho * written(s.area) * c
        )

    def _material(self, s: Any, path: str) -> tuple[Number, Any]:
        """Wave speed and density of a segment, in terms of the numbers that have names."""
        path = f"{path}.material"
        self._asked.append(f"{path}.density")
        pair = s.material.youngs_modulus, s.material.density
        # rods of equal materials have them in common, but for one that is asked for by its path
        own = (
            path
            if {f"{path}.youngs_modulus", f"{path}.density"} & set(self.symbols)
            else ""
        )
        place = self._materials.setdefault((own, pair), len(self._materials) + 1)
        E, rho = (
            self._name(
                f"{LETTERS[quantity]}{place}", f"{path}.{quantity}", written(value)
            )
            for quantity, value in zip(("youngs_modulus", "density"), pair, strict=True)
        )
        square, named = written(pair[0]) / written(pair[1]), isinstance(E, str)
        if root(square) and not named and not isinstance(rho, str):
            return Number(self._root(square)), Number(rho)
        self.speeds[f"c{place}"] = E, rho
        c = Number(self._root(square), (f"c{place}",))
        if not isinstance(rho, str):
            return c, Number(rho)
        return c, Number(self.base[rho], (rho,)) if named else Number(E) / (c * c)

    def _root(self, square: Fraction) -> Fraction:
        """Root of a number; of those in a rational ratio to an earlier one, in that ratio."""
        for known, c in self._roots.items():
            ratio = root(square / known)
            if ratio:
                return ratio * c
        self._roots[square] = root(square) or _nearly_root(square)
        return self._roots[square]


def _nearly_root(square: Fraction) -> Fraction:
    """Square root of a fraction to `DIGITS` bits, rounded down."""
    more = max(
        0, DIGITS + square.denominator.bit_length() - square.numerator.bit_length()
    )
    return Fraction(
        math.isqrt((square.numerator << 2 * more) // square.denominator), 1 << more
    )
