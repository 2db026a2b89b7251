"""Records of three Hopkinson bars, compared with several models.

The incident pulse. A striker hits the bar with rounded ends (Hertz) or with flat ends.
`fit` finds the length of the striker, which determines the duration of the pulse, and
one number of the contact or of the measuring chain. Time and amplitude are also fitted,
because neither the trigger nor the speed was recorded. The misfit is the root mean
square of the difference, divided by the plateau, in per cent::

    model                                             titanium  mini aluminium  steel
    flat ends, waves that keep their shape                 8.4             7.6    8.7
    Hertz, exact mode in the bar                           1.7             3.7    3.3
    Hertz, Rayleigh-Love                                   1.9             3.6    3.3
    Hertz, Mindlin-Herrmann                                1.5             3.5    2.8
    Hertz, Mindlin-Herrmann, exact mode from 2 diameters   1.4             3.5    3.1
    flat ends, a blur of the chain, exact mode             3.2             3.6    2.5
    Hertz, Mindlin-Herrmann, section of the striker free   1.3             3.1    2.7
    Hertz, Mindlin-Herrmann, a blur of the chain           1.5             3.4    2.1

The exact first mode (Pochhammer and Chree) alone describes dispersion in the bar, but
not in the striker, through which the release wave runs twice. The theory of Mindlin and
Herrmann near the struck end also describes dispersion in the striker. The section of
the striker represents its impedance: for titanium the fitted diameter is 9.65 mm, and
the true diameter is 9.47 mm. Repeated shots differ by 1 to 3 %. `python -m
validation.measured_pulses` prints this table with the processor time of each fit.

Which addition to Hertz and Mindlin-Herrmann earns its place? The first number is the
misfit. The second number is the misfit of blocks that a fit to the other blocks
predicts (`fit` with `additions`). A star marks an addition that earns its place::

    addition                   titanium      mini aluminium    steel
    none                       1.49, 1.88    3.50, 3.88        2.76, 3.50
    offset and trend           1.31, 1.75 *  3.49, 3.89        2.67, 3.39 *
    blur                       1.49, 1.86    3.38, 4.01        2.13, 2.51 *
    section of the striker     1.25, 1.66 *  3.06, 3.45 *      2.72, 3.59

With its wave speed free as well, titanium has 4726 +- 24 m/s by the exact mode in the
bar alone, 4810 +- 20 m/s with Mindlin and Herrmann's theory near the struck end, 4992
+- 17 m/s with that theory all the way, and 4529 +- 26 m/s with Rayleigh and Love's. The
laboratory calibrated 4866 m/s; E and rho give 4975 m/s. So the choice of theory changes
the wave speed more than the noise, from which the standard errors follow: `Fit.against`
prints the change of each number. With a given wave speed of 4866 m/s the fitted striker
is 124.0 +- 0.3 mm long. With 4975 m/s it is 126.7 +- 0.3 mm long. The true length was
127 mm.

Equilibrium of the specimen. The incident, the reflected and the transmitted pulse are
propagated to the specimen. The sum of the forces of the first two pulses must be the
force of the third pulse. The misfit is computed for the time in which the incident
pulse is above half of its height, and for 20 us before and after. The reflected and the
transmitted pulse may each be shifted by up to 6 us and scaled by up to 6 %, because of
errors of the positions and calibrations of gauges. Then the misfit is 2.5 % for
titanium and 2.0 % for steel. Without dispersion it is 4.6 and 3.4 %. Without shifts and
factors it is 3.9 and 6.7 %.

The expected misfit is 0, with bounds slightly above these numbers.

Source: measurements, see records/README.md; A. Tyas and A. J. Watson, International
Journal of Impact Engineering 25 (2001) 87.
"""

import math
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

import rodimpact as ri

from .table import FOLDER, Case, Rows

EXACT_MODE_DISTANCE = 2.0  # diameters from the struck end, where the exact mode begins
TIME_FREEDOM = 6.0  # shift that a pulse at the specimen may have, us
GAIN_FREEDOM = 0.06  # change of size that it may have, relative
SECTION_FREEDOM = 0.2  # change that diameter or area of the striker may have, relative
LENGTH = "bodies.0.length"
STIFFNESS = "contacts.0.stiffness"
SPEED = "materials.bar.wave_speed"
BLUR = "records.0.blur"
STIFFNESS_BOUNDS = {STIFFNESS: (1e7, 1e12)}  # of the rounded ends, N/m^1.5
BLUR_BOUNDS = {BLUR: (0.0, 1e-5)}  # of the measuring chain, s
CELLS_PER_RADIUS = 3.8  # cells of runs with a theory of lateral inertia
MISFIT_OF_PULSE = "misfit of the incident pulse, %"
MISFIT_OF_FORCES = "misfit of the forces at the specimen, %"

Span = tuple[float, float]


class Windows(NamedTuple):
    """Spans of the record in which the pulses are, s."""

    incident: Span
    reflected: Span
    transmitted: Span


class Shot(NamedTuple):
    """A record, its bars, and bounds of the length of the striker."""

    file: str
    source: str
    density: float  # kg/m^3
    bar: ri.waves.Bar
    to_gauge: float  # distance from the struck end, m
    to_specimen: tuple[float, float]  # distance from the gauge of either bar, m
    windows: Windows
    length_bounds: tuple[float, float]  # of the striker's length, m
    side: float | None = None  # side of square bars, m


TITANIUM = Shot(
    file="lanl_titanium_bars.csv",
    source="LANL HopPyBar",
    density=4416.0,
    bar=ri.waves.Bar(4865.9, 0.3303, 4.735e-3),
    to_gauge=0.381,
    to_specimen=(0.381, 0.381),
    windows=Windows((-20e-6, 120e-6), (130e-6, 275e-6), (130e-6, 275e-6)),
    length_bounds=(0.115, 0.135),
)
ALUMINIUM_SIDE = 2.11e-3  # m
ALUMINIUM = Shot(
    file="lanl_aluminium_bars.csv",
    source="LANL HopPyBar",
    density=2810.0,
    # The radius is that of a round bar with the square one's radius of gyration.
    bar=ri.waves.Bar(5051.0, 0.333, ALUMINIUM_SIDE / math.sqrt(3)),
    to_gauge=0.102,
    to_specimen=(0.10202, 0.10135),
    windows=Windows((-10e-6, 30e-6), (35e-6, 75e-6), (35e-6, 75e-6)),
    length_bounds=(0.020, 0.030),
    side=ALUMINIUM_SIDE,
)
STEEL = Shot(
    file="yao_steel_bars.csv",
    source="Yao",
    density=7800.0,
    bar=ri.waves.Bar(5189.0, 0.29, 10e-3),
    to_gauge=1.08,
    to_specimen=(1.02, 0.77),
    windows=Windows((-50e-6, 260e-6), (360e-6, 540e-6), (300e-6, 540e-6)),
    length_bounds=(0.18, 0.22),
)
SHOTS = {"titanium": TITANIUM, "mini aluminium": ALUMINIUM, "steel 945": STEEL}
TITANIUM_SPEED_FROM_MODULI = 4975.0  # (E/rho)^(1/2), m/s
MINDLIN_HERRMANN = "mindlin-herrmann"
RAYLEIGH_LOVE = "rayleigh-love"
HERTZ_AND_EXACT_MODE = "Hertz, exact mode in the bar"
STRIKER_SECTION = "section of the striker free"
BLUR_OF_CHAIN = "blur of the chain"
MODELS: dict[str, dict[str, Any]] = {  # arguments of `fitted`
    "flat ends, waves that keep their shape": {"exact": False},
    "flat ends, exact mode in the bar": {},
    "Hertz, Rayleigh-Love": {
        "vary": STIFFNESS_BOUNDS,
        "theory": RAYLEIGH_LOVE,
        "exact": False,
    },
    "Hertz, Mindlin-Herrmann": {
        "vary": STIFFNESS_BOUNDS,
        "theory": MINDLIN_HERRMANN,
        "exact": False,
    },
    HERTZ_AND_EXACT_MODE: {"vary": STIFFNESS_BOUNDS},
    "Hertz, Mindlin-Herrmann, exact mode from 2 diameters": {
        "vary": STIFFNESS_BOUNDS,
        "theory": MINDLIN_HERRMANN,
    },
    "flat ends, blur, exact mode in the bar": {"vary": BLUR_BOUNDS},
    f"Hertz, Mindlin-Herrmann, {STRIKER_SECTION}": {
        "vary": STIFFNESS_BOUNDS,
        "theory": MINDLIN_HERRMANN,
        "exact": False,
        "free_section": True,
    },
    f"Hertz, Mindlin-Herrmann, {BLUR_OF_CHAIN}": {
        "vary": STIFFNESS_BOUNDS | BLUR_BOUNDS,
        "theory": MINDLIN_HERRMANN,
        "exact": False,
    },
}
BOUNDS = {  # bounds of the misfit, %, one a model
    "titanium": (8.6, 6.9, 2.1, 1.5, 1.8, 1.5, 3.4, 1.3, 1.5),
    "mini aluminium": (7.9, 7.1, 3.8, 3.7, 3.8, 3.7, 3.7, 3.2, 3.5),
    "steel 945": (9.0, 7.2, 3.5, 3.0, 3.5, 3.2, 2.7, 3.0, 2.4),
}


def record(shot: Shot) -> list[ri.Signal]:
    """Signals of the incident and the transmitted bar."""
    signals = ri.read_signals(FOLDER / "records" / shot.file)
    return list(signals.values())


def section_of(shot: Shot, theory: str | None) -> dict[str, Any]:
    """Arguments of a rod for a bar's section: a diameter, or area and polar moment.

    A square bar has the polar moment None unless a theory of lateral inertia is given.
    """
    if shot.side is None:
        return {"diameter": 2 * shot.bar.radius}
    polar_moment = None
    if theory:
        polar_moment = shot.side**4 / 6
    return {"area": shot.side**2, "polar_moment": polar_moment}


def section_bounds(shot: Shot) -> dict[str, Span]:
    """Bounds of a round striker's diameter, m, or of a square one's area, m^2.

    They are SECTION_FREEDOM below and above the value of the bar, by the path of the
    number.
    """
    least = 1 - SECTION_FREEDOM
    most = 1 + SECTION_FREEDOM
    if shot.side is None:
        diameter = 2 * shot.bar.radius
        return {"bodies.0.diameter": (least * diameter, most * diameter)}
    area = shot.side**2
    return {"bodies.0.area": (least * area, most * area)}


def row_of(
    shot: Shot, speed: float, law: ri.Rigid | ri.Hertz, theory: str | None, until: float
) -> ri.System:
    """Striker and bar, the bar so long that no wave is back at its gauge at `until`.

    The striker has the middle of the bounds of its length, and the speed 10 m/s; a fit
    finds length and gain.
    """
    material = ri.Material(
        "bar",
        youngs_modulus=shot.density * speed**2,
        density=shot.density,
        poisson_ratio=shot.bar.poisson_ratio,
    )
    section = section_of(shot, theory)
    striker = ri.Rod(
        sum(shot.length_bounds) / 2,
        velocity=10.0,
        material=material,
        lateral_inertia=theory,
        **section,
    )
    # A wave from the far end is back after more than half of its way at `until`.
    bar_length = 0.6 * (speed * until + shot.to_gauge)
    bar = ri.Rod(
        bar_length,
        material=material,
        lateral_inertia=theory,
        **section,
    )
    return ri.System([striker, bar], contacts=[law])


def fitted(
    shot: Shot,
    vary: dict[str, tuple[float, float]] | None = None,
    theory: str | None = None,
    exact: bool = True,
    speed: float | None = None,
    starts: int = 1,
    *,
    free_section: bool = False,
) -> ri.Fit:
    """Fit of the incident pulse.

    Parameters
    ----------
    shot : Shot
        The record and its bars.
    vary : dict, optional
        Bounds of parameters that are found, beside the length of the striker. Ends
        whose stiffness is not among them are flat.
    theory : str, optional
        Theory of lateral inertia in which waves run near the struck end. Without one
        they keep their shape.
    exact : bool
        Whether the exact mode carries the pulse from EXACT_MODE_DISTANCE to the gauge.
    speed : float, optional
        Bar speed, m/s, if it is not that of the shot.
    starts : int
        Number of searches.
    free_section : bool
        Whether the section of the striker is found, up to SECTION_FREEDOM.
    """
    unknown = {LENGTH: shot.length_bounds}
    if free_section:
        unknown.update(section_bounds(shot))
    if vary is not None:
        unknown.update(vary)
    contact: ri.Rigid | ri.Hertz = ri.Rigid()
    if STIFFNESS in unknown:
        contact = ri.Hertz(1e10)
    if speed is None:
        speed = shot.bar.wave_speed
    distance = shot.to_gauge
    radius = None
    if exact:
        distance = 2 * EXACT_MODE_DISTANCE * shot.bar.radius
        radius = shot.bar.radius
    start, stop = shot.windows.incident
    until = distance / speed + 0.8 * (stop - start)  # the pulse begins in the window
    system = row_of(shot, speed, contact, theory, until)
    measured = ri.Measured(
        record(shot)[0].window(start, stop),
        (1, distance),
        distance=shot.to_gauge - distance,
        radius=radius,
    )
    cells = None
    if theory:
        length = float(system.bodies[1].length)
        cells = math.ceil(CELLS_PER_RADIUS * length / shot.bar.radius)
    return ri.fit(system, measured, unknown, until, starts=starts, cells=cells)


class FittedModel(NamedTuple):
    """The incident pulse of a shot by a model."""

    metal: str
    model: str
    fit: ri.Fit
    seconds: float  # processor time of the fit
    bound: float  # bound of the misfit, %

    @property
    def name(self) -> str:
        """Bars and model."""
        return f"{self.metal}, {self.model}"

    @property
    def misfit(self) -> float:
        """Misfit of the pulse, %."""
        return 100 * self.fit.misfits[0]

    @property
    def striker_length(self) -> float:
        """Length of the striker that the fit finds, mm."""
        return 1e3 * self.fit.values[LENGTH]


def fitted_models() -> Iterator[FittedModel]:
    """Fit each incident pulse by each model.

    Each fit is yielded with its metal, model, processor time and bound.
    """
    for metal, shot in SHOTS.items():
        for model, bound in zip(MODELS, BOUNDS[metal], strict=True):
            start = time.process_time()
            fit = fitted(shot, **MODELS[model])
            seconds = time.process_time() - start
            yield FittedModel(metal, model, fit, seconds, bound)


def at_specimen(signal: ri.Signal, window: Span, distance: float, shot: Shot) -> Any:
    """The pulse in a window of a record, carried by a distance, m."""
    pulse = signal.window(*window).extended(1e-4, 1e-4)
    return pulse.propagated(distance, shot.bar)


def equilibrium(shot: Shot) -> float:
    """Misfit of the forces at the specimen, % of the plateau of the incident pulse.

    It is a root mean square over the time of the plateau. The force of incident and
    reflected pulse must be that of the transmitted pulse. The misfit is the least over
    delays and gains of the reflected and the transmitted pulse, within their freedom.
    """
    first, last = record(shot)
    to_first, to_last = shot.to_specimen
    windows = shot.windows
    incident = at_specimen(first, windows.incident, to_first, shot)
    # The other two ran from the specimen to the gauge: they are carried back.
    reflected = at_specimen(first, windows.reflected, -to_first, shot)
    transmitted = at_specimen(last, windows.transmitted, -to_last, shot)
    level = first.window(*windows.incident).pulse().plateau
    # from 20 us before the incident pulse is above half its height to 20 us after that
    high = incident.times[incident.values / level > 0.5]
    start = high[0] - 2e-5
    end = high[-1] + 2e-5
    t = np.arange(start, end, incident.dt)

    def imbalance(x: np.ndarray) -> np.ndarray:
        """Difference of the forces over the plateau; x: delay, us, and gain of each."""
        delay_1, gain_1, delay_2, gain_2 = x
        by_reflected = gain_1 * reflected.shifted(1e-6 * delay_1).at(t)
        by_transmitted = gain_2 * transmitted.shifted(1e-6 * delay_2).at(t)
        return (incident.at(t) + by_reflected - by_transmitted) / level

    # Bounds of delay and gain, twice: of the reflected and the transmitted pulse
    least = [-TIME_FREEDOM, 1 - GAIN_FREEDOM] * 2
    most = [TIME_FREEDOM, 1 + GAIN_FREEDOM] * 2
    best = math.inf
    for delay_1 in (-3.0, 0.0, 3.0):
        for delay_2 in (-3.0, 0.0, 3.0):
            first_guess = [delay_1, 1.0, delay_2, 1.0]
            search = least_squares(imbalance, first_guess, bounds=(least, most))
            best = min(best, search.cost)  # half of the sum of squares
    return 100 * math.sqrt(2 * best / len(t))


def run() -> Rows:
    """Misfits of models in per cent, lengths and a wave speed, forces at specimens."""
    for fitted_model in fitted_models():
        source = f"measured, {SHOTS[fitted_model.metal].source}"
        case = Case(fitted_model.name, source)
        misfit = fitted_model.misfit
        yield case.row(MISFIT_OF_PULSE, 0.0, misfit, fitted_model.bound)
        if fitted_model.name == f"titanium, {HERTZ_AND_EXACT_MODE}":
            length = fitted_model.striker_length
            yield case.row("length of the striker, mm", 127.0, length, 4.0)
    yield from titanium_by_moduli()
    yield from titanium_with_free_speed()
    yield from forces("titanium bars, dispersion", TITANIUM, bound=2.7)
    yield from forces("steel bars, dispersion", STEEL, bound=2.1)


def titanium_by_moduli() -> Rows:
    """Misfit and striker's length for titanium at the wave speed of E and rho.

    The model is the one with Hertz ends and the exact mode.
    """
    fit = fitted(TITANIUM, STIFFNESS_BOUNDS, speed=TITANIUM_SPEED_FROM_MODULI)
    misfit = 100 * fit.misfits[0]
    length = 1e3 * fit.values[LENGTH]
    name = f"titanium, {HERTZ_AND_EXACT_MODE}, 4975 m/s"
    case = Case(name, "measured, LANL HopPyBar")
    yield case.row(MISFIT_OF_PULSE, 0.0, misfit, 2.0)
    yield case.row("length of the striker, mm", 127.0, length, 2.0)


def titanium_with_free_speed() -> Rows:
    """Misfit and wave speed of titanium, if the wave speed is fitted, too.

    The wave speed is compared with the calibrated one.
    """
    vary = {SPEED: (4200.0, 5400.0)}
    fit = fitted(TITANIUM, STIFFNESS_BOUNDS | vary, starts=3)
    misfit = 100 * fit.misfits[0]
    calibrated = TITANIUM.bar.wave_speed
    name = f"titanium, {HERTZ_AND_EXACT_MODE}, wave speed free"
    case = Case(name, "measured, LANL HopPyBar")
    yield case.row(MISFIT_OF_PULSE, 0.0, misfit, 2.0)
    yield case.row("wave speed, m/s", calibrated, fit.values[SPEED], 200.0)


def forces(name: str, shot: Shot, bound: float) -> Rows:
    """Misfit of the equilibrium of a specimen, %."""
    case = Case(name, f"measured, {shot.source}")
    yield case.row(MISFIT_OF_FORCES, 0.0, equilibrium(shot), bound)


def main() -> None:
    """Print misfits and lengths of the striker, with the time of each fit."""
    fitted(TITANIUM, STIFFNESS_BOUNDS)  # compiles, so that no time below contains that
    print("misfit, % | CPU time, s | striker, mm | bars, model")
    for fitted_model in fitted_models():
        misfit = f"{fitted_model.misfit:9.2f}"
        seconds = f"{fitted_model.seconds:11.2f}"
        length = f"{fitted_model.striker_length:11.2f}"
        print(f"{misfit} | {seconds} | {length} | {fitted_model.name}")


if __name__ == "__main__":
    main()
