"""Answers from processes of their own: one that takes too long is ended, and no other waits."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections import deque
from contextlib import suppress

READY = 2  # processes that wait for questions from the start
MOST = 8  # at the same time
SECONDS = 10.0  # for an answer
PROGRAM = f"from {__package__}.answers import serve; serve()"


class Unanswered(Exception):
    """There is no answer; the message says why, and what else to do."""


class Workers:
    """Processes that answer questions, each one at a time, started when they are needed."""

    def __init__(self) -> None:
        self._turns = threading.BoundedSemaphore(MOST)
        self._idle: deque[_Worker] = deque()
        self._all: set[_Worker] = set()
        self._ended = False
        self._lock = threading.Lock()  # of these two

    def start(self) -> None:
        """Start those that wait for the first questions."""
        self._idle.extend(self._new() for _ in range(READY))

    def ask(self, path: str, question: bytes) -> tuple[int, bytes]:
        """Status and body of `answers.answer`.

        Raises
        ------
        Unanswered
            If that takes more than the time limit, or too many ask at once.
        """
        if not self._turns.acquire(timeout=SECONDS):
            raise Unanswered("too many ask at once; try again")
        try:
            try:
                worker = self._idle.pop()
            except IndexError:
                worker = self._new()
            answer = worker.ask(path, question)
            if answer is not None:
                self._idle.append(worker)
                return answer
            self._all.discard(worker)
            worker.end()
            self._idle.appendleft(self._new())
        finally:
            self._turns.release()
        raise Unanswered(
            f"this takes more than {SECONDS:g} s, or more memory than there is; ask for a shorter "
            "run or fewer bodies, or solve it with rodimpact run"
        )

    def end(self) -> None:
        """End all of them; no more are started."""
        with self._lock:
            self._ended = True
        for worker in tuple(self._all):
            worker.end()

    def _new(self) -> _Worker:
        with self._lock:
            if self._ended:
                raise Unanswered("the server has ended")
            worker = _Worker()
            self._all.add(worker)
        return worker


class _Worker:
    """A process that runs `answers.serve`."""

    def __init__(self) -> None:
        program = f"import sys; sys.path[:] = {sys.path!r}; {PROGRAM}"
        self.process = subprocess.Popen(
            [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            env={**os.environ, "NUMBA_DISABLE_JIT": "1"},  # short runs: compiling takes longer
            start_new_session=True,  # Ctrl-C is for the server alone, which ends them
            creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
        )

    def ask(self, path: str, question: bytes) -> tuple[int, bytes] | None:
        """Status and body; None where it was ended before, for taking too long."""
        questions, answers = self.process.stdin, self.process.stdout
        assert questions is not None
        assert answers is not None
        limit = threading.Timer(SECONDS, self.process.kill)
        limit.start()
        try:
            questions.write(f"{path} {len(question)}\n".encode() + question)
            questions.flush()
            status, size = map(int, answers.readline().split())
            body = answers.read(size)
        except (OSError, ValueError):  # it has been ended
            return None
        finally:
            limit.cancel()
        return (status, body) if len(body) == size else None

    def end(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            assert pipe is not None
            with suppress(OSError):  # what it has not read
                pipe.close()
