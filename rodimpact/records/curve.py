"""Stress, strain, forces and velocities of a specimen, from the waves at its faces."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..model.arguments import array
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..units import shown
from .specimen import Specimen


@dataclass(frozen=True, eq=False)
class Curve:
    """Stress, strain, forces and velocities of a specimen over time.

    The columns, of shape (n,), are linear in the gauge strains, except the energy.
    Compression is positive.
    """

    times: Floats  # s
    strain: Floats
    strain_rate: Floats  # 1/s
    input_force: Floats  # N
    output_force: Floats  # N
    input_velocity: Floats  # m/s
    output_velocity: Floats  # m/s
    specimen: Specimen

    @property
    def stress(self) -> Floats:
        """Nominal stress from the transmitted wave alone, Pa, shape (n,)."""
        return self.output_force / self.specimen.section

    @property
    def energy(self) -> Floats:
        """Energy that the specimen has absorbed up to each time, J, shape (n,).

        It is the integral of F1 v1 - F2 v2 over time, 0 at the first time.
        """
        power = (
            self.input_force * self.input_velocity
            - self.output_force * self.output_velocity
        )
        return integral(power, self.times)

    @property
    def loading(self) -> slice:
        """Slice of the samples up to the largest strain, which is among them."""
        return slice(0, int(self.strain.argmax()) + 1)

    def at_strain(self, strain: Any, column: Floats) -> Floats:
        """Values of a column at given strains, interpolated while loading.

        Parameters
        ----------
        strain : float or array
            Below the first strain of the shot the result is the first value of the
            column; above the largest strain it is the value there.
        column : array, shape (n,)
            One of the columns, such as ``reduction.stress``.

        Returns
        -------
        array
            One value for each strain, in the unit of the column.

        Raises
        ------
        InvalidModel
            If the column has not as many numbers as `times`.
        """
        strains = array("strain", strain, "", "any")
        numbers = array("column", column, "")
        if numbers.shape != self.times.shape:
            message = f"must be a column of {len(self.times)} numbers, such as .stress"
            raise invalid_argument("column", f"{message}, got {shown(column)}")
        # Interpolation needs strains that do not decrease: each strain is replaced by
        # the largest one up to its time.
        reached = np.maximum.accumulate(self.strain[self.loading])
        interpolated: Floats = np.interp(strains, reached, numbers[self.loading])
        return interpolated


class Faces(NamedTuple):
    """Forces and velocities of both faces of a specimen, [time].

    Compression is positive.
    """

    input_force: Floats  # N
    output_force: Floats  # N
    input_velocity: Floats  # m/s
    output_velocity: Floats  # m/s


def curve_of(faces: Faces, specimen: Specimen, times: Floats) -> Curve:
    """The curve with the strain rate (v1 - v2)/L0, from forces and velocities.

    The strain is the integral of the rate over time, 0 at the first time.
    """
    rate = (faces.input_velocity - faces.output_velocity) / specimen.length
    return Curve(
        times=times,
        strain=integral(rate, times),
        strain_rate=rate,
        input_force=faces.input_force,
        output_force=faces.output_force,
        input_velocity=faces.input_velocity,
        output_velocity=faces.output_velocity,
        specimen=specimen,
    )


def integral(rate: Floats, times: Floats) -> Floats:
    """Integral of a rate over time up to each of the times, by the trapezoidal rule.

    The result has the shape of the times, and begins with 0.
    """
    from scipy.integrate import cumulative_trapezoid

    total: Floats = cumulative_trapezoid(rate, times, initial=0)
    return total
