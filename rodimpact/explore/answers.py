"""Questions of the page and their answers: JSON in, an HTTP status and JSON out.

`serve` answers one after the other on the standard streams of a process of its own.
"""

from __future__ import annotations

import json
import sys
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from typing import Any

import numpy as np

from ..methods.duration import LongRun
from ..model.frozen import InvalidModel, Problems
from ..storage.casefile import write_case
from .comparison import solved_curve
from .design import Design
from .scene import scene

ANSWERS: dict[str, Callable[[Design], Any]] = {
    "/scene": lambda design: scene(design, design.solve()),
    "/curve": lambda design: solved_curve(design),
    "/case": lambda design: {"toml": write_case(design.case)},
}


def answer(path: str, question: bytes) -> tuple[HTTPStatus, bytes]:
    """Answer the question sent to a path of `ANSWERS`.

    Parameters
    ----------
    path : str
    question : bytes
        JSON, as `Design.parse` takes it.

    Returns
    -------
    (HTTPStatus, bytes)
        200 and the answer, or another and the problems, as JSON.
    """
    try:
        design = json.loads(question, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        return HTTPStatus.BAD_REQUEST, problems_json([("body", f"is not JSON: {error}")])
    try:
        return HTTPStatus.OK, _json(ANSWERS[path](Design.parse(design)))
    except InvalidModel as error:
        return HTTPStatus.UNPROCESSABLE_ENTITY, problems_json(error.problems)
    except ArithmeticError:
        message = "has numbers too large or too small to compute with; choose them nearer to 1"
        return HTTPStatus.UNPROCESSABLE_ENTITY, problems_json([("case", message)])
    except Exception:
        traceback.print_exc()
        message = "a fault of rodimpact, not yours; see where it was started"
        return HTTPStatus.INTERNAL_SERVER_ERROR, problems_json([("", message)])


def problems_json(problems: Problems) -> bytes:
    """What is wrong with a request."""
    return _json({"problems": [{"path": path, "message": text} for path, text in problems]})


def serve() -> None:
    """Answer what comes on standard input, each a line with path and size and then so many bytes.

    On standard output a line with status and size comes before each answer.
    """
    np.seterr(all="ignore")
    warnings.simplefilter("ignore", LongRun)  # there is a limit, and a word, for who asks
    questions, answers = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr  # what is printed is no answer
    with suppress(BrokenPipeError):  # nobody waits for it any more
        while heading := questions.readline():
            path, size = heading.split()
            status, body = answer(path.decode(), questions.read(int(size)))
            answers.write(b"%d %d\n" % (status, len(body)) + body)
            answers.flush()


def _json(data: Any) -> bytes:
    try:
        return json.dumps(data, allow_nan=False, separators=(",", ":")).encode()
    except ValueError as error:
        raise OverflowError(f"nan or an infinite number: {error}") from None


def _no_number(text: str) -> Any:
    raise ValueError(f"{text} is no number of JSON")
