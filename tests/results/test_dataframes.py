"""Tables of pandas and Datasets of xarray say the same as the objects they come
from.
"""

import numpy as np

import rodimpact as ri

STEEL = ri.materials.steel
LEFT = ri.Rod(0.4, area=1e-4, material=STEEL, velocity=1.0)
RIGHT = ri.Rod(1.0, area=1e-4, material=STEEL)
PAIR = ri.System([LEFT, RIGHT])


def test_an_outcome_is_the_row_that_a_sweep_has():
    row = ri.solve(PAIR).outcome.to_dataframe()
    swept = ri.sweep(PAIR).to_dataframe()
    assert set(row) == set(swept) - {"status"}
    for name in row:
        assert row[name].tolist() == swept[name].tolist(), name


def test_an_undefined_restitution_is_nan():
    frame = ri.collide(RIGHT, RIGHT).to_dataframe()
    assert np.isnan(frame["restitution"][0])


def test_each_episode_of_a_contact_is_a_row():
    system = ri.System([LEFT, RIGHT, LEFT.replace(velocity=0.0), ri.Wall()])
    for contact in ri.solve(system).contacts:
        frame = contact.to_dataframe()
        assert list(frame) == ["start", "force_end", "opening"]
        assert len(frame) == len(contact.episodes)
        for i, episode in enumerate(contact.episodes):
            np.testing.assert_array_equal(frame.iloc[i], episode)
    without_episode = ri.solve(ri.System([RIGHT, RIGHT])).contacts[0].to_dataframe()
    assert list(without_episode) == ["start", "force_end", "opening"]
    assert len(without_episode) == 0


def test_a_signal_is_two_columns_with_units():
    signal = ri.Signal([1.0, 2.0], [0.0, 1e-3], unit="V")
    frame = signal.to_dataframe()
    assert frame["signal"].tolist() == [1.0, 2.0]
    assert frame["time"].tolist() == [0.0, 1e-3]
    assert frame.attrs["units"] == {"time": "s", "signal": "V"}


def test_datasets_say_which_version_made_them_of_which_case():
    of_solution = ri.solve(PAIR).to_xarray(0.0, 0.0).attrs
    assert of_solution["version"] == ri.__version__
    assert ri.parse_case(of_solution["case"]).system == PAIR
    family = ri.System([LEFT.replace(length=[[0.2], [0.4]]), RIGHT])
    of_sweep = ri.sweep(family).to_xarray().attrs
    assert of_sweep["version"] == ri.__version__
    assert ri.parse_case(of_sweep["case_of_first_member"]).system == family[0, 0]
    signal = ri.Signal([0.0, 1.0], [0.0, 1e-3], unit="N")
    of_signals = ri.signals_to_xarray({"force": signal}).attrs
    assert of_signals == {"version": ri.__version__}


def test_a_law_that_is_a_function_leaves_the_case_out():
    law = ri.Law(lambda d, rate: 1e9 * d)
    system = ri.System([LEFT, RIGHT], contacts=[law])
    dataset = ri.solve(system, until=1e-5).to_xarray(0.0, 0.0)
    assert "case" not in dataset.attrs
    assert dataset.attrs["method"] == "characteristics"
