"""Rows of the printed tables of stress over strain."""

from collections.abc import Sequence

ROUND_STRAINS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5)
"""Strains of the printed tables; those that a shot does not reach are left out."""


def table_strains(at_peak: float, largest: float) -> Sequence[float]:
    """Increasing strains for a table: round ones, that at peak stress, the largest.

    Round strains above the largest one, and repeated strains, are left out.
    """
    strains = {at_peak, largest}
    for strain in ROUND_STRAINS:
        if strain < largest:
            strains.add(strain)
    return sorted(strains)


def strain_label(strain: float, at_peak: float) -> str:
    """A strain in percent, marked "(peak)" if it equals `at_peak`."""
    text = f"{100 * strain:.3g} %"
    if strain == at_peak:
        return f"{text} (peak)"
    return text
