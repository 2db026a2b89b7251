"""Rows of the printed tables of stress over strain."""

from collections.abc import Sequence

ROUND_STRAINS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5)
"""Strains of the printed tables, as far as a shot reaches them."""


def table_strains(at_peak: float, largest: float) -> Sequence[float]:
    """Round strains, the strain at the peak stress, and the largest strain, in order.

    Round strains above the largest one are left out.
    """
    strains = {at_peak, largest}
    for strain in ROUND_STRAINS:
        if strain < largest:
            strains.add(strain)
    return sorted(strains)


def strain_label(strain: float, at_peak: float) -> str:
    """A strain in percent, marked where the stress has its peak."""
    text = f"{100 * strain:.3g} %"
    if strain == at_peak:
        return f"{text} (peak)"
    return text
