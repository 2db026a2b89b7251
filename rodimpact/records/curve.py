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
    """Stress, strain, forces and velocities over time, and what follows from them.

    Its columns, of shape (n,), are linear in the gauge strains.
    """

    times: Floats
    strain: Floats
    strain_rate: Floats
    input_force: Floats
    output_force: Floats
    input_velocity: Floats
    output_velocity: Floats
    specimen: Specimen

    @property
    def stress(self) -> Floats:
        """Nominal stress from the transmitted wave alone, Pa, shape (n,)."""
        return self.output_force / self.specimen.section

    @property
    def energy(self) -> Floats:
        """Energy that the specimen has absorbed up to each time, J, shape (n,).

        It is the integral of F1 v1 - F2 v2 over time, from 0 at the first time.
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
        """A column while loading, up to the largest strain, at strains, not times.

        Parameters
        ----------
        strain : float or array
            Strains; below the first and above the largest strain of the shot, its first
            and its last value hold.
        column : array, shape (n,)
            One of the columns, such as ``reduction.stress``.

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
        # Interpolation takes strains that do not fall: the largest one up to each time.
        reached = np.maximum.accumulate(self.strain[self.loading])
        interpolated: Floats = np.interp(strains, reached, numbers[self.loading])
        return interpolated


class Faces(NamedTuple):
    """Forces and velocities of both faces of a specimen, [time].

    Compression is positive.
    """

    input_force: Floats  # N
    output_force: Floats
    input_velocity: Floats  # m/s
    output_velocity: Floats


def curve_of(faces: Faces, specimen: Specimen, times: Floats) -> Curve:
    """The curve with the strain rate (v1 - v2)/L0, from forces and velocities.

    The strain is the integral of the rate, from 0 at the first time.
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
    """Integral from the first time to each of the times, by trapezia: first 0."""
    from scipy.integrate import cumulative_trapezoid

    total: Floats = cumulative_trapezoid(rate, times, initial=0)
    return total
