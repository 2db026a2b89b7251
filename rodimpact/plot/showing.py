"""Figures in a window, from a script."""

import sys
import tempfile
from pathlib import Path
from typing import Any

from matplotlib.backends.registry import BackendFilter, backend_registry

from ..hints import explain_arguments
from .files import save
from .panels import figure_of


@explain_arguments
def show(picture: Any) -> None:
    """Show a figure in a window, and wait until it is closed.

    In a notebook the figure appears below the cell. Where no window can be opened, such
    as on a computer without a display, the figure is written to a PNG file in the
    folder for temporary files, and a line on the standard error names this file.

    Parameters
    ----------
    picture : Figure, Axes, or what a function of this package returned
        A film is written by `save` instead.

    Raises
    ------
    ValueError
        If `picture` is none of these.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([rod, ri.Wall()]))
    >>> ri.plot.show(ri.plot.energy(solution))                  # doctest: +SKIP
    """
    import matplotlib.pyplot as plt  # opens no window before it is needed

    figure = figure_of(picture)
    backend = plt.get_backend()
    registry: Any = backend_registry
    without_window = registry.list_builtin(BackendFilter.NON_INTERACTIVE)
    if backend.lower() in without_window:
        path = Path(tempfile.mkdtemp(prefix="rodimpact-"), "figure.png")
        save(figure, path)
        sys.stderr.write(
            f"No window can be opened here (matplotlib's backend is {backend}); "
            f"the figure is in {path}. ri.plot.save(picture, path) writes it "
            "elsewhere.\n"
        )
        return
    # Pyplot opens windows of the figures that it keeps. `plt.figure` calls the class
    # given to it and keeps the result: this "class" returns the figure itself.
    is_kept = any(plt.figure(number) is figure for number in plt.get_fignums())
    if not is_kept:
        return_figure: Any = lambda **_: figure  # noqa: E731
        plt.figure(FigureClass=return_figure)
    plt.show()
