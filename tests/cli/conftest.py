"""What the tests of the command line share: a case in a directory of its own, and
calls.
"""

import pytest
from case_texts import UNEQUAL_RODS

from rodimpact.cli import main


@pytest.fixture
def case(tmp_path, monkeypatch):
    """Path of case.toml, two rods of unequal length, in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "case.toml"
    path.write_text(UNEQUAL_RODS)
    return path


@pytest.fixture
def refuses(capsys):
    """Function that checks that a call ends with 2, names these sentences on standard
    error and prints nothing else; it returns the text of standard error.
    """

    def call(argv, *said):
        capsys.readouterr()
        assert main(argv) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert "Traceback" not in err
        for text in said:
            assert text in err
        return err

    return call


@pytest.fixture
def output_of(capsys):
    """A function that runs a command, asserts its exit status, 0 by default, and
    returns its standard output.
    """

    def call(*argv, status=0):
        capsys.readouterr()
        assert main(argv) == status
        return capsys.readouterr().out

    return call
