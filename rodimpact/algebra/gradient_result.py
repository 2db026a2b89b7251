"""What gradient() returns: derivatives by path, and where they differ on both sides."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..methods.row import Array
from ..model.frozen import nearest
from ..units import format_si, shown


class Kink(NamedTuple):
    """A place where a derivative differs on both sides, or is known on one side only.

    Each attribute is a number, or an array of the shape of a family.

    Attributes
    ----------
    below, above : float
        Derivatives on the side of smaller and of larger numbers; nan on a side that does not exist,
        such as below a gap of 0.
    jump : float
        The quantity above minus the quantity below.
    time : float
        Time of the first event that differs between the sides, s; nan without a kink.
    node : int
        Place of this event: 0 is the left end of the row, then come the joints of its segments.
    event : str
        What happens there; empty without a kink.

    Examples
    --------
    At equal lengths e = l1/l2 below and e = l2/l1 above:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> rods = [ri.Rod(1.0, area=1e-4, material=steel, velocity=v) for v in (1.0, 0.0)]
    >>> kink = ri.gradient(ri.System(rods), wrt=["bodies.0.length"]).kinks["bodies.0.length"]
    >>> round(float(kink.below), 6), round(float(kink.above), 6)
    (1.0, -1.0)
    """

    below: Any
    above: Any
    jump: Any
    time: Any
    node: Any
    event: Any


@dataclass(frozen=True)
class Gradient:
    """Derivatives of a result of a collision; as an array, [..., path].

    Attributes
    ----------
    of : str
    wrt : tuple of str
    value : float or array
        Of the quantity.
    values : dict of str to float or array
        Derivative by path, where it is the same on both sides; else nan.
    one_sided : dict of str to (float or array, float or array)
        Derivatives below and above each number.
    kinks : dict of str to Kink
        By the paths that have any.
    unit : str
        Of the quantity; "" if it has none.
    units : dict of str to str
        Of each derivative, by path.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> slopes = ri.gradient(ri.System([left, right]), wrt=["bodies.0.length"])
    >>> round(float(slopes["bodies.0.length"]), 9), slopes.units["bodies.0.length"]     # e = l1/l2
    (1.0, '1/m')
    """

    of: str
    wrt: tuple[str, ...]
    value: Any
    values: Mapping[str, Any]
    one_sided: Mapping[str, tuple[Any, Any]]
    kinks: Mapping[str, Kink]
    unit: str
    units: Mapping[str, str]

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.stack([self.values[path] for path in self.wrt], -1).astype(dtype or float)

    def __getitem__(self, path: str) -> Any:
        if not isinstance(path, str) or path not in self.values:
            raise KeyError(f"no derivative by {shown(path)}; {nearest(path, self.wrt)}")
        return self.values[path]

    def __str__(self) -> str:
        if np.ndim(self.value):
            found = f"of {np.size(self.value)} members, by {', '.join(self.wrt)}"
            return f"derivatives of {self.of} {found}"
        value = f"{self.value:.10g} {self.unit}".rstrip()
        lines = [f"{self.of} = {value}; its derivative by"]
        for path in self.wrt:
            below, above = self.one_sided[path]
            unit = f" {self.units[path]}" if self.units[path] else ""
            text = f"{self.values[path]:.8g}{unit}"
            if path in self.kinks:
                kink = self.kinks[path]
                text = f"{below:.8g} below, {above:.8g} above{unit}: {kink.event}"
                text += f" (node {kink.node}, {format_si(kink.time, 's')})"
            lines.append(f"  {path}: {text}".rstrip())
        return "\n".join(lines)
