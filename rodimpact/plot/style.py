"""Look of all figures: style sheets, colours of bodies, curves and values, and `look`.

The files `light.mplstyle` and `dark.mplstyle` hold everything that matplotlib has a
setting for; ``plt.style.use("rodimpact.plot.dark")`` gives a user's own figures the
same look. `Colours` adds the colours that matplotlib has no setting for.

Colours of signed values run from blue over nearly the colour of the paper, for 0, to
yellow. Colours of other values run from dark blue over grey to light yellow; their
lightness increases, so that the order of values is visible in grey prints, too. Blue
and yellow differ for every common kind of colour-blindness.
"""

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, TypeVar

import numpy as np
from matplotlib import RcParams, colors, rc_context, rc_params_from_file

from ..hints import explain_arguments
from ..model.arguments import check_choice, scalar
from ..model.frozen import invalid_argument
from ..units import shown

FONT = "DejaVu Sans"
NORMAL = 9.0  # height of letters, points
SMALL = 7.0
DASHES = ("-", "--", "-.", ":", (0, (6, 2, 1, 2, 1, 2)))  # one for each curve
COMPUTED: dict[str, Any] = {
    "marker": "o",
    "markersize": 3.5,
    "markerfacecolor": "none",
    "markeredgewidth": 0.8,
    "label": "computed",
}
"""Matplotlib's settings for marks of computed values beside a closed form."""
MM_PER_INCH = 25.4
MIN_WIDTH = 50.0  # mm, of a figure
MAX_WIDTH = 1000.0

RISING = colors.LinearSegmentedColormap.from_list(
    "rising",
    ["#16256e", "#53659f", "#a0a0a0", "#d6c05f", "#ffe94a"],
    101,  # steps: to the eye as smooth as 256
)
ON_LIGHT = colors.LinearSegmentedColormap.from_list(
    "signed on light", ["#16256e", "#7084c4", "#f4f4f1", "#eec654", "#c48600"]
)
ON_DARK = colors.LinearSegmentedColormap.from_list(
    "signed on dark", ["#9db7ff", "#4e62a0", "#262b33", "#967a30", "#ffe94a"]
)

P = ParamSpec("P")
R = TypeVar("R")


class Colours(NamedTuple):
    """Colours of paper, lines, bodies, series of curves, and signed values."""

    paper: str
    ink: str  # of text and important lines
    faint: str  # of frames, ticks and other lines
    wall: str
    mass: str
    series: tuple[str, ...]  # one for each of several curves
    signed: colors.Colormap


class Look(NamedTuple):
    """Style of figures, and width of new ones."""

    mode: str
    width: float | None  # mm; by default each figure has its own


def _sheet(mode: str) -> RcParams:
    """Read the settings of the style sheet of a mode, "light" or "dark"."""
    path = Path(__file__).with_name(f"{mode}.mplstyle")
    return rc_params_from_file(path, use_default_template=False)


def _colours(sheet: RcParams, wall: str, mass: str, signed: colors.Colormap) -> Colours:
    """`Colours` with those of a style sheet, and those that matplotlib cannot set.

    The latter are the colours `wall` and `mass` of bodies, and the palette `signed`.
    """
    return Colours(
        paper=sheet["figure.facecolor"],
        ink=sheet["text.color"],
        faint=sheet["axes.edgecolor"],
        wall=wall,
        mass=mass,
        series=tuple(sheet["axes.prop_cycle"].by_key()["color"]),
        signed=signed,
    )


SHEETS = {mode: _sheet(mode) for mode in ("light", "dark")}
LOOKS = {
    "light": _colours(SHEETS["light"], "#d9d9d9", "#33302e", ON_LIGHT),
    "dark": _colours(SHEETS["dark"], "#33373e", "#cfc8c0", ON_DARK),
}
INK = LOOKS["light"].ink  # ink on light fills, whatever the paper
FAINT = LOOKS["light"].faint
SERIES = LOOKS["light"].series

USUAL_LOOK = Look("light", None)
_current: ContextVar[Look] = ContextVar("look", default=USUAL_LOOK)


def colours() -> Colours:
    """Colours of the figure that is being drawn."""
    return LOOKS[_current.get().mode]


def wanted_width(usual: float) -> float:
    """Width that `look` asks for, inches; `usual` if it asks for none."""
    width = _current.get().width
    if width is None:
        return usual
    return width / MM_PER_INCH


@contextmanager
@explain_arguments
def look(mode: str = "light", width: float | None = None) -> Iterator[None]:
    """Draw figures on light or dark paper, and with a chosen width.

    This is a context manager. Only figures of this package that are drawn inside the
    ``with`` block have the look. A user's own figures take it by
    `matplotlib.pyplot.style.use` with the style sheets ``"rodimpact.plot.light"`` and
    ``"rodimpact.plot.dark"``.

    Parameters
    ----------
    mode : "light" or "dark"
    width : float, optional
        Width of new figures, mm; the size of letters does not change. A column of a
        journal is about 85 mm wide, a page about 175 mm. By default each figure has its
        own width.

    Raises
    ------
    ValueError
        For an unknown mode, or a width that is not between 50 and 1000 mm.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([rod, ri.Wall()]))
    >>> with ri.plot.look("dark", width=85):
    ...     picture = ri.plot.energy(solution)
    >>> float(round(25.4 * picture.ax.figure.get_figwidth(), 3))
    85.0
    """
    check_choice("mode", mode, LOOKS)
    if width is not None:
        width = scalar("width", width, "mm")
        if not MIN_WIDTH <= width <= MAX_WIDTH:
            limits = f"{MIN_WIDTH:g} to {MAX_WIDTH:g} mm"
            raise invalid_argument("width", f"must be {limits}, got {width!r}")
    before = _current.set(Look(mode, width))
    try:
        yield
    finally:
        _current.reset(before)


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Decorator: the function draws with the present `look`, not the user's settings.

    A text in place of the Axes is refused before the function is called, and an error
    for a wrong argument names the arguments that the function has.
    """
    parameters = inspect.signature(draw).parameters
    checked = explain_arguments(draw)  # the same function with better errors

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> R:
        """Check that `ax` is no text; call the function with the style sheet."""
        by_position = dict(zip(parameters, args, strict=False))
        _check_no_text(parameters, by_position | kwargs)
        sheet = SHEETS[_current.get().mode]
        # A user may have set NumPy to raise for numbers that underflow to 0.
        with np.errstate(under="ignore"), rc_context(sheet):
            return checked(*args, **kwargs)

    return drawn


def _check_no_text(
    parameters: Mapping[str, inspect.Parameter], arguments: Mapping[str, Any]
) -> None:
    """Raise InvalidModel if the argument `ax` is a text.

    The error advises to give the text by name, to the first parameter whose default is
    a text, else to leave it out.
    """
    ax = arguments.get("ax")
    if not isinstance(ax, str):
        return
    remedy = "leave it out"
    for name, parameter in parameters.items():
        if isinstance(parameter.default, str):
            remedy = f"give the text by name, {name}={shown(ax)}"
            break
    raise invalid_argument("ax", f"must be an Axes, got {shown(ax)}; {remedy}")


def centred(values: Iterable[float], reference: float = 0.0) -> colors.Normalize:
    """Colour limits symmetric about a reference value, which include all values.

    NaN is ignored. If no value differs from the reference, the limits are 1 from it.
    """
    largest = 0.0  # difference from the reference
    for value in values:
        largest = max(largest, abs(float(value) - reference))
    if largest == 0:
        largest = 1.0
    return colors.Normalize(reference - largest, reference + largest)


def ink_on(
    norm: colors.Normalize, value: float, palette: colors.Colormap | None = None
) -> str:
    """Colour of text that is legible on the colour of `value`: white or dark ink.

    The palette is by default that of signed values.
    """
    if palette is None:
        palette = colours().signed
    red, green, blue, _ = palette(norm(value))
    # Weights of the eye's sensitivity to the three colours
    lightness = 0.3 * red + 0.59 * green + 0.11 * blue
    if lightness < 0.45:
        return "white"
    return INK
