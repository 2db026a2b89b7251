"""The pictures of the README, drawn anew: `python -m validation.figures`.

The files are the same in every run with the same matplotlib: no dates, no random ids.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

import rodimpact as ri

FOLDER = Path(__file__).parent / "figures"
STEEL, AREA = ri.materials.steel, 1e-4


def rods(*lengths: float) -> list[ri.Rod]:
    """Steel rods of one thickness; the first comes at 1 m/s, the others are at rest."""
    return [ri.Rod(length, area=AREA, material=STEEL, velocity=0.0 if i else 1.0)
            for i, length in enumerate(lengths)]


def restitution_of_lengths() -> tuple[list[float], list[float]]:
    """Ratios of lengths, simple and not, and the e that comes out."""
    ratios = [*(i / 20 for i in range(1, 21)), 0.1 / 0.3, 1 / math.e, math.sqrt(0.5)]
    return ratios, [ri.collide(*rods(ratio, 1.0)).restitution for ratio in ratios]


def main() -> None:
    """Draw every picture."""
    FOLDER.mkdir(exist_ok=True)
    unequal = ri.solve(ri.System(rods(0.4, 1.0)))
    equal = ri.solve(ri.System(rods(1.0, 1.0)))
    cradle = ri.solve(ri.System(rods(*[0.2] * 5)))
    pictures = {
        "unequal_rods": ri.plot.spacetime(unequal).ax,
        "unequal_rods_stages": ri.plot.snapshots(unequal).ax,
        "unequal_rods_contact": ri.plot.contact(unequal).force_ax,
        "unequal_rods_energy": ri.plot.energy(unequal).ax,
        "equal_rods": ri.plot.spacetime(equal).ax,
        "cradle": ri.plot.spacetime(cradle).ax,
        "restitution": ri.plot.restitution(*map(np.array, restitution_of_lengths())).ax,
    }
    for name, ax in pictures.items():
        path = FOLDER / f"{name}.svg"
        ri.plot.save(ax.figure, path, force=True)
        print(f"{path.stat().st_size / 1e3:6.1f} kB  {path}")


if __name__ == "__main__":
    main()
