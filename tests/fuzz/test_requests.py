"""Raw requests to the page's server, broken in every way: answers in JSON, and never a fault."""

import json
import socket
import threading
from contextlib import suppress

import numpy as np
import pytest
from fuzz.generators import CASES, SEEDS, TIMES, one_of, spoilt_text

import rodimpact as ri
from rodimpact.explore.design import Design
from rodimpact.explore.server import MOST_BYTES, Server

EXAMPLES = 60 * TIMES  # of each seed
DESIGN = Design.of(ri.parse_case(CASES[0]))
PATHS = ["/scene", "/curve", "/case", "/", "/start.json", "/main.js", "/../main.js", "/%00", "*"]
METHODS = ["POST", "POST", "GET", "HEAD", "PUT", "BREW", "", "\x00"]
LENGTHS = ["0", "5", "-1", "1e3", "\u0665", "9" * 12, str(MOST_BYTES), str(MOST_BYTES + 1), "", " "]
HEADERS = ["Host", "Origin", "Content-Type", "Transfer-Encoding", "Connection", "Expect"]
VALUES = [None, "", "chunked", "close", "keep-alive", "100-continue", "x" * 70_000, "\x00"]


@pytest.fixture(scope="module")
def server():
    with Server(DESIGN) as running:
        faults = []
        running.handle_error = lambda *_: faults.append("an exception reached the server")
        running.faults = faults
        thread = threading.Thread(target=running.serve_forever, daemon=True)
        thread.start()
        yield running
        running.shutdown()
        thread.join()


def exchange(server, *pieces):
    """All that comes back when these bytes are sent, one piece after the other."""
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=60) as connection:
        with suppress(OSError):  # it has heard enough
            for piece in pieces:
                connection.sendall(piece)
            connection.shutdown(socket.SHUT_WR)
        answer = b""
        with suppress(ConnectionResetError):
            while piece := connection.recv(1 << 16):
                answer += piece
        return answer


def request(server, method, path, body, **headers):
    own = {
        "Host": f"127.0.0.1:{server.server_port}", "Content-Type": "application/json",
        "Content-Length": str(len(body)), **headers,
    }
    lines = [f"{method} {path} HTTP/1.1", *(f"{k}: {v}" for k, v in own.items() if v is not None)]
    return "\r\n".join([*lines, "", ""]).encode("utf-8", "replace") + body


def body_of(rng):
    """A design, spoilt in its text."""
    if rng.random() < 0.1:
        return rng.bytes(99)
    return spoilt_text(rng, json.dumps(DESIGN.to_dict())).encode("utf-8", "replace")


def broken(rng, server):
    """The pieces of one request."""
    kind, body = rng.integers(7), body_of(rng)
    path = one_of(rng, PATHS)
    if kind == 0:
        return [rng.bytes(rng.integers(1, 3000))]
    if kind == 1:
        return [request(server, one_of(rng, METHODS), path, body)]
    if kind == 2:
        return [request(server, "POST", path, body, **{"Content-Length": one_of(rng, LENGTHS)})]
    if kind == 3:
        return [request(server, "POST", path, body, **{one_of(rng, HEADERS): one_of(rng, VALUES)})]
    if kind == 4:  # several at once, and the last cut off
        whole = request(server, "POST", "/case", body)
        return [whole * 3 + whole[: rng.integers(len(whole))]]
    whole = bytearray(request(server, "POST", "/scene", body))
    if kind == 5:  # a few wrong bytes in the head
        for place in rng.integers(200, size=3):
            whole[place % len(whole)] = rng.integers(256)
        return [bytes(whole)]
    cuts = sorted(rng.integers(len(whole) + 1, size=5).tolist())
    return [bytes(whole[a:b]) for a, b in zip([0, *cuts], [*cuts, len(whole)], strict=True)]


def check(answer):
    """Answers are whole, and problems are told in JSON."""
    while answer:
        head, found, rest = answer.partition(b"\r\n\r\n")
        assert found
        status, *lines = head.decode("latin-1").split("\r\n")
        version, code = status.split(" ")[:2]
        assert version == "HTTP/1.1"
        if code == "100":
            answer = rest
            continue
        headers = dict(line.split(": ", 1) for line in lines)
        assert 200 <= int(code) < 500 or code in ("503", "505"), status
        size = int(headers["Content-Length"])
        body, answer = rest[:size], rest[size:]
        if int(code) >= 400 and body:
            problem = json.loads(body)["problems"][0]
            assert problem["message"]
        elif headers["Content-Type"].startswith("application/json") and body:
            json.loads(body, parse_constant=pytest.fail)


@pytest.mark.parametrize("seed", SEEDS)
def test_broken_requests_are_answered_or_dropped(server, seed):
    rng = np.random.default_rng(seed)
    for _ in range(EXAMPLES):
        check(exchange(server, *broken(rng, server)))
    assert not server.faults
    good = request(server, "POST", "/scene", json.dumps(DESIGN.to_dict()).encode())
    assert exchange(server, good).startswith(b"HTTP/1.1 200 ")


@pytest.mark.parametrize("patience", ["head", "body"])
def test_those_who_wait_delay_nobody(server, patience):
    good = request(server, "POST", "/scene", json.dumps(DESIGN.to_dict()).encode())
    half = good[: 20 if patience == "head" else -20]
    waiting = [socket.create_connection(("127.0.0.1", server.server_port)) for _ in range(50)]
    for connection in waiting:
        connection.sendall(half)
    assert exchange(server, good).startswith(b"HTTP/1.1 200 ")
    for connection in waiting:
        connection.close()
