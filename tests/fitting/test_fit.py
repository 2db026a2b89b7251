"""Fits find what made a record, say how well, and say what they cannot find."""

import csv
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from exhaustive import few_of
from validation_cases import validation_module

import rodimpact as ri
from rodimpact.fitting.notes import noise_before_pulse, notes_on_numbers
from rodimpact.fitting.objective import Objective
from rodimpact.fitting.parameters import (
    record_parameters,
    system_parameters,
    with_values,
)
from rodimpact.fitting.uncertainty import covariance
from rodimpact.methods.registry import Options
from rodimpact.units import format_si

STEEL = ri.materials.steel
UNTIL = 1.5e-4
PATHS = "bodies.0.length", "bodies.0.velocity"


def rods(length=0.2, velocity=10.0, material=STEEL, **row):
    pair = [
        ri.Rod(x, area=1e-4, material=material, velocity=v)
        for x, v in ((length, velocity), (0.6, 0.0))
    ]
    return ri.System(pair, **row)


def record(system, noise=0.0, interval=5e-7):
    signal = ri.solve(system, until=UNTIL).gauge(1, 0.2).signal(interval, name="gauge")
    random = np.random.default_rng(7).standard_normal(len(signal))
    return signal.replace(values=signal.values + noise * random)


def measured(signal, **how):
    return ri.Measured(signal, (1, 0.2), **{"shift": 0.0, "gain": 1.0, **how})


def test_a_fit_finds_what_made_a_record():
    strain = 10.0 / (2 * STEEL.wave_speed)
    noisy = measured(record(rods(), 0.02 * strain))
    found = ri.fit(
        rods(0.24, 5.0), noisy, {PATHS[0]: (0.15, 0.25), PATHS[1]: (1.0, 20.0)}, UNTIL
    )
    assert not found.notes
    for path, wanted in zip(PATHS, (0.2, 10.0), strict=True):
        assert found.values[path] == pytest.approx(wanted, rel=5e-3)
        assert abs(found.values[path] - wanted) < 4 * found.standard_errors[path]
    during = int(0.4 / STEEL.wave_speed / 5e-7)  # samples of the pulse
    assert found.standard_errors[PATHS[1]] == pytest.approx(
        10 * 0.02 / during**0.5, rel=0.7
    )
    assert found.misfits[0] == pytest.approx(0.02, rel=0.1)
    assert found.system.bodies[0].length == found.values[PATHS[0]]
    off = found.predicted[0].values - noisy.signal.values
    assert math.sqrt(np.mean(off**2)) == pytest.approx(
        found.misfits[0] * noisy.size, rel=1e-9
    )
    assert len(found.descents) == 3
    for end in found.descents:
        assert end.values[PATHS[0]] == pytest.approx(found.values[PATHS[0]], rel=1e-6)


def test_several_records_have_shifts_of_their_own_and_one_system():
    system = rods()
    solution = ri.solve(system, until=UNTIL)
    places = (1, 0.2), (1, 0.4)
    records = [
        ri.Measured(solution.gauge(*place).signal(5e-7).shifted(late), place, gain=1.0)
        for place, late in zip(places, (1e-6, 2e-6), strict=True)
    ]
    alone = ri.fit(system, records, {PATHS[0]: (0.1, 0.4)}, UNTIL)
    with ThreadPoolExecutor(2) as pool:
        together = ri.fit(system, records, {PATHS[0]: (0.1, 0.4)}, UNTIL, executor=pool)
    assert alone.values == together.values
    assert alone.values["records.0.shift"] == pytest.approx(1e-6, abs=1e-9)
    assert alone.values["records.1.shift"] == pytest.approx(2e-6, abs=1e-9)


def test_records_share_what_is_tied():
    """One pulse passes two gauges of one amplifier, whose clock and blur are not known."""
    solution = ri.solve(rods(), until=UNTIL)
    random, places = np.random.default_rng(3), ((1, 0.2), (1, 0.4))
    records, squares = (
        [],
        {"gain": 0.0, "shift": 0.0},
    )  # of what a record changes with each
    for place in places:
        strain = (
            solution.gauge(*place).signal(5e-7).low_pass(0.1325 / 3e-6).shifted(4e-6)
            * 1.5
        )
        noise = 2e-5 * random.standard_normal(len(strain))
        squares["gain"] += float(np.sum((strain.values / 1.5) ** 2))
        squares["shift"] += float(np.sum(np.gradient(strain.values, 5e-7) ** 2))
        records.append(ri.Measured(strain.replace(values=strain.values + noise), place))
    tied = {
        PATHS[0]: (0.1, 0.4),
        "records.*.gain": None,
        "records.*.shift": (-1e-5, 1e-5),
        "records.[01].blur": (0.0, 1e-5),
    }
    found = ri.fit(rods(), records, tied, UNTIL)
    wanted = {
        PATHS[0]: 0.2,
        "records.*.gain": 1.5,
        "records.*.shift": 4e-6,
        "records.[01].blur": 3e-6,
    }
    assert found.values.keys() == wanted.keys()
    for name, value in wanted.items():
        assert found.values[name] == pytest.approx(value, rel=2e-2), name
        assert abs(found.values[name] - value) < 4 * found.standard_errors[name], name
    alone = ri.fit(
        rods(), records, {PATHS[0]: (0.1, 0.4), "records.*.blur": (0.0, 1e-5)}, UNTIL
    )
    assert {
        "records.0.shift",
        "records.1.shift",
        "records.1.gain",
    } < alone.values.keys()
    assert (
        found.standard_errors["records.*.gain"]
        < alone.standard_errors["records.0.gain"]
    )
    for (
        name,
        total,
    ) in squares.items():  # the others are known nearly as well without this one
        assert (
            1 <= found.standard_errors[f"records.*.{name}"] / (2e-5 / total**0.5) < 1.5
        ), name


def objective_of(records, vary):
    """Parameters of the system, and the objective of a fit."""
    parameters = system_parameters(rods(), vary)
    objective = Objective(
        system=rods(),
        measured=records,
        parameters=parameters,
        record_parameters=record_parameters(rods(), records, {}, UNTIL),
        options=Options(UNTIL, "fronts"),
        interval=5e-7,
        executor=None,
    )
    return parameters, objective


def derivatives_of(objective, point):
    """Central differences of the residuals by every number of a point."""
    columns = []
    for step in np.diag([1e-5, 1e-5, 1e-10, 1e-5, 1e-9]):
        change = objective.residuals(point + step) - objective.residuals(point - step)
        columns.append(change / (2 * step.sum()))
    return np.stack(columns, axis=1)


def coloured(random, n, steps):
    """Noise of variance 1 whose correlation falls to 1/e within so many steps."""
    a = math.exp(-1 / steps) if steps else 0.0
    noise = [random.standard_normal()]
    for white in math.sqrt(1 - a * a) * random.standard_normal(n - 1):
        noise.append(a * noise[-1] + white)
    return np.array(noise)


@pytest.mark.parametrize("correlation", [0.0, 5e-6])
def test_standard_errors_are_the_scatter_of_fits(correlation):
    """Of 200 records with noise: length, velocity, shift and blur move as far as their errors say.

    Fits are linear in the noise where this is small.
    """
    m = ri.Measured(record(rods()), (1, 0.2), gain=1.0, blur=(0.0, 1e-5))
    _, objective = objective_of([m], {PATHS[0]: (0.1, 0.4), PATHS[1]: (1.0, 20.0)})
    point = np.array([1 / 3, 9 / 19, 0.0, 1.0, 2e-6])
    J = derivatives_of(objective, point)[:, objective.is_free]
    J *= [1.0, 1.0, UNTIL, 1e-5]
    random, solve = np.random.default_rng(2), np.linalg.pinv(J)
    moved, errors = [], []
    for _ in range(200):
        noise = 0.02 * coloured(random, len(J), correlation / 5e-7)
        moved.append(solve @ noise)
        left = J @ moved[-1] - noise
        errors.append(np.sqrt(np.diag(covariance(J, left, [len(J)]))))
    ratio = np.mean(errors, axis=0) / np.std(moved, axis=0)
    assert (ratio > 0.8).all()
    assert (ratio < 1.3).all()


@pytest.mark.exhaustive
def test_all_searches_for_a_measured_pulse_end_at_one_place():
    pulses = validation_module("measured_pulses")
    vary = {**pulses.ENDS, pulses.SPEED: (4200.0, 5400.0)}
    found = pulses.fitted(pulses.TITANIUM, vary, starts=3)
    for end in found.descents:
        for name, value in end.values.items():
            assert abs(value - found.values[name]) < 0.01 * found.standard_errors[name]
    assert found.misfits[0] < 0.02


@pytest.mark.exhaustive
def test_standard_errors_are_the_scatter_of_fits_of_noisy_pulses():
    near, until, step = (
        (1, 0.02),
        2.5e-4,
        4e-7,
    )  # where the exact mode begins; between samples
    correlation = 5e-6  # s; that of white noise is tested above
    pulses = validation_module("measured_pulses")
    shot, random = pulses.TITANIUM, np.random.default_rng(4)
    system = pulses.row_of(shot, shot.bar.wave_speed, ri.Hertz(6e10), None, until)
    carried = {"distance": 0.361, "radius": shot.bar.radius}
    strain = (
        ri.solve(system, until=until).gauge(*near).signal(step / 4).extended(1e-4, 1e-4)
    )
    pulse = strain.propagated(carried["distance"], shot.bar).low_pass(0.1325 / 2e-6)
    clean = pulse.resampled(times=np.arange(5e-5, 2e-4, step))
    values, errors = [], []
    for _ in range(50):
        noise = (
            0.02
            * np.abs(clean.values).max()
            * coloured(random, len(clean), correlation / step)
        )
        measured = ri.Measured(
            clean.replace(values=clean.values + noise), near, **carried
        )
        vary = {
            pulses.LENGTH: shot.length,
            **pulses.ENDS,
            "records.0.blur": (0.0, 1e-5),
        }
        found = ri.fit(system, measured, vary, until, starts=1)
        values.append(list(found.values.values()))
        errors.append(list(found.standard_errors.values()))
    ratio = np.mean(errors, axis=0) / np.std(values, axis=0)
    assert (ratio > 0.8).all(), ratio
    assert (ratio < 1.3).all(), ratio


@pytest.mark.parametrize("lasting", [1, 10])
def test_standard_errors_of_a_mean(lasting):
    """Of n samples, each `lasting` times in a row, it is sigma/sqrt(n/lasting)."""
    random, n = np.random.default_rng(1), 1200
    variances = []
    for _ in range(150):
        noise = np.repeat(random.standard_normal(n // lasting), lasting)
        J = np.ones((n, 1))
        variances.append(covariance(J, noise - noise.mean(), [n // 2, n // 2])[0, 0])
    assert 0.8 < np.mean(variances) * n / lasting < 1.2


def test_another_law_tells_by_how_much_numbers_move():
    noisy = measured(record(rods(), 1e-5))
    vary = {PATHS[0]: (0.1, 0.4)}
    rigid = ri.fit(rods(), noisy, vary, UNTIL)
    soft = ri.fit(rods(contacts=[ri.Spring(3e8)]), noisy, vary, UNTIL)
    both = rigid.against(soft)
    moved = soft.values[PATHS[0]] - rigid.values[PATHS[0]]
    assert abs(moved) > 5 * rigid.standard_errors[PATHS[0]]
    said = (
        f"With the other law or theory {PATHS[0]} changes by {format_si(moved, 'm', 3)}"
    )
    assert both.notes[-2].startswith(said)
    assert both.notes[:-2] == rigid.notes
    assert both.fitted == rigid.fitted
    assert said in str(both)
    with pytest.raises(ri.InvalidModel, match="other: has no number in common"):
        rigid.against(ri.fit(rods(), noisy, {PATHS[1]: (1.0, 20.0)}, UNTIL))


@pytest.mark.parametrize("seed", few_of(range(200), range(2)))
def test_a_shift_is_found_wherever_a_window_of_a_record_lies(seed):
    """Random steps of strain run along a bar and back; the bar's length is varied as well."""
    random = np.random.default_rng(seed)
    steps = ri.Steps(
        random.uniform(-1e-3, 1e-3, 30).tolist(),
        at=np.cumsum(random.uniform(5e-6, 2e-5, 29)).tolist(),
    )
    driven = ri.System(
        [ri.Rod(0.5, area=1e-4, material=STEEL)], ends=(ri.Incoming(steps), ri.Free())
    )
    whole = ri.solve(driven, until=4e-4).gauge(0, 0.2).signal(5e-7)
    start, late = random.uniform(5e-5, 3.2e-4), random.uniform(-4e-4, 4e-4)
    window = whole.window(start, start + 7e-5).shifted(late) * 2.5
    vary = {"bodies.0.length": (0.45, 0.55)}
    found = ri.fit(driven, ri.Measured(window, (0, 0.2)), vary, 4e-4, starts=1)
    assert found.values["records.0.shift"] == pytest.approx(late, abs=1e-8)
    assert found.values["records.0.gain"] == pytest.approx(2.5, rel=1e-4)
    assert "at its bound" not in " ".join(found.notes)
    short = ri.Measured(window, (0, 0.2), shift=(late - 1e-4, late - 1e-6))
    told = ri.fit(driven, short, vary, 4e-4, starts=1)
    assert told.values["records.0.shift"] < late - 1e-6 / 2
    assert told.misfits[0] > 0.05 or "records.0.shift is at its bound" in " ".join(
        told.notes
    )


def test_what_is_not_determined_is_told():
    """Amplitude is velocity times scale, and the density of a lone material alters neither."""
    noisy = record(rods(), 1e-5)
    both = ri.fit(
        rods(), measured(noisy, gain=(0.1, 10.0)), {PATHS[1]: (1.0, 100.0)}, UNTIL
    )
    assert any(
        "not determined" in s or "hardly distinguishable" in s for s in both.notes
    )
    bounded = ri.fit(rods(), measured(noisy), {PATHS[0]: (0.1, 0.15)}, UNTIL)
    assert any(
        f"{PATHS[0]} is at its bound, 150 mm" in sentence for sentence in bounded.notes
    )
    silent = ri.fit(rods(), measured(noisy), {"bodies.1.length": (0.58, 0.6)}, 1e-4)
    assert any(
        "bodies.1.length is not determined" in sentence for sentence in silent.notes
    )


def test_doubts_about_where_searches_end():
    numbers = [ri.Fitted(name, "m", 1.0, 0.01, 0.0, 2.0) for name in "ab"]
    ends = [
        ri.Descent(rms, {"a": a, "b": 1.0}, True)
        for rms, a in ((0.02, 1.0), (0.02, 1.5))
    ]
    said = list(notes_on_numbers(numbers, np.diag([1e-4, 1e-4]), ends))
    assert said == [
        "Searches with the same misfit ended at different values of a: 1 m to 1.5 m."
    ]
    ends[1] = ends[1]._replace(misfit=0.04)
    (said,) = notes_on_numbers(numbers, np.diag([1e-4, 1e-4]), ends)
    assert "1 of 2 searches ended at larger misfits, 4 % and more" in said
    close = np.array([[1e-4, 0.99e-4], [0.99e-4, 1e-4]])
    (said,) = notes_on_numbers(numbers, close, ends[:1])
    assert (
        "a and b are hardly distinguishable: the correlation of their errors is 0.990"
        in said
    )


def test_a_bound_is_as_near_as_the_scale_of_its_range_says():
    """3e13 lies in the middle of 1e7 to 1e19: the range is a ratio."""
    end = ri.Descent(0.02, {"k": 3e13, "x": 0.1005}, True)
    numbers = [
        ri.Fitted("k", "N/m", 3e13, 1e12, 1e7, 1e19),
        ri.Fitted("x", "m", 0.1005, 1e-5, 0.1, 0.9),
    ]
    (said,) = notes_on_numbers(numbers, np.diag([1e-4, 1e-4]), [end])
    assert said.startswith("x is at its bound, 100 mm")
    low, high = (numbers[0]._replace(value=v) for v in (1.01e7, 9.9e18))
    for number in (low, high):
        (said,) = notes_on_numbers(
            [number], np.array([[1e-4]]), [end._replace(values={"k": 1.0})]
        )
        assert said.startswith("k is at its bound")


def test_a_misfit_far_above_the_noise_before_the_pulse_is_told():
    """Flat ends do not make the record of rounded ends."""
    true = rods(contacts=[ri.Hertz(1e10)])
    strain = record(true)
    noisy = measured(record(true, 0.002 * float(np.abs(strain.values).max())))
    vary = {PATHS[0]: (0.1, 0.4)}
    flat = ri.fit(rods(), noisy, vary, UNTIL)
    assert flat.misfits[0] > 0.03
    (said,) = (s for s in flat.notes if "noise before the pulse" in s)
    assert said.startswith("gauge: the misfit, ")
    noise = noise_before_pulse(noisy, flat.predicted[0])
    assert noise == pytest.approx(0.002, rel=0.3)
    assert f"{100 * noise:.2g} %" in said
    right = ri.fit(true, noisy, vary, UNTIL)
    assert not any("noise before the pulse" in s for s in right.notes)


@pytest.mark.parametrize("seed", few_of(range(30), [12]))
def test_a_richer_model_ends_no_worse_than_the_poorer_one(seed):
    """With one start, some fits with a blur ended worse than those without one."""
    random = np.random.default_rng(seed)
    rounded = ri.Hertz(1.0)
    true = rods(
        float(random.uniform(0.1, 0.3)),
        contacts=[rounded.replace(stiffness=float(10 ** random.uniform(9, 12)))],
    )
    until = float(random.uniform(1.2e-4, 3.5e-4))
    strain = ri.solve(true, until=until).gauge(1, 0.2).signal(1e-6)
    start = float(random.uniform(0, 0.3)) * until
    strain = strain.window(start, start + float(random.uniform(0.3, 0.65)) * until)
    noise = 0.01 * float(np.abs(strain.values).max())
    noisy = strain.replace(
        values=strain.values + noise * random.standard_normal(len(strain))
    )
    guess = rods(
        float(random.uniform(0.1, 0.3)),
        contacts=[rounded.replace(stiffness=float(10 ** random.uniform(9, 12)))],
    )
    numbers = {PATHS[0]: (0.08, 0.35), "contacts.0.stiffness": (1e7, 1e13)}
    blurred = {**numbers, "records.0.blur": (0.0, 1e-5)}
    poorer, richer = (
        ri.fit(guess, ri.Measured(noisy, (1, 0.2)), vary, until, starts=1)
        for vary in (numbers, blurred)
    )
    assert richer.misfits[0] <= poorer.misfits[0] * (1 + 1e-6)


def test_paths_are_those_of_case_files():
    titanium = ri.Material("titanium", youngs_modulus=100e9, density=4400)
    system = rods(material=titanium, contacts=[ri.Hertz(1e10)], gaps=[1e-3])
    vary = {
        "materials.titanium.wave_speed": (4000, 6000),
        "materials.titanium.density": (4e3, 5e3),
        "contacts.0.stiffness": (1e8, 1e12),
        "contacts.0.gap": (0.0, 1e-2),
    }
    parameters = system_parameters(system, vary)
    assert [p.unit for p in parameters] == ["m/s", "kg/m^3", "N/m^1.5", "m"]
    assert parameters[0].initial == titanium.wave_speed
    assert parameters[2].value(0.5) == pytest.approx(1e10)
    other = ri.Material("titanium", youngs_modulus=4500 * 5000.0**2, density=4500)
    wanted = rods(material=other, contacts=[ri.Hertz(1e11)], gaps=[2e-3])
    assert with_values(system, parameters, [5000.0, 4500.0, 1e11, 2e-3]) == wanted
    steps = rods(velocity=ri.Steps([1.0, 2.0], at=[0.1]))
    moved = with_values(
        steps, system_parameters(steps, {"bodies.0.velocity.values.1": (0, 9)}), [3.0]
    )
    assert moved == rods(velocity=ri.Steps([1.0, 3.0], at=[0.1]))
    for p in parameters:
        assert p.value(p.share(p.low * 0.7 + p.high * 0.3)) == pytest.approx(
            p.low * 0.7 + p.high * 0.3
        )


def test_a_result_as_table_and_file(tmp_path):
    found = ri.fit(
        rods(), measured(record(rods(), 1e-5)), {PATHS[0]: (0.1, 0.4)}, UNTIL
    )
    assert "do not include model error" in str(found)
    assert found._repr_html_().count("<img") == 1
    drawn = ri.plot.fit(found)
    assert drawn.misfit.rms == pytest.approx(found.misfits[0], rel=1e-9)
    assert (drawn.misfit.shift, drawn.misfit.scale) == (0, 1)
    with pytest.raises(
        ValueError, match="record: must be a whole number from 0 to 0, got 1"
    ):
        ri.plot.fit(found, record=1)
    found.to_csv(tmp_path / "fit.csv")
    (row,) = csv.DictReader((tmp_path / "fit.csv").read_text().splitlines())
    assert float(row["value"]) == found.values[PATHS[0]]
    assert float(row["standard error"]) == found.standard_errors[PATHS[0]] > 0
    assert (row["number"], row["unit"], row["low"], row["high"]) == (
        PATHS[0],
        "m",
        "0.1",
        "0.4",
    )
    with pytest.raises(FileExistsError):
        found.to_csv(tmp_path / "fit.csv")


FLAT = ri.Signal([0.0, 1.0, 1.0, 0.0], dt=1e-5, name="flat")
OK, VOLTS = (ri.Measured(signal, (1, 0.2)) for signal in (FLAT, FLAT.replace(unit="V")))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"vary": {}}, "vary: must name numbers with their bounds"),
        (
            {"vary": {"bodies.0.lenght": (0.1, 0.2)}},
            "perhaps 'bodies.0.length' is meant",
        ),
        (
            {"vary": {PATHS[0]: (0.2, 0.1)}},
            r"vary.bodies.0.length: must be \(low, high\)",
        ),
        ({"vary": {PATHS[0]: 0.1}}, r"vary.bodies.0.length: must be \(low, high\)"),
        (
            {"vary": {PATHS[0]: ("a", 1)}},
            "vary.bodies.0.length: must be a number of metres",
        ),
        (
            {
                "vary": {
                    "materials.steel.wave_speed": (4e3, 6e3),
                    "bodies.1.material.youngs_modulus": (1e11, 3e11),
                }
            },
            "already varied as materials",
        ),
        (
            {"vary": {"bodies.0.area": (-1e-4, -1e-5)}},
            "the bounds allow an invalid system",
        ),
        (
            {"vary": {"materials.steel.wave_speed": (-5e3, -4e3)}},
            "allow an invalid system",
        ),
        (
            {"vary": {"bodies.1.length": (0.05, 0.6)}},
            "the bounds put a gauge outside its rod",
        ),
        (
            {"vary": {"records.0.shfit": (0, 1)}},
            "vary.records.0.shfit: is not one number of records",
        ),
        (
            {"vary": {"records.*.*": (0, 1)}},
            "is not one number of records, in one unit; give a name",
        ),
        (
            {"vary": {"records.0.blur": None}},
            "vary.records.0.blur: must be a number of seconds",
        ),
        (
            {"vary": {"records.*.gain": None, "records.0.gain": None}},
            "names records.0.gain, which",
        ),
        (
            {"vary": {"records.*.gain": None}, "measured": [OK, VOLTS]},
            "is not one number of records",
        ),
        ({"measured": FLAT}, "measured: must be a Measured"),
        ({"measured": []}, "measured: must be a Measured"),
        ({"measured": ri.Measured(FLAT, (1, 2.0))}, "gauges.0.x: must lie in body 1"),
        ({"measured": ri.Measured(FLAT, (3, 0.2))}, "gauges.0.body: must be a rod"),
        ({"until": None}, "until: is missing"),
        ({"until": -1.0}, "until: must be"),
        ({"starts": 0}, "starts: must be a positive whole number"),
        ({"interval": 0.0}, "interval: must be a finite positive number of seconds"),
        ({"system": rods(velocity=np.array([1.0, 2.0]))}, "system: must be one system"),
        ({"system": 3}, "system: must be a System"),
    ],
)
def test_mistakes_are_named(change, said):
    how = {
        "system": rods(),
        "measured": OK,
        "vary": {PATHS[0]: (0.1, 0.2)},
        "until": UNTIL,
    }
    with pytest.raises(ri.InvalidModel, match=said):
        ri.fit(**{**how, **change})


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"signal": [1, 2]}, "signal: must be a Signal"),
        ({"gauge": 1}, r"gauge: must be \(body, x\)"),
        ({"distance": math.inf}, "distance.*finite"),
        ({"shift": (1.0, 0.0)}, r"shift: must be a number, or \(low, high\)"),
        ({"gain": "x"}, "gain: must be a number"),
        ({"blur": (-1e-6, 1e-6)}, "blur: must be 0 s or more"),
        ({"level": -1.0}, "level.*positive"),
        ({"seen": 3}, "seen: must be a function"),
        ({"signal": 0 * FLAT}, "there is no pulse"),
    ],
)
def test_mistakes_of_records_are_named(change, said):
    with pytest.raises(ValueError, match=said):
        ri.Measured(**{"signal": FLAT, "gauge": (1, 0.2), **change})
