"""Stress and strain of a specimen with error bands, as a table, file or Dataset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..hints import explain_missing
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..storage.tables import align
from ..units import format_si
from .alignment import Alignment, alignment_sentence
from .curve import Curve
from .multichannel import signals_to_xarray, write_signals
from .signal import Signal
from .strain_table import strain_label, table_strains
from .two_bar_shot import Shifts
from .verdict import Verdict

TABLE_COLUMNS = {
    "strain_rate": "strain rate",
    "stress": "stress",
    "stress_band": "+-",
    "one_sample": "one sample",
    "equilibrium": "(F1 - F2)/mean",
}
"""Head of each column of the printed table, by the attribute of `Reduction`."""
MIN_TOTAL_FORCE_RATIO = 1e-2
"""Least ratio of abs(F1 + F2) to its largest value for which `equilibrium` is given."""


@explain_missing()
@dataclass(frozen=True, eq=False)
class Reduction(Curve):
    """Stress and strain of a specimen over time; made by `reduce`.

    Compression is positive.

    Attributes
    ----------
    times : array, shape (n,)
        Times at the faces of the specimen, with the zero of the records, s.
    strain, strain_rate : array, shape (n,)
        Nominal: decrease of length divided by `Specimen.length`, 1 and 1/s.
    stress, two_wave_stress, three_wave_stress : array, shape (n,)
        Nominal, from the force of the output bar, the force of the input bar, and the
        mean of both, Pa.
    input_force, output_force : array, shape (n,)
        Forces on the two faces, N.
    input_velocity, output_velocity : array, shape (n,)
        Velocities of the two faces, m/s.
    stress_band, strain_band : array, shape (n,)
        Half widths of the 95 % bands, Pa and 1, due to noise, errors of a calibration,
        and the frequencies that the bars cannot carry. If equal forces are assumed, the
        band of the strain also includes an error of time: one sample between the two
        records, or the error of the start of a direct impact.
    one_sample : array, shape (n,)
        Largest change of `stress` at the same strain if the transmitted wave is shifted
        by one sample, Pa.
    shifts : (reflected, transmitted)
        Times by which the reflected and the transmitted wave were moved earlier to
        align them, s.
    specimen : Specimen
    verdict : Verdict
        Equilibrium, peak stress, strain rate and energy; the first lines of ``print``.
    alignment : Alignment or None
        Balance of the forces before and after an alignment.
    disperses : bool
        Whether the waves were propagated with the exact first mode.
    doubts : tuple of str
        Contradictions between the records and the arguments: an oversized specimen,
        gauges of one bar that disagree, waves that arrive too early or too late, an
        echo that contradicts the wave speed, shifts at the limit of `align_within`, an
        alignment that makes the balance worse, forces out of balance. Each sentence has
        a number and a remedy; empty for a shot without contradictions.

    Examples
    --------
    The specimen of this computed shot is a spring, so its modulus is k L0/A0 = 20 GPa:

    >>> import rodimpact as ri
    >>> metal = ri.Material("metal", youngs_modulus=2e11, density=8000)  # c = 5000 m/s
    >>> bar = ri.Rod(1.5, area=1e-4, material=metal)
    >>> striker = ri.Rod(0.3, area=1e-4, material=metal, velocity=10.0)
    >>> row = ri.System([striker, bar, bar], contacts=[ri.Rigid(), ri.Spring(2e8)])
    >>> shot = ri.solve(row, until=6e-4)
    >>> gauges = [ri.BarGauge(shot.gauge(body, 0.75).signal(1e-6), distance=0.75)
    ...           for body in (1, 2)]
    >>> found = ri.reduce(*gauges, bar, ri.Specimen(5e-3, area=5e-5))
    >>> middle = abs(found.stress - found.stress.max() / 2).argmin()
    >>> round(found.stress[middle] / found.strain[middle] / 1e9)
    20
    """

    stress_band: Floats
    strain_band: Floats
    one_sample: Floats
    shifts: Shifts
    verdict: Verdict
    alignment: Alignment | None
    disperses: bool
    doubts: tuple[str, ...]

    def __repr__(self) -> str:
        """Number of samples and largest strain."""
        return (
            f"<Reduction of {len(self.times)} samples, "
            f"strain up to {self.strain.max():.3g}>"
        )

    @property
    def two_wave_stress(self) -> Floats:
        """Nominal stress from the incident and the reflected wave, Pa, shape (n,)."""
        return self.input_force / self.specimen.section

    @property
    def three_wave_stress(self) -> Floats:
        """Mean of the stresses at both faces, Pa, shape (n,)."""
        return (self.stress + self.two_wave_stress) / 2

    @property
    def equilibrium(self) -> Floats:
        """Difference of the forces over their mean, 2 (F1 - F2)/(F1 + F2), shape (n,).

        It is nan if abs(F1 + F2) is below `MIN_TOTAL_FORCE_RATIO` of its largest value.
        """
        total = self.input_force + self.output_force
        is_small = np.abs(total) < MIN_TOTAL_FORCE_RATIO * np.abs(total).max()
        total[is_small] = np.nan
        return 2 * (self.input_force - self.output_force) / total

    @property
    def true_strain(self) -> Floats:
        """-ln(1 - strain), shape (n,).

        ValueError unless the specimen is incompressible.
        """
        self._require_constant_volume()
        return -np.log1p(-self.strain)

    @property
    def true_stress(self) -> Floats:
        """Stress (1 - strain), Pa, shape (n,).

        ValueError unless the specimen is incompressible.
        """
        self._require_constant_volume()
        return self.stress * (1 - self.strain)

    def _require_constant_volume(self) -> None:
        """Raise InvalidModel unless the specimen is incompressible."""
        if not self.specimen.incompressible:
            message = "true stress and strain need a constant volume"
            raise invalid_argument(
                "specimen", f"{message}: give Specimen(..., incompressible=True)"
            )

    @property
    def signals(self) -> dict[str, Signal]:
        """All columns as signals over `times`, by name, in SI units.

        For an incompressible specimen they include ``true_strain`` and ``true_stress``.
        `equilibrium` is left out, because it may contain nan.
        """
        units = {
            "strain": "",
            "strain_rate": "1/s",
            "stress": "Pa",
            "stress_band": "Pa",
            "strain_band": "",
            "one_sample": "Pa",
            "two_wave_stress": "Pa",
            "three_wave_stress": "Pa",
            "input_force": "N",
            "output_force": "N",
            "input_velocity": "m/s",
            "output_velocity": "m/s",
            "energy": "J",
        }
        if self.specimen.incompressible:
            units["true_strain"] = ""
            units["true_stress"] = "Pa"
        signals = {}
        for name, unit in units.items():
            column = getattr(self, name)
            signals[name] = Signal(column, self.times, unit=unit, name=name)
        return signals

    def to_csv(self, path: str, *, force: bool = False) -> None:
        """Write all columns over time as a CSV file.

        FileExistsError if the file exists and `force` is false.
        """
        write_signals(path, self.signals, force=force)

    def to_xarray(self) -> Any:
        """Return all columns as a Dataset over ``time`` (extra ``xarray``)."""
        return signals_to_xarray(self.signals)

    def __str__(self) -> str:
        """Lines of the verdict, doubts, alignment if any, a table, and the method.

        The table shows stress, its errors and the equilibrium over strain.
        """
        lines = list(self.verdict.sentences)
        lines += [f"doubtful: {doubt}" for doubt in self.doubts]
        if self.alignment is not None:
            lines.append(alignment_sentence(self.alignment, self.shifts))
        lines += [align(self._rows()), self._method()]
        return "\n".join(lines)

    def _rows(self) -> list[list[str]]:
        """Row of heads and rows of numbers with units, as texts, of the printed table.

        The rows belong to round strains, the strain at the peak stress, and the largest
        strain, all while loading. "-" stands for an equilibrium of nan.
        """
        at_peak = self.verdict.strain_at_peak
        # The last strain of the loading is the largest one.
        strains = table_strains(at_peak, float(self.strain[self.loading][-1]))
        columns = {}
        for name in TABLE_COLUMNS:
            columns[name] = self.at_strain(strains, getattr(self, name))
        rows = [["strain", *TABLE_COLUMNS.values()]]
        for i, strain in enumerate(strains):
            balance = "-"
            if np.isfinite(columns["equilibrium"][i]):
                balance = f"{100 * columns['equilibrium'][i]:.1f} %"
            rows.append(
                [
                    strain_label(strain, at_peak),
                    f"{columns['strain_rate'][i]:.0f} 1/s",
                    format_si(columns["stress"][i], "Pa", digits=4),
                    format_si(columns["stress_band"][i], "Pa", digits=2),
                    format_si(columns["one_sample"][i], "Pa", digits=2),
                    balance,
                ]
            )
        return rows

    def _method(self) -> str:
        """Line on the source of the stress, and on the propagation of the waves.

        It also gives the time, in us, for which the waves are separated.
        """
        propagation = "without dispersion"
        if self.disperses:
            propagation = "with the exact first mode"
        duration = 1e6 * (self.times[-1] - self.times[0])  # us
        return (
            f"stress from the transmitted wave; waves propagated {propagation}, and "
            f"separated until {duration:.4g} us after they arrive"
        )
