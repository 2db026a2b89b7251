"""Families of collisions: the same numbers as one at a time, whoever runs them."""

import multiprocessing
import warnings
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from exhaustive import few_of
from mistakes import problems
from networks import random_network
from systems import MATERIALS, with_ends

import rodimpact as ri
from rodimpact import theory
from rodimpact.methods import kernels
from rodimpact.methods.run import ALSO
from rodimpact.running.jobs import SerialExecutor

STEEL = ri.materials.steel


def pair(lengths, areas, velocity=1.0):
    return ri.System(
        [
            ri.Rod(lengths, area=1e-4, material=STEEL, velocity=velocity),
            ri.Rod(1.0, area=areas, material=STEEL),
        ]
    )


def small_map(shape=(7, 5)):
    return pair(
        np.linspace(0.1, 1.3, shape[0])[:, None], np.geomspace(2e-5, 8e-4, shape[1])
    )


def same(a, b):
    assert a.columns.keys() == b.columns.keys()
    return all(a.columns[k].tobytes() == b.columns[k].tobytes() for k in a.columns)


def assert_equal_to_one_at_a_time(result, **options):
    """Every column bit for bit, the energy left in vibration to round-off.

    One that presses for ever has no total of its own; a rod bonded or joined to a wall swings on
    for ever.
    """
    for index in np.ndindex(result.shape):
        outcome = ri.solve(result.system[index], **options).outcome
        found = {k: v[index] for k, v in result.columns.items()}
        for i, velocity in enumerate(outcome.velocities_after):
            assert found[f"velocity_after.{i}"] == velocity
        for k, tally in enumerate(outcome.contacts):
            for name in ("impulse", "peak_force", "duration", "episodes"):
                assert "goes on pressing" in outcome.status or np.array_equal(
                    found[f"{name}.{k}"], getattr(tally, name), equal_nan=True
                )
        assert found["final"] == outcome.final
        neighbours = zip(result.system.bodies, result.system.bodies[1:], strict=False)
        swinging = any(
            not law.opens and any(isinstance(body, ri.Wall) for body in pair)
            for law, pair in zip(result.system.contacts, neighbours, strict=True)
        )
        if not swinging:
            vibration = sum(outcome.vibration_after)
            least = 1e-14 * (outcome.kinetic_before + sum(outcome.vibration_before))
            assert found["vibration"] == pytest.approx(vibration, rel=1e-12, abs=least)
        if outcome.why_no_restitution():
            assert np.isnan(found["restitution"])
        else:
            assert found["restitution"] == outcome.restitution


# Numbers -----------------------------------------------------------------------------------------


def test_a_map_equals_the_closed_form():
    system = small_map(shape := (60, 50))
    result = ri.sweep(system)
    left, right = (body.segments[0] for body in system.bodies)
    exact = theory.saint_venant(
        left.impedance, left.transit_time, right.impedance, right.transit_time, 1.0
    )
    assert result.shape == shape
    assert np.abs(result.restitution - exact.restitution).max() < 1e-11
    assert result.final.all()
    assert set(result.status.ravel()) == {"final"}
    np.testing.assert_allclose(result.impulse, exact.impulse, rtol=1e-11)


def varied(seed, driven):
    """A random row of which some numbers become arrays; places and times of jumps, too."""
    rng = np.random.default_rng(seed)
    described = with_ends(seed, driven).to_dict()

    def vary(thing, name):
        if isinstance(thing.get(name), float):
            thing[name] = thing[name] * rng.uniform(-1, 1, 6)
        elif name in thing:
            profile = thing[name]
            shares = rng.uniform(0.3, 1, 6)
            profile["values"] = [profile["values"][0] * shares, *profile["values"][1:]]
            profile["at"] = [at * shares for at in profile["at"]]

    for end in described.get("ends", {}).values():
        vary(end, "value")
    for body in described["bodies"]:
        vary(body, "velocity")
        vary(body, "strain")
        for piece in body.get("segments", [body] if body["kind"] == "rod" else []):
            if rng.random() < 0.5:
                piece["area"] = piece["area"] * rng.uniform(0.5, 2, (2, 1))
    for contact in described["contacts"]:
        if contact["law"] == "rigid":
            contact["gap"] = contact["gap"] * rng.uniform(0, 2, 6).round()
    return ri.System.from_dict(described)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"until": 1e-3},
        {"method": "finite-difference", "cells": 20, "until": 1e-3},
    ],
)
def test_bonds_and_joints_have_totals(options):
    """Impulse and largest force of a contact that cannot open, as `solve` gives them."""
    law = ri.Joint(stiffness=1e9) if "cells" in options else ri.Bonded()
    rods = [
        ri.Rod(np.array([0.3, 0.5]), area=1e-4, material=STEEL, velocity=1.0),
        ri.Rod(1.0, area=1e-4, material=STEEL),
        ri.Rod(0.7, area=2e-4, material=STEEL),
    ]
    result = ri.sweep(ri.System(rods, contacts=[ri.Rigid(), law]), **options)
    assert (result.contacts[1].peak_force > 0).all()
    assert_equal_to_one_at_a_time(result, **options)


def even_network(seed):
    """Two members of a random row: masses, laws, ends, gravity; all at t = 0 and outside even."""
    system = random_network(seed, bodies=3, driven=seed % 2 == 1)
    shares = np.array([1.0, 0.9])

    def even(profile):
        return float(np.mean(getattr(profile, "values", profile)))

    bodies = [
        ri.Rod(
            segments=[
                ri.Segment(s.length, s.area * shares, s.material) for s in body.segments
            ],
            velocity=even(body.velocity),
            strain=even(body.strain) * shares,
        )
        if isinstance(body, ri.Rod)
        else body
        for body in system.bodies
    ]
    ends = [
        type(end)(even(end.value)) if isinstance(end, ri.Pushed | ri.Moved) else end
        for end in system.ends
    ]
    gaps = [gap * shares for gap in system.gaps]
    return ri.System(bodies, gaps, system.contacts, gravity=system.gravity, ends=ends)


@pytest.mark.parametrize("seed", few_of(range(0, 300, 15), range(75, 300, 75)))
def test_members_of_random_rows_of_characteristics_equal_one_at_a_time(seed):
    system = even_network(seed)
    options = {"method": "characteristics", "until": 1.5, "rtol": 1e-2}
    with kernels.forced(True):
        result = ri.sweep(system, **options)
        assert_equal_to_one_at_a_time(result, **options)
    options = {"method": "characteristics", "until": 0.5}
    with kernels.forced(True):
        result = ri.sweep(system, **options)
    with kernels.forced(False):
        assert same(ri.sweep(system, workers=1, **options), result)


@pytest.mark.parametrize("most", [5, 8, 14])
def test_members_of_any_chunk_are_those_of_the_family(monkeypatch, most):
    monkeypatch.setattr("rodimpact.methods.fronts.families.MAX_MEMBERS_PER_CALL", most)
    monkeypatch.setattr("rodimpact.running.chunks.JOBS_A_WORKER", 1)
    assert_equal_to_one_at_a_time(ri.sweep(small_map(), workers=1))


@pytest.mark.parametrize("method", ["fronts", "characteristics"])
def test_columns_are_the_same_bits_whatever_the_number_of_workers(method):
    """Energies of vibration too, whose sums depend on how members are run."""
    system = small_map((6, 2))
    first = ri.sweep(system, method, workers=1)
    for workers in (2, 3, 12):
        assert same(ri.sweep(system, method, workers=workers), first)
    by_member = [ri.sweep(system[i], method, workers=1) for i in range(6)]
    for name, column in first.columns.items():
        assert np.array_equal(
            column, [part.columns[name] for part in by_member], equal_nan=True
        )


def test_a_long_member_goes_on_in_machine_code(monkeypatch):
    """What it has spent counts while it runs."""
    asked = []

    def pays(seconds, kernel, ahead=0.0):
        asked.append(seconds)
        return len(asked) > 3

    system = pair(np.array([0.4, 0.41421356, 0.43]), 3e-4)
    with kernels.forced(False):
        plain = ri.sweep(system, until=0.02, workers=1)
    compiled = []
    make = kernels.compiled
    monkeypatch.setattr(kernels, "worth_compiling", pays)
    monkeypatch.setattr(
        kernels, "compiled", lambda kernel: compiled.append(kernel) or make(kernel)
    )
    assert same(ri.sweep(system, until=0.02, workers=1), plain)
    assert asked[1:4] == sorted(asked[1:4])  # as the log of the member grows
    assert len(compiled) == 1  # all members run in one block, which began in Python


def test_a_single_collision_is_a_family_too():
    system = pair(0.4, 1e-4)
    result = ri.sweep(system)
    assert result.shape == ()
    assert float(result.restitution) == ri.solve(system).outcome.restitution
    assert result.axes == ()
    assert result.explain(()).startswith("The collision is final")


def test_a_member_that_outgrows_the_work_space_runs_again(monkeypatch):
    system = ri.System(
        [
            ri.Rod(
                0.1 * np.sqrt([2, 3, 5, 7]),
                area=1e-4,
                material=MATERIALS[0],
                velocity=1.0,
            ),
            ri.Rod(0.13, area=3e-4, material=MATERIALS[1]),
            ri.Rod(0.17, area=5e-4, material=MATERIALS[0], velocity=-1.0),
        ]
    )
    roomy = ri.sweep(system)
    monkeypatch.setattr("rodimpact.methods.fronts.batch.INITIAL_LOG_ROWS", 1)
    for compiling in (False, True):
        with kernels.forced(compiling):
            assert same(ri.sweep(system), roomy)


@pytest.mark.skipif(not kernels.enabled(), reason="compiling is disabled")
def test_blocks_may_run_in_plain_python_and_then_compiled(monkeypatch):
    system = small_map((10, 10))
    asked = []
    plain = ri.sweep(system)

    def in_turns(seconds, kernel, ahead=0.0):
        asked.append(ahead)
        return len(asked) % 2 == 0

    monkeypatch.setattr("rodimpact.running.chunks.JOBS_A_WORKER", 1)
    monkeypatch.setattr("rodimpact.methods.fronts.driver.BLOCK_TIME", 0.0)
    monkeypatch.setattr("rodimpact.methods.fronts.driver.FIRST_BLOCK_SIZE", 8)
    monkeypatch.setattr(kernels, "worth_compiling", in_turns)
    assert same(ri.sweep(system, workers=1), plain)
    assert len(asked) > 9
    assert max(asked) > asked[-1]  # what is ahead counts


# Runs to a time ----------------------------------------------------------------------------------


def chain():
    """Ten rods with gaps, the first of three lengths: they meet again and again."""
    others = [ri.Rod(0.1, area=1e-4, material=STEEL)] * 9
    first = ri.Rod(np.linspace(0.05, 0.5, 3), area=1e-4, material=STEEL, velocity=1.0)
    return ri.System([first, *others], gaps=[1e-4] * 9)


@pytest.mark.parametrize("seed", few_of(range(20), range(8)))
@pytest.mark.parametrize("until", [None, 0.0, 1.4e-4, 1.86e-3])
def test_members_of_random_rows_equal_one_at_a_time(seed, until):
    system = varied(seed, driven=until is not None)
    options = {"until": until, "max_events": 2000, "method": "fronts"}
    with kernels.forced(bool(seed % 4)):
        result = ri.sweep(system, **options)
    assert_equal_to_one_at_a_time(result, **options)
    assert result.incomplete.tolist() == (result.status == "max_events").tolist()


def test_a_member_that_stops_early_keeps_what_is_known():
    result = ri.sweep(chain(), max_events=200)
    assert result.status.tolist() == ["max_events"] * 3
    assert result.incomplete.all()
    assert np.isnan(result.restitution).all()
    assert_equal_to_one_at_a_time(result, max_events=200)
    assert "cap of 20" in result.explain(0)


@pytest.mark.parametrize(("method", "cap"), [("fronts", 3), ("characteristics", 10)])
def test_a_cap_after_the_proof_is_not_why_a_run_ended(method, cap):
    """It cuts the vibration that a single run shows after the proof, as the status tells."""
    system = pair(np.array([0.4]), 1e-4)
    result = ri.sweep(system, method, max_events=cap)
    solution = ri.solve(system[0], method=method, max_events=cap)
    assert f"The cap of {cap}" in solution.status
    assert solution.stopped_by == result.status[0] == "final"
    assert solution.final
    assert result.final[0]


def test_a_cap_before_the_time_asked_for_is_no_end():
    """Although nothing can happen any more."""
    system = pair(np.array([0.4, 0.7]), 1e-4)
    result = ri.sweep(system, until=1.0, max_events=500)
    assert result.final.all()
    assert result.status.tolist() == ["max_events"] * 2
    assert "cap of" in result.explain(1)


# Strain gauges -----------------------------------------------------------------------------------

TIMES = np.linspace(0.0, 4e-4, 41)


@pytest.mark.parametrize(
    ("make", "options", "gauges"),
    [
        (
            lambda: small_map((3, 2)),
            {"until": 3e-4},
            [(0, 0.05), (1, 0.5), (1, 0.0), (0, 0.1)],
        ),
        (lambda: small_map((3, 2)), {}, [(1, 0.7)]),
        (
            lambda: ri.System(
                [
                    ri.Wall(),
                    ri.Rod(
                        segments=[
                            ri.Segment(0.1, np.array([1e-4, 2e-4]), STEEL),
                            ri.Segment(0.2, 2e-4, STEEL),
                        ],
                        velocity=-1.0,
                        strain=ri.Steps([1e-5, 0.0], [0.15]),
                    ),
                ]
            ),
            {"until": 4e-4},
            [(1, 0.1), (1, 0.25)],
        ),
        (
            lambda: ri.System(
                [
                    ri.RigidMass(0.1, velocity=np.array([1.0, 2.0])),
                    ri.Rod(0.5, area=1e-4, material=STEEL),
                    ri.Wall(),
                ],
                gravity=9.81,
            ),
            {"until": 3e-4},
            [(1, 0.2)],
        ),
        (
            lambda: ri.System(
                [
                    ri.Rod(
                        0.3, area=1e-4, material=STEEL, velocity=np.array([1.0, 2.0])
                    ),
                    ri.Wall(),
                ]
            ),
            {"until": 3e-4, "method": "finite-difference", "cells": 20},
            [(0, 0.1), (0, 0.3)],
        ),
    ],
)
def test_gauges_equal_those_of_single_solutions(make, options, gauges):
    system = make()
    result = ri.sweep(system, gauges=gauges, times=TIMES, **options)
    assert result.strain.shape == (*system.shape, len(gauges), len(TIMES))
    assert result.gauges == tuple(gauges)
    assert result.times.tolist() == TIMES.tolist()
    for index in np.ndindex(system.shape):
        solution = ri.solve(system[index], **options)
        inside = solution.t_end * (1 + 1e-12) >= TIMES
        for found, place in zip(result.strain[index], gauges, strict=True):
            record = solution.gauge(*place)
            assert found[inside].tolist() == record.strain_at(TIMES[inside]).tolist()
            assert np.isnan(found[~inside]).all()
    assert np.nanmax(np.abs(result.strain)) > 0
    assert same(result, ri.sweep(system, **options))


def test_a_refused_member_has_no_strain():
    result = ri.sweep(
        pair(np.array([0.5, 1e-13]), 1e-4), gauges=[(1, 0.5)], times=TIMES
    )
    assert np.isnan(result.strain).all(axis=(1, 2)).tolist() == [False, True]


@pytest.mark.parametrize(
    ("given", "path"),
    [
        ({"times": TIMES}, "times"),
        ({"gauges": [(1, 0.5)], "times": [-1.0]}, "times[0]"),
        ({"gauges": [(2, 0.5)], "times": TIMES}, "gauges.0.body"),
        ({"gauges": [(1, 0.5), (1.0, 0.5)], "times": TIMES}, "gauges.1.body"),
        ({"gauges": [(0, 0.3)], "times": TIMES}, "gauges.0.x"),
        ({"gauges": [(1, [0.1, 0.2])], "times": TIMES}, "gauges.0.x"),
    ],
)
def test_gauges_are_checked(given, path):
    assert list(
        problems(lambda: ri.sweep(pair(np.array([0.4, 0.2]), 1e-4), **given))
    ) == [path]


def test_gauges_are_saved_and_have_dimensions(tmp_path):
    result = ri.sweep(small_map((3, 2)), until=3e-4, gauges=[(1, 0.5)], times=TIMES)
    result.save(tmp_path / "family.npz")
    loaded = ri.load(tmp_path / "family.npz")
    assert loaded.strain.tobytes() == result.strain.tobytes()
    assert (loaded.gauges, loaded.options) == (result.gauges, result.options)
    assert loaded.times.tolist() == TIMES.tolist()
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert data["strain"].dims == ("bodies.0.length", "bodies.1.area", "gauge", "time")
    chosen = data["strain"].sel(time=TIMES[30]).isel(gauge=0)
    assert chosen.values.tolist() == result.strain[:, :, 0, 30].tolist()
    assert np.isfinite(chosen.values).all()
    assert (data["body"].values.tolist(), data["x"].values.tolist()) == ([1], [0.5])
    assert all(
        {"long_name", "units"} <= set(one.attrs) for one in data.variables.values()
    )


# Members without a result ------------------------------------------------------------------------


def with_one_bad(count=10_000):
    """A family in which one member has transit times too far apart for one clock."""
    lengths = np.full(count, 0.5)
    lengths[count // 3] = 1e-13
    return pair(lengths.reshape(-1, 100), 1e-4), np.unravel_index(
        count // 3, (count // 100, 100)
    )


def test_one_bad_member_does_not_lose_the_others():
    system, index = with_one_bad(10_000)
    result = ri.sweep(system)
    bad = result.status != "final"
    assert np.argwhere(bad).tolist() == [list(index)]
    assert np.isnan(result.restitution[index])
    assert not result.final[index]
    assert "too short beside the longest" in result.explain(index)
    np.testing.assert_allclose(result.restitution[~bad], 0.5, atol=1e-15)
    for name in (
        "velocity_after.0",
        "impulse.0",
        "vibration",
        "peak_force.0",
        "duration.0",
    ):
        assert np.isnan(result.columns[name][index])


def test_no_collision_is_no_error():
    result = ri.sweep(pair(0.4, 1e-4, velocity=np.array([1.0, -1.0, 0.0])))
    assert np.isnan(result.restitution).tolist() == [False, True, True]
    assert result.final.all()
    assert (result.episodes == [1, 0, 0]).all()
    assert "move apart" in result.explain(1)


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"method": "magic"}, "method"),
        ({"progress": None}, "progress"),
        ({"workers": 0}, "workers"),
        ({"max_events": 1.5}, "max_events"),
        *(
            ({"executor": executor}, "executor")
            for executor in (object(), "processes", 4, ProcessPoolExecutor)
        ),
    ],
)
def test_arguments_are_checked(change, path):
    assert list(problems(lambda: ri.sweep(pair(0.4, 1e-4), **change))) == [path]


# Executors ---------------------------------------------------------------------------------------


@pytest.fixture
def small_chunks(monkeypatch):
    monkeypatch.setattr("rodimpact.methods.fronts.families.MAX_MEMBERS_PER_CALL", 4)


def test_every_executor_gives_the_same_bytes(small_chunks):
    system = small_map()
    serial = ri.sweep(system, executor=SerialExecutor())
    with kernels.forced(True):
        assert same(ri.sweep(system), serial)
    read = {"until": 3e-4, "gauges": [(0, 0.05), (1, 0.5)], "times": TIMES}
    alone = ri.sweep(system, executor=SerialExecutor(), **read)
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=spawn) as pool:
        for how in ({"workers": 1}, {"workers": 5}, {"executor": pool}):
            assert same(ri.sweep(system, **how), serial)
            found = ri.sweep(system, **read, **how)
            assert same(found, alone)
            assert found.strain.tobytes() == alone.strain.tobytes()


def test_a_dask_cluster_gives_the_same_bytes(small_chunks):
    distributed = pytest.importorskip("distributed")
    system = small_map()
    serial = ri.sweep(system, executor=SerialExecutor())
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        with (
            distributed.LocalCluster(
                n_workers=2,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
            ) as cluster,
            distributed.Client(cluster) as client,
        ):
            result = ri.sweep(system, executor=client.get_executor())
    assert same(result, serial)


def test_progress_counts_collisions(small_chunks):
    seen = []
    ri.sweep(small_map(), progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (35, 35)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_axes_and_parameters_have_the_names_of_a_case_file():
    system = ri.System(
        [
            ri.Rod(
                np.linspace(0.1, 0.4, 4)[:, None, None],
                area=1e-4,
                material=STEEL,
                velocity=1,
            ),
            ri.Rod(
                segments=[
                    ri.Segment(0.2, np.array([1e-4, 2e-4]), STEEL),
                    ri.Segment(0.2, 1e-4, STEEL),
                ]
            ),
        ],
        gaps=[np.array([0.0, 1e-5, 2e-5])[:, None]],
    )
    result = ri.sweep(system)
    assert result.shape == (4, 3, 2)
    assert [axis.name for axis in result.axes] == [
        "bodies.0.length",
        "contacts.0.gap",
        "bodies.1.segments.0.area",
    ]
    assert result.axes[2].values.tolist() == [1e-4, 2e-4]
    assert set(result.parameters) == {axis.name for axis in result.axes}


def test_csv_holds_every_digit(tmp_path):
    result = ri.sweep(small_map((3, 2)))
    result.to_csv(tmp_path / "map.csv")
    names, *rows = (tmp_path / "map.csv").read_text().splitlines()
    assert names.split(",")[:3] == ["bodies.0.length", "bodies.1.area", "restitution"]
    assert len(rows) == 6
    cells = [row.split(",") for row in rows]
    assert [float(c[2]) for c in cells] == result.restitution.ravel().tolist()
    assert [float(c[1]) for c in cells] == [*result.axes[1].values] * 3
    assert cells[0][-1] == "final"


def test_to_xarray_and_pandas():
    pytest.importorskip("xarray")
    pytest.importorskip("pandas")
    result = ri.sweep(small_map((3, 2)))
    assert (
        repr(result)
        == "<SweepResult of shape (3, 2) over bodies.0.length, bodies.1.area>"
    )
    frame = result.to_dataframe()
    assert frame["restitution"].tolist() == result.restitution.ravel().tolist()
    assert set(frame["status"]) == {"final"}
    data = result.to_xarray()
    chosen = data["restitution"].sel({"bodies.1.area": 2e-5}).values
    assert chosen.tolist() == result.restitution[:, 0].tolist()
    assert (
        data["status"].values.tolist() == result.status.tolist() == [["final"] * 2] * 3
    )
    assert data["velocity_after.1"].attrs == {
        "long_name": "velocity of rod 2 after",
        "units": "m/s",
    }
    assert data["bodies.0.length"].attrs == {
        "long_name": "length of rod 1",
        "units": "m",
    }


def test_a_missing_package_is_named(monkeypatch):
    result = ri.sweep(pair(0.4, 1e-4))
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(ImportError, match=r"pip install 'rodimpact\[dataframe\]'"):
        result.to_dataframe()


@pytest.mark.parametrize("checkpoint", [False, True])
def test_a_family_with_no_members_is_refused(tmp_path, checkpoint):
    """As a mask selects that is nowhere true."""
    family = small_map()
    for nobody in (family[np.zeros(family.shape, dtype=bool)], family[:0]):
        with pytest.raises(
            ri.InvalidModel, match="system: has no members, its shape is"
        ):
            ri.sweep(nobody, checkpoint=tmp_path / "kept" if checkpoint else None)
    assert not (tmp_path / "kept").exists()


# What is asked for besides ------------------------------------------------------------------------


def rows_to_read():
    """Rows that bond, bounce off walls, vibrate at the start, and are driven."""

    def rod(length, velocity=0.0, area=1e-4, **strain):
        return ri.Rod(length, area=area, material=STEEL, velocity=velocity, **strain)

    lengths = np.array([0.3, 0.77])
    jumps = ri.Steps([1.0, 0.0, 2.0], at=[0.1, 0.2])
    return [
        ri.System(
            [rod(lengths, 1.0), rod(1.0, area=3e-4), ri.Wall(velocity=-0.1)],
            contacts=[ri.Rigid(), ri.Bonded()],
            gaps=[1e-5, 0.0],
        ),
        ri.System(
            [rod(lengths, jumps, strain=ri.Steps([1e-4, 0.0], at=[0.15])), rod(1.0)]
        ),
        ri.System(
            [rod(lengths), rod(1.0)],
            ends=(ri.Pushed(ri.Steps([1e3, 0.0], at=[1e-4])), ri.Absorbing()),
        ),
    ]


@pytest.mark.parametrize("compiling", [False, True])
@pytest.mark.parametrize("row", range(3))
@pytest.mark.parametrize("until", [4e-5, 1e-3])
def test_displacements_and_stresses_are_those_of_the_fields(row, until, compiling):
    system = rows_to_read()[row]
    with kernels.forced(compiling):
        result = ri.sweep(system, until=until, also=ALSO)
    assert result.method == "fronts"
    alone = ri.sweep(system, "characteristics", until=until, also=ALSO, rtol=1e-6)
    assert not result.dissipated.any()
    for i, body in enumerate(system.bodies):
        np.testing.assert_allclose(
            result.displacements[i], alone.displacements[i], rtol=1e-5, atol=1e-9
        )
        if isinstance(body, ri.Wall):
            assert i not in result.largest_stresses
            continue
        np.testing.assert_allclose(
            result.largest_stresses[i], alone.largest_stresses[i], rtol=1e-5, atol=1.0
        )
        solution = ri.solve(system[1], until=until)
        x = np.linspace(0, float(system[1].bodies[i].length), 2001)
        moved = solution.displacement(i, x, solution.t_end) - solution.displacement(
            i, x, 0.0
        )
        assert result.displacements[i][1] == pytest.approx(
            np.trapezoid(moved, x) / x[-1], rel=1e-4, abs=1e-9
        )
        stress = solution.stress(i, x[::10, None], np.linspace(0, solution.t_end, 1001))
        assert result.largest_stresses[i][1] == pytest.approx(
            np.abs(stress).max(), rel=1e-9
        )


def test_ground_that_yields_takes_the_yield_force_times_the_set():
    F = 1.8e4
    speeds = np.array([0.1, 5.0])
    pile = ri.Rod(1.0, area=1e-3, material=STEEL, velocity=speeds)
    ground = ri.Yielding(stiffness=1e8, yield_force=F)
    system = ri.System([pile, ri.Wall()], contacts=[ground])
    result = ri.sweep(system, until=8e-3, also=["dissipated", "set"])
    assert result.sets[0][0] == pytest.approx(0.0, abs=1e-12)
    assert result.sets[0][1] > 1e-4
    np.testing.assert_allclose(
        result.dissipated, F * result.sets[0], rtol=1e-6, atol=1e-6
    )
    with pytest.raises(ValueError, match="largest_stress: was not asked for"):
        _ = result.largest_stresses


def test_what_was_asked_for_is_in_tables_and_files(tmp_path):
    result = ri.sweep(pair(np.array([0.2, 0.4]), 1e-4), until=1e-3, also=ALSO)
    names = ["dissipated", "largest_stress.0", "displacement.1"]
    assert {*names} <= {*next(result.csv_lines()).split(",")}
    data = result.to_xarray()
    assert [data[name].attrs["units"] for name in names] == ["J", "Pa", "m"]
    result.save(tmp_path / "family.npz")
    again = ri.load(tmp_path / "family.npz")
    assert same(result, again)
    assert again.readings.also == ALSO


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("set", "must be a list of"),
        (["weight"], "got 'weight'"),
        (["displacement"], "until"),
    ],
)
def test_what_is_asked_for_is_checked(given, sentence):
    with pytest.raises(ri.InvalidModel, match=f"also: .*{sentence}"):
        ri.sweep(small_map(), also=given)


def test_where_no_thread_can_start(monkeypatch, small_chunks):
    system = small_map()
    threaded = ri.sweep(system)

    def refuses(thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("threading.Thread.start", refuses)
    assert same(ri.sweep(system), threaded)


def test_several_contacts_have_columns_of_their_own():
    rods = [
        ri.Rod(0.2, area=1e-4, material=STEEL, velocity=v)
        for v in ([1.0, 2.0], 0.0, 0.0)
    ]
    result = ri.sweep(ri.System(rods))
    np.testing.assert_allclose(result.velocities_after[2], [1.0, 2.0], rtol=1e-14)
    with pytest.raises(ValueError, match=r"result\.contacts"):
        _ = result.impulse
    one = result.contacts[0]
    pair = ri.sweep(ri.System(rods[:2]))
    assert (pair.duration.tolist(), pair.peak_force.tolist()) == (
        one.duration.tolist(),
        one.peak_force.tolist(),
    )


def test_a_law_that_other_processes_cannot_import_is_refused_with_a_remedy():
    masses = [ri.RigidMass([1.0, 2.0], velocity=1.0), ri.Wall()]
    family = ri.System(masses, contacts=[ri.Law(lambda d, rate: 1e8 * d)])
    remedy = (
        "contacts.0: .* define it with def at the top of a module, or leave executor"
    )
    with ProcessPoolExecutor(1) as pool:  # it starts no process before the first job
        with pytest.raises(ri.InvalidModel, match=remedy):
            ri.sweep(family, executor=pool)
        assert not pool._processes
