"""The server behind the page: it answers its own page, refuses the rest cleanly, and lives on."""

import contextlib
import http.client
import json
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest

import rodimpact as ri
from rodimpact.explore import workers
from rodimpact.explore.answers import answer
from rodimpact.explore.page_files import SERVED
from rodimpact.explore.presets import presets
from rodimpact.explore.server import MOST_BYTES, Server

DESIGN = next(preset.design for preset in presets() if preset.key == "unequal")
ROOT = Path(ri.__file__).parent.parent


@contextlib.contextmanager
def serving():
    with Server(DESIGN) as running:
        thread = threading.Thread(target=running.serve_forever, daemon=True)
        thread.start()
        try:
            yield running
        finally:
            running.shutdown()
            thread.join()


@pytest.fixture(scope="module")
def server():
    with serving() as running:
        yield running


def ask(server, method, path, body=None, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=20)
    connection.request(method, path, body, headers)
    answer = connection.getresponse()
    found = answer.status, answer.headers, answer.read()
    connection.close()
    return found


def post(server, path, data, **headers):
    body = data if isinstance(data, bytes | str) else json.dumps(data)
    kind = {"Content-Type": "application/json", **headers}
    status, _, answer = ask(server, "POST", path, body, **kind)
    return status, json.loads(answer)


def alive(server):
    status, answer = post(server, "/scene", DESIGN.to_dict())
    return status == 200 and answer["restitution"]["text"] == "0.4"


def design(**changes):
    case = DESIGN.to_dict()["case"]
    for path, value in changes.items():
        keys = [int(key) if key.isdecimal() else key for key in path.split("__")]
        place = case
        for key in keys[:-1]:
            place = place[key] if isinstance(place, list) else place.setdefault(key, {})
        place[keys[-1]] = value
    return {"case": case, "gauges": []}


@pytest.mark.parametrize("name", ["", *SERVED])
def test_the_page_is_served_under_a_strict_policy(server, name):
    status, headers, body = ask(server, "GET", f"/{name}")
    assert status == 200
    assert body
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "http" not in policy
    assert headers["X-Content-Type-Options"] == "nosniff"


def test_the_page_asks_for_nothing_from_elsewhere(server):
    for name in SERVED:
        text = ask(server, "GET", f"/{name}")[2].decode()
        assert "http://" not in text.replace("http://www.w3.org/2000/svg", ""), name
        assert "https://" not in text, name


def test_the_page_begins_with_its_design(server):
    start = json.loads(ask(server, "GET", "/start.json")[2])
    assert start["design"] == DESIGN.to_dict()
    assert len(start["presets"]) == len(presets())
    assert "steel" in start["materials"]


def test_a_case_comes_back_as_a_file_that_run_reads(server):
    status, answer = post(server, "/case", DESIGN.to_dict())
    assert status == 200
    assert ri.parse_case(answer["toml"]).system == DESIGN.case.system


def test_the_curve_is_solved_on_request(server):
    status, curve = post(server, "/curve", DESIGN.to_dict())
    assert status == 200
    assert curve["values"][3] == pytest.approx(curve["ratios"][3], abs=1e-12)


@pytest.mark.parametrize("body", [
    b"", b"{", b"[]", b"null", b'"text"', b"\xff\xfe", b'{"case": NaN}', b'{"case": 1e999}',
    b'{"case": Infinity}', b"9" * 6000, b"[" * 5000, b'{"case": {}}', b'{"case": {"schema": 1}}',
    b'{"case": {"schema": 1, "bodies": [{"kind": "rod", "length": 1e999}]}}',
    b'{"case": {"schema": 1, "bodies": [[[]]]}}', b'{"gauges": []}', b'{"case": {"": {}}}',
])
def test_what_is_no_design_is_refused(server, body):
    status, answer = post(server, "/scene", body)
    assert 400 <= status < 500
    assert answer["problems"][0]["message"]
    assert alive(server)


@pytest.mark.parametrize(("changes", "path"), [
    ({"bodies__0__length": 1e308}, None),
    ({"bodies__0__length": 1e-308}, None),
    ({"bodies__0__length": -1.0}, "bodies.0.length"),
    ({"bodies__0__length": 0}, "bodies.0.length"),
    ({"bodies__0__length": True}, "bodies.0.length"),
    ({"bodies__0__length": None}, "bodies.0.length"),
    ({"bodies__0__length": 10**400}, "bodies.0.length"),
    ({"bodies__0__velocity": 1e300}, None),
    ({"bodies__0__material": "chees"}, "bodies.0.material"),
    ({"bodies__0__kind": 7}, "bodies.0.kind"),
    ({"contacts__0__gap": -1e-6}, "contacts.0.gap"),
    ({"contacts__0": {"law": "spring", "stiffness": -1}}, "contacts.0.stiffness"),
    ({"contacts__0": {"law": "spring", "stiffness": 1e300}}, None),
    ({"solve__max_events": 10**9}, "solve.max_events"),
    ({"solve__until": 1e300}, None),
    ({"solve__method": "magic"}, "solve.method"),
    ({"solve__until": -1.0}, "solve.until"),
    ({"gravity": 9.81}, None),
    ({"solve__until": 1e9, "gravity": 9.81}, "solve.until"),
    ({"ends": {"left": {"kind": "force", "value": 1.0}}}, None),
])
def test_bad_parameters_are_told_with_their_path(server, changes, path):
    status, answer = post(server, "/scene", design(**changes))
    assert 200 <= status < 500
    if path:
        assert status == 422
        assert path in [problem["path"] for problem in answer["problems"]]
    assert alive(server)


@pytest.mark.parametrize("path", ["/scene", "/curve"])
@pytest.mark.parametrize("changes", [
    {"bodies__0__area": 1e-320}, {"bodies__0__area": 5e-324}, {"bodies__0__area": 1e160},
    {"bodies__0__velocity": 1e-308}, {"bodies__0__length": 1e308},
])
def test_numbers_beyond_all_reach_are_no_fault(server, path, changes):
    status, data = post(server, path, design(**changes))
    assert status in (200, 422)
    assert status == 200 or data["problems"][0]["message"]


@pytest.mark.parametrize("solve", [{"max_events": 1}, {"until": 1e-30}])
def test_runs_of_no_time_are_told(server, solve):
    status, data = post(server, "/scene", design(solve=solve))
    assert status == 422
    assert "there is nothing to draw" in data["problems"][0]["message"]


@pytest.mark.parametrize("host", [
    "example.org", "localhost", "127.0.0.1", "127.0.0.1:1", "localhost:80", "evil.127.0.0.1", "",
])
def test_another_host_is_refused(server, host):
    status, _, body = ask(server, "GET", "/", Host=host)
    assert status == 403
    assert json.loads(body)["problems"]
    assert alive(server)


def test_its_own_names_are_answered(server):
    for name in ("127.0.0.1", "localhost"):
        assert ask(server, "GET", "/", Host=f"{name}:{server.server_port}")[0] == 200


def test_another_origin_is_refused(server):
    assert post(server, "/scene", DESIGN.to_dict(), Origin="https://example.org")[0] == 403
    own = f"http://127.0.0.1:{server.server_port}"
    assert post(server, "/scene", DESIGN.to_dict(), Origin=own)[0] == 200


@pytest.mark.parametrize("path", [
    "/../../etc/passwd", "/..%2f..%2fetc%2fpasswd", "//etc/passwd", "/page.html/..", "/main.py",
    "/page/page.html", "/%00", "/" + "a" * 5000, "/scene", "http://example.org/",
])
def test_only_files_of_the_page_are_served(server, path):
    status, _, body = ask(server, "GET", path)
    assert 400 <= status < 500
    assert json.loads(body)["problems"]
    assert alive(server)


def test_other_addresses_and_methods_are_refused(server):
    assert post(server, "/other", {})[0] == 404
    for method in ("PUT", "DELETE", "OPTIONS", "PATCH", "BREW"):
        status, _, body = ask(server, method, "/scene")
        assert status == 405
        assert json.loads(body)["problems"]
    assert alive(server)


def test_bodies_have_a_size_and_a_kind(server):
    assert post(server, "/scene", b" " * (MOST_BYTES + 1))[0] == 413
    assert post(server, "/scene", b"{}", **{"Content-Length": "9" * 50})[0] == 413
    assert post(server, "/scene", b"{}", **{"Content-Length": "-1"})[0] == 411
    assert post(server, "/scene", b"{}", **{"Content-Type": "text/plain"})[0] == 415
    assert post(server, "/scene", b"{}", **{"Transfer-Encoding": "chunked"})[0] == 411
    assert alive(server)


@pytest.mark.parametrize("raw", [
    b"\r\n\r\n", b"GARBAGE\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"GET /\r\n\r\n",
    b"GET / HTTP/1.1\r\n\r\n", b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 200 + b"\r\n",
    b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n",
])
def test_noise_on_the_line_does_no_harm(server, raw):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=20) as line:
        line.sendall(raw)
        line.shutdown(socket.SHUT_WR)
        answer = b""
        while piece := line.recv(65536):
            answer += piece
    assert b" 200 " not in answer.split(b"\r\n")[0]
    assert alive(server)


def test_a_visitor_who_leaves_early_does_no_harm(server, capfd):
    for _ in range(3):
        with socket.create_connection(("127.0.0.1", server.server_port), timeout=20) as line:
            line.sendall(b"POST /scene HTTP/1.1\r\nContent-Length: 100\r\n")
    assert alive(server)
    assert "Traceback" not in capfd.readouterr().err


def test_many_ask_at_once(server):
    answers = []
    threads = [threading.Thread(target=lambda: answers.append(alive(server))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == [True] * 8


# Answers that take long

STUCK = (
    "from rodimpact.explore import answers; import time;"
    "answers.ANSWERS['/curve'] = lambda design: time.sleep(1000); answers.serve()"
)


def test_an_answer_that_takes_too_long_is_given_up_and_the_next_one_comes(monkeypatch):
    monkeypatch.setattr(workers, "PROGRAM", STUCK)
    with serving() as server:
        assert alive(server)
        monkeypatch.setattr(workers, "SECONDS", 0.2)
        status, answer = post(server, "/curve", DESIGN.to_dict())
        assert status == 503
        assert "takes more than 0.2 s" in answer["problems"][0]["message"]
        assert "rodimpact run" in answer["problems"][0]["message"]
        monkeypatch.setattr(workers, "SECONDS", 20.0)
        assert alive(server)


def test_one_slow_answer_keeps_nobody_waiting(monkeypatch):
    monkeypatch.setattr(workers, "PROGRAM", STUCK)
    answers = []
    with serving() as server:
        slow = [
            threading.Thread(
                target=lambda: answers.append(post(server, "/curve", DESIGN.to_dict())[0]))
            for _ in range(workers.MOST - 1)
        ]
        for thread in slow:
            thread.start()
        assert all(alive(server) for _ in range(3))
        assert answers == []
        server.workers.end()
        for thread in slow:
            thread.join()
    assert answers == [503] * len(slow)


def test_more_than_are_answered_at_once_wait_and_are_told_in_the_end(monkeypatch):
    monkeypatch.setattr(workers, "MOST", 1)
    monkeypatch.setattr(workers, "SECONDS", 0.2)
    monkeypatch.setattr(workers, "PROGRAM", STUCK)
    pool = workers.Workers()
    first = pool._turns.acquire()
    assert first
    with pytest.raises(workers.Unanswered, match="too many ask at once"):
        pool.ask("/case", b"{}")


def test_an_answer_is_what_the_process_was_sent_for(server):
    sent = json.dumps(DESIGN.to_dict()).encode()
    assert server.workers.ask("/case", sent) == tuple(answer("/case", sent))


# The command


@contextlib.contextmanager
def explore(*arguments):
    with subprocess.Popen(
        [sys.executable, "-m", "rodimpact", "explore", *arguments], cwd=ROOT, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.mark.usefixtures("children_hear_signals")
def test_the_command_says_where_it_serves_and_ends_with_ctrl_c(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(ri.write_case(DESIGN.case))
    with explore(str(case), "--no-browser") as process:
        url = process.stdout.readline().strip()
        host, port = url.removeprefix("http://").rstrip("/").split(":")
        connection = http.client.HTTPConnection(host, int(port), timeout=20)
        connection.request("GET", "/start.json")
        assert json.loads(connection.getresponse().read())["design"] == DESIGN.to_dict()
        connection.close()
        process.send_signal(signal.SIGINT)
        _, complaints = process.communicate(timeout=20)
    assert process.returncode == 0
    assert complaints == ""


def test_a_plain_collision_loads_no_heavy_package():
    code = (
        "import sys, json\n"
        "from rodimpact.explore.answers import ANSWERS\n"
        "from rodimpact.explore.presets import presets\n"
        "for preset in presets():\n"
        "    ANSWERS['/scene'](preset.design)\n"
        "print([m for m in ('matplotlib', 'scipy', 'numba') if m in sys.modules])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(("arguments", "said"), [
    (["--port", "70000"], "--port"), (["--port", "x"], "--port"), (["none.toml"], "cannot be read"),
])
def test_mistakes_in_the_call(arguments, said):
    with explore("--no-browser", *arguments) as process:
        _, complaints = process.communicate(timeout=20)
    assert process.returncode == 2
    assert said in complaints
    assert "Traceback" not in complaints


def test_a_port_in_use_is_told(server):
    with explore("--no-browser", "--port", str(server.server_port)) as process:
        _, complaints = process.communicate(timeout=20)
    assert process.returncode == 1
    assert "Traceback" not in complaints
    assert str(server.server_port) in complaints


@pytest.mark.parametrize("head", [
    "POST /case HTTP/1.1\r\nOrigin: http://elsewhere.example", "GET / HTTP/1.1",
    "POST /nowhere HTTP/1.1", "BREW / HTTP/1.1",
])
def test_a_body_that_is_not_read_is_no_request(server, head):
    host = f"Host: 127.0.0.1:{server.server_port}\r\n"
    inner = f"GET /start.json HTTP/1.1\r\n{host}\r\n"
    size = f"Content-Length: {len(inner)}\r\n"
    whole = f"{head}\r\n{host}Content-Type: text/plain\r\n{size}\r\n{inner}"
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=20) as connection:
        connection.sendall(whole.encode())
        answer = b""
        with contextlib.suppress(ConnectionResetError):  # it has closed before it read all
            while piece := connection.recv(1 << 16):
                answer += piece
    assert answer.count(b"HTTP/1.1 ") == 1
    assert b'"presets"' not in answer


def test_what_is_no_http_is_refused_in_http(server):
    with socket.create_connection(("127.0.0.1", server.server_port), timeout=20) as connection:
        connection.sendall(b"no such thing\r\n\r\n")
        assert connection.recv(1 << 16).startswith(b"HTTP/1.1 400 ")
