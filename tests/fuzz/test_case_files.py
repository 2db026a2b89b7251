"""Case files spoilt at random are refused in sentences, or run to numbers that
balance.
"""

import json
from contextlib import suppress
from typing import NamedTuple

import numpy as np
import pytest
from fuzz.generators import (
    CASES,
    SEEDS,
    TIMES,
    one_of,
    patience,
    spoilt_bytes,
    spoilt_text,
)
from numpy.random import default_rng

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.cli.exit_status import DONE, FAULT, INCOMPLETE, MISTAKE

EXAMPLES = 30 * TIMES  # of each seed
RESIDUAL_RTOL = 1e-6
# A case may ask for hours of work, and would get them.
SHORT = ["--json", "--max-events", "3000", "--until", "0.2 ms"]
SOLVED = (DONE, INCOMPLETE)
"""Exit statuses of a run that printed its outcome: it is over, or stopped before."""


class CommandResult(NamedTuple):
    """What a command left."""

    status: int
    out: str
    errors: str
    files: set[str]  # names of files beside the case


def run_case(capsys, monkeypatch, folder, data):
    """Run a case file of these bytes in a directory that holds nothing else.

    Return a `CommandResult`, and empty the directory.
    """
    (folder / "case.toml").write_bytes(data)
    monkeypatch.chdir(folder)
    with patience(), np.errstate(all="warn", under="ignore"):
        status = main(["run", "case.toml", *SHORT])
    out, errors = capsys.readouterr()
    files = {path.name for path in folder.iterdir()} - {"case.toml"}
    for path in folder.iterdir():
        path.unlink()
    return CommandResult(status, out, errors, files)


def check(result):
    """Check that a run printed finite numbers that balance, or a few sentences.

    It left no trace of a fault, and no file but the one that a case may ask for.
    """
    lines = result.errors.splitlines()
    assert "Traceback" not in result.errors
    assert "Warning" not in result.errors
    assert "fault of rodimpact" not in result.errors
    if result.status in SOLVED:
        for line in lines:
            assert "this run takes some" in line
        assert result.files <= {"x.toml"}
        # `parse_constant` is called for numbers that are not finite.
        outcome = json.loads(result.out, parse_constant=pytest.fail)["outcome"]
        assert abs(outcome["momentum_residual"]) < RESIDUAL_RTOL
        assert abs(outcome["energy_residual"]) < RESIDUAL_RTOL
    else:
        assert result.status in (FAULT, MISTAKE)
        assert not result.out
        assert not result.files
        assert len(result.errors) < 20_000
        for line in lines:
            assert line.isprintable()
            assert line.startswith("rodimpact: ")


def assert_round_trip(data):
    """A case that can be read is the same case after it is written and read again."""
    with suppress(UnicodeDecodeError, ri.InvalidModel):
        case = ri.parse_case(data.decode())
        assert ri.parse_case(ri.format_case(case)) == case


# Objects that other tests left may be collected here, and warn that they are open.
@pytest.mark.filterwarnings(
    "default", "ignore::ResourceWarning", "ignore::DeprecationWarning"
)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_spoilt_case_is_refused_or_balances_and_is_written_as_it_was_read(
    capsys, monkeypatch, tmp_path, seed
):
    """Randomly spoilt case files are run: each is refused, or its balances hold; what
    can be read is the same after writing and reading. More than a quarter are refused.
    """
    rng = default_rng(seed)
    refused = 0
    for _ in range(EXAMPLES):
        data = spoilt_bytes(rng, spoilt_text(rng, one_of(rng, CASES)))
        result = run_case(capsys, monkeypatch, tmp_path, data)
        check(result)
        refused += result.status == MISTAKE
        assert_round_trip(data)
        # Reading takes less long than a run: four more texts are read only.
        for _ in range(4):
            assert_round_trip(spoilt_text(rng, one_of(rng, CASES)).encode())
    assert EXAMPLES / 4 < refused < EXAMPLES
