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
    """Columns and values of both data frames are equal."""
    row = ri.solve(PAIR).outcome.to_dataframe()

    swept = ri.sweep(PAIR).to_dataframe()
    swept_columns = set(swept) - {"status"}  # an outcome has it as a text
    assert set(row) == swept_columns
    for name in row:
        values = row[name].tolist()
        expected = swept[name].tolist()
        assert values == expected, name


def test_the_restitution_of_rods_that_do_not_collide_is_nan():
    at_rest = ri.collide(RIGHT, RIGHT)
    frame = at_rest.to_dataframe()
    assert np.isnan(frame["restitution"][0])


EPISODE_COLUMNS = ["start", "force_end", "opening"]
"""Times of an episode, s: the columns of a table of a contact."""


def test_each_episode_of_a_contact_is_a_row():
    """The data frame of each contact of a row has the columns of an episode and its
    episodes as rows, in order.
    """
    third = LEFT.replace(velocity=0.0)
    system = ri.System([LEFT, RIGHT, third, ri.Wall()])
    for contact in ri.solve(system).contacts:
        frame = contact.to_dataframe()
        assert list(frame) == EPISODE_COLUMNS
        assert len(frame) == len(contact.episodes)
        for i, episode in enumerate(contact.episodes):
            row = frame.iloc[i]
            np.testing.assert_array_equal(row, episode)


def test_a_contact_without_a_collision_has_a_table_without_rows():
    at_rest = ri.solve(ri.System([RIGHT, RIGHT]))
    contact = at_rest.contacts[0]
    frame = contact.to_dataframe()
    assert list(frame) == EPISODE_COLUMNS
    assert len(frame) == 0


def test_a_signal_is_two_columns_with_units():
    values = [1.0, 2.0]
    times = [0.0, 1e-3]  # s
    signal = ri.Signal(values, times, unit="V")
    frame = signal.to_dataframe()
    assert frame["signal"].tolist() == values
    assert frame["time"].tolist() == times
    assert frame.attrs["units"] == {"time": "s", "signal": "V"}


def dataset_at_the_start(solution):
    """Dataset of a solution at one place of each body and one time, both 0."""
    return solution.to_xarray(0.0, 0.0)


def test_a_dataset_of_a_solution_says_which_version_made_it_of_which_case():
    """The case in its attributes is read again."""
    solution = ri.solve(PAIR)
    notes = dataset_at_the_start(solution).attrs
    case = ri.parse_case(notes["case"])
    assert notes["version"] == ri.__version__
    assert case.system == PAIR


def test_a_dataset_of_a_sweep_says_which_version_made_it_and_its_first_case():
    """The attributes of the dataset have the version, and a case that is the first
    member.
    """
    striker = LEFT.replace(length=[[0.2], [0.4]])
    family = ri.System([striker, RIGHT])
    notes = ri.sweep(family).to_xarray().attrs
    case = ri.parse_case(notes["case_of_first_member"])
    assert notes["version"] == ri.__version__
    assert case.system == family[0, 0]


def test_a_dataset_of_signals_says_which_version_made_it():
    signal = ri.Signal([0.0, 1.0], [0.0, 1e-3], unit="N")
    notes = ri.signals_to_xarray({"force": signal}).attrs
    assert notes == {"version": ri.__version__}


def test_a_law_that_is_a_function_leaves_the_case_out():
    """A case is text, and a function cannot be written into it."""
    law = ri.Law(lambda overlap, rate: 1e9 * overlap)
    system = ri.System([LEFT, RIGHT], contacts=[law])
    solution = ri.solve(system, until=1e-5)
    notes = dataset_at_the_start(solution).attrs
    assert "case" not in notes
    assert notes["method"] == "characteristics"
