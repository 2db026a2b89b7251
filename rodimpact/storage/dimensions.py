"""Arrays of a family from arrays whose dimensions have names, as those of xarray."""

from typing import Any

import numpy as np

from ..model.frozen import refusal
from ..model.quantities import Floats, floats
from ..units import in_si, shown
from .extras import optional


def by_dimension(*arrays: Any) -> tuple[Floats, ...]:
    """Return the numbers of xarray DataArrays with an axis for each dimension, the same for all.

    Parameters
    ----------
    *arrays : DataArray
        In SI units, or in those of their attribute ``units``. Dimensions of the same name have the
        same coordinates.

    Returns
    -------
    tuple of array
        One for each argument, in SI units. They broadcast: each dimension is an axis, in the order
        of first appearance. The axis has length 1 in arrays without this dimension.

    Raises
    ------
    ValueError
        If that is no DataArray of numbers, its unit is unknown, or coordinates differ.

    Examples
    --------
    >>> import rodimpact as ri, xarray
    >>> lengths = xarray.DataArray([200, 400, 800], dims="length", attrs={"units": "mm"})
    >>> areas = xarray.DataArray([1e-4, 2e-4], dims="area")
    >>> length, area = by_dimension(lengths, areas)
    >>> length.shape, area.shape
    ((3, 1), (1, 2))
    >>> left = ri.Rod(length, area=area, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> ri.sweep(ri.System([left, right])).to_xarray()["restitution"].dims
    ('bodies.0.length', 'bodies.0.area')
    """
    xarray = optional("xarray", "xarray")
    for given in arrays:
        if not isinstance(given, xarray.DataArray):
            raise refusal("arrays", f"must be xarray DataArrays, got {shown(given)}")
    names = list(dict.fromkeys(name for given in arrays for name in given.dims))
    axes = []
    for each in xarray.align(*arrays, join="exact"):
        values, _ = in_si(floats(each.values, ""), each.attrs.get("units", ""))
        ordered = (
            each.copy(data=values)
            .transpose(*(n for n in names if n in each.dims))
            .values
        )
        axes.append(np.reshape(ordered, [each.sizes.get(name, 1) for name in names]))
    return tuple(axes)
