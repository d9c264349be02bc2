"""Attacks on the workbench, from pages elsewhere, from other programs on the machine, and from files in the folder.

Every group is a list below; this table states how many attacks are in each, and a test compares.

| group    | attacks | from                                                                    |
|----------|---------|-------------------------------------------------------------------------|
| host     |      17 | names turned to this machine (DNS rebinding)                            |
| origin   |      18 | pages elsewhere that post, read, embed or connect                       |
| key      |      17 | guesses at token and cookie, and keys of other servers                  |
| path     |      70 | names that lead out of the folder, or mean something else on a system   |
| link     |       6 | links, pipes and devices in the folder                                  |
| body     |      23 | bodies that are no JSON, too large, too deep, or say something twice    |
| toml     |       9 | texts that cost a reader its time or its stack                          |
| upload   |       7 | uploads that are too large, lie about their size, or break off          |
| request  |      12 | methods, upgrades and floods of headers, over a socket                  |
| text     |      12 | texts and names that would be read as part of a page                    |
| program  |       9 | plugins that nobody has let run                                         |

An attack passes where nothing is told, written or run that should not be; what is refused is refused in a sentence, and
the workbench answers the next request.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import socket
import threading
import time
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from truing.errors import UsageError
from truing.templating import template_folder
from truing.workbench import bench, guard, listening
from truing.workbench.bench import Bench
from truing.workbench.guard import FIXED, Key, hosts_of
from truing.workbench.places import files_below, inside
from truing.workbench.server import application
from truing.workbench.workers import Workers

PORT = 8765
BASE = f"http://127.0.0.1:{PORT}"
SECRET = "the secret outside of the folder"
NOTHING = hashlib.sha256(b"").hexdigest()
POSIX = os.name == "posix"


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder to serve, with a secret beside it."""
    outside = tmp_path_factory.mktemp("machine").resolve()
    (outside / "secret.toml").write_text(f'plugin = "{SECRET}"\n')
    (outside / "secret.py").write_text(f"# truing {SECRET}\n")
    served = outside / "served"
    (served / ".hidden").mkdir(parents=True)
    (served / ".hidden" / "key.toml").write_text(f'plugin = "{SECRET}"\n')
    (served / ".env").write_text(SECRET)
    (served / "press.toml").write_text('plugin = "press_linkage"\n')
    return served


@pytest.fixture(scope="module")
def workers(root: Path) -> Iterator[Workers]:
    made = Workers(2**31, root, quick=1)
    yield made
    made.close()


@pytest.fixture
def key() -> Key:
    return Key(PORT)


async def _fail(request: Request) -> Response:
    raise ZeroDivisionError(f"<script>{SECRET}</script>")


@pytest.fixture
def app(root: Path, key: Key, workers: Workers) -> guard.Guard:
    guarded = application(root, key, hosts_of("127.0.0.1", PORT), workers)
    starlette: Starlette = guarded.app
    starlette.router.routes.insert(0, Route("/api/fail", _fail))
    return guarded


@pytest.fixture
def stranger(app: guard.Guard) -> Iterator[TestClient]:
    """A client without the key."""
    with TestClient(app, base_url=BASE, follow_redirects=False, raise_server_exceptions=False) as made:
        yield made


@pytest.fixture
def client(stranger: TestClient, key: Key) -> TestClient:
    """A page of the workbench."""
    stranger.cookies.set(key.cookie, key.token)
    stranger.headers["origin"] = BASE
    return stranger


def asked(client: TestClient, address: str, **document: Any) -> Any:
    return client.post(address, json=document)


def everything(root: Path) -> dict[str, bytes]:
    """Return what is in the folder and around it."""
    return {
        str(path): path.read_bytes()
        for path in sorted(root.parent.rglob("*"))
        if path.is_file() and "__pycache__" not in path.parts
    }


# host

HOSTS = [
    "evil.example", f"evil.example:{PORT}", f"127.0.0.1.evil.example:{PORT}", f"localhost.evil.example:{PORT}",
    f"127.0.0.1:{PORT}.evil.example", f"evil.example#127.0.0.1:{PORT}", f"127.0.0.1:{PORT}@evil.example",
    f"user@127.0.0.1:{PORT}", f"127.0.0.1:{PORT + 1}", "127.0.0.1", "localhost", "", f"0.0.0.0:{PORT}",
    f"[::]:{PORT}", f"2130706433:{PORT}", f"0x7f000001:{PORT}", f"127.1:{PORT}",
]  # fmt: skip


@pytest.mark.parametrize("host", HOSTS)
def test_host(client: TestClient, key: Key, host: str) -> None:
    for headers in ({"host": host}, {"host": host, "origin": f"http://{host}"}):
        answer = client.get(f"/?token={key.token}", headers=headers)
        assert (answer.status_code, "set-cookie" in answer.headers) == (421, False)


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "LOCALHOST", "[::1]"])
def test_own_hosts_are_let_in(stranger: TestClient, key: Key, host: str) -> None:
    answer = stranger.get(f"/?token={key.token}", headers={"host": f"{host}:{PORT}"})
    assert (answer.status_code, answer.headers["location"]) == (303, "/")


def test_another_address_is_known_by_what_was_connected_to(key: Key, app: guard.Guard) -> None:
    app.hosts = hosts_of("0.0.0.0", PORT)
    there = TestClient(app, base_url=f"http://192.168.7.5:{PORT}", follow_redirects=False)
    assert there.get(f"/?token={key.token}").status_code == 303
    assert there.get(f"/?token={key.token}", headers={"host": f"evil.example:{PORT}"}).status_code == 421
    name = f"{socket.gethostname()}:{PORT}"
    assert there.get(f"/?token={key.token}", headers={"host": name}).status_code == 303


# origin: headers of a browser that has the cookie, as if SameSite did not keep it back

CROSS = {"sec-fetch-site": "cross-site"}
OTHER_PORT = {"origin": "http://127.0.0.1:9999", "sec-fetch-site": "same-site"}
ORIGINS: list[tuple[str, str, dict[str, str]]] = [
    ("POST", "/api/save", {"origin": "http://evil.example", **CROSS}),
    ("POST", "/api/save", {"origin": "null", **CROSS}),
    ("POST", "/api/save", {"origin": f"https://127.0.0.1:{PORT}"}),
    ("POST", "/api/save", {"origin": f"http://127.0.0.1:{PORT}.evil.example"}),
    ("POST", "/api/save", {"origin": f"http://evil.example/127.0.0.1:{PORT}"}),
    ("POST", "/api/save", {"origin": ""}),
    ("POST", "/api/save", OTHER_PORT),
    ("POST", "/api/save", {}),  # no browser leaves both out
    ("POST", "/api/save", CROSS),
    ("POST", "/api/save", {"sec-fetch-site": "none"}),
    ("POST", "/api/run", {"origin": "file://"}),
    ("GET", "/api/jobs", {"origin": "http://evil.example", **CROSS}),
    ("GET", "/api/jobs", {**CROSS, "sec-fetch-mode": "no-cors", "sec-fetch-dest": "script"}),
    ("GET", "/file/press.toml", {**CROSS, "sec-fetch-mode": "no-cors", "sec-fetch-dest": "image"}),
    ("GET", "/events", {**CROSS, "sec-fetch-mode": "cors", "accept": "text/event-stream"}),
    ("GET", "/events", OTHER_PORT),
    ("GET", "/", {**CROSS, "sec-fetch-mode": "navigate", "sec-fetch-dest": "iframe"}),
    ("GET", "/static/workbench.js", {"sec-fetch-site": "same-site", "sec-fetch-mode": "cors"}),
]


@pytest.mark.parametrize(("method", "address", "headers"), ORIGINS)
def test_origin(client: TestClient, root: Path, method: str, address: str, headers: dict[str, str]) -> None:
    before = everything(root)
    del client.headers["origin"]
    content = json.dumps({"file": "press.toml", "text": "gone", "base": _digest(root / "press.toml")})
    body = {"content": content} if method == "POST" else {}
    answer = client.request(method, address, headers={"content-type": "application/json", **headers}, **body)
    assert answer.status_code == 403
    assert everything(root) == before


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_what_comes_from_a_page_of_ours_or_was_typed_is_let_in(client: TestClient) -> None:
    del client.headers["origin"]
    assert client.get("/api/jobs").status_code == 200
    assert client.get("/api/jobs", headers={"sec-fetch-site": "same-origin"}).status_code == 200
    assert client.get("/static/workbench.js", headers={"sec-fetch-site": "none"}).status_code == 200
    link = {**CROSS, "sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    assert client.get("/static/workbench.js", headers=link).status_code == 200


# key

KEYS: list[tuple[str, str]] = [
    ("token", ""), ("token", "wrong"), ("token", "{token}x"), ("token", "{short}"), ("token", "{TOKEN}"),
    ("token", "{token}{token}"), ("token", "{used}"), ("token", "x" * 5000), ("token", "é\u2028"), ("token", "%00"),
    ("cookie", ""), ("cookie", "wrong"), ("cookie", "{TOKEN}"), ("cookie", "{ticket}"), ("cookie", "{token}x"),
    ("name", "{token}"), ("post", "{token}"),
]  # fmt: skip


@pytest.mark.parametrize(("where", "template"), KEYS)
def test_key(stranger: TestClient, key: Key, where: str, template: str) -> None:
    used = key.ticket()
    assert key.lets_in(used)
    given = template.format(
        token=key.token, TOKEN=key.token.swapcase(), short=key.token[:-1], used=used,
        ticket=key.ticket(),
    )  # fmt: skip
    if where == "cookie":
        stranger.cookies.set(key.cookie, given)
    if where == "name":
        stranger.cookies.set(f"truing_{PORT + 1}", given)
    method = "POST" if where == "post" else "GET"
    parameters = {"token": given} if where in {"token", "post"} else {}
    for address in ("/", "/api/jobs", "/static/workbench.js", "/events", "/file/press.toml"):
        answer = stranger.request(method, address, params=parameters, headers={"origin": BASE})
        assert answer.status_code in {401, 429}
        assert "set-cookie" not in answer.headers


def test_an_address_opens_again_and_a_ticket_once(stranger: TestClient, key: Key) -> None:
    ticket = key.ticket()
    opened = []
    for token in (key.token, key.token, ticket, ticket):
        stranger.cookies.clear()
        opened.append(stranger.get(f"/?token={token}").status_code)
    assert opened == [303, 303, 303, 401]


def test_the_cookie_is_for_this_server_alone_and_not_for_scripts(stranger: TestClient, key: Key) -> None:
    cookie = stranger.get(f"//evil.example/?token={key.token}").headers["set-cookie"].lower()
    assert cookie == f"truing_{PORT}={key.token}; httponly; path=/; samesite=strict".lower()


def test_a_token_sends_on_to_this_server(stranger: TestClient, key: Key) -> None:
    for path in ("//evil.example", "/\\evil.example", "///evil.example/"):
        where = stranger.get(BASE + path, params={"token": key.token}).headers["location"]
        assert re.match(r"/[^/\\]", where), where


def test_guesses_are_limited_in_a_second_and_shut_nobody_out(stranger: TestClient, key: Key) -> None:
    answers = [stranger.get("/", params={"token": f"guess {number}"}).status_code for number in range(30)]
    assert answers == [401] * guard.MOST_WRONG + [429] * (30 - guard.MOST_WRONG)
    assert stranger.get("/", params={"token": key.token}).status_code == 429
    assert stranger.get("/api/jobs", headers={"cookie": f"{key.cookie}={key.token}"}).status_code == 200
    key.wrong.extend(when - 1 for when in tuple(key.wrong))
    assert stranger.get("/", params={"token": key.token}).status_code == 303


# path

LONG = "n" * 300
PATHS = [
    "", ".", "..", "../secret.toml", "../../etc/passwd", "press.toml/../../secret.toml", "runs/../../secret.toml",
    "./../secret.toml", "./press.toml", "//secret.toml", "/etc/passwd", "{outside}/secret.toml", "{outside}",
    "{served}/press.toml", "..\\secret.toml", "runs\\..\\..\\secret.toml", "%2e%2e/secret.toml/..", "..%2fsecret/..",
    "..%5csecret.toml/..", "~/../x/..", "....//secret/..", "press.toml\0", "press.toml\0.txt", "\0", "..\0/secret.toml",
    "a\nb.toml", "a\rb.toml", "a\x1b[2Jb.toml", "a\tb.toml", "a\x7fb.toml", ".env", ".hidden/key.toml",
    "runs/.git/config", ".hidden", "...", "con", "CON.toml", "nul", "NUL.tar.toml", "aux.toml", "prn", "com1.toml",
    "COM9", "lpt1.txt", "com².toml", "conin$", "clock$", "runs/nul/a.toml", "nul .toml", "C:press.toml",
    "C:/windows/win.ini", "c:\\windows", "\\\\server\\share\\a.toml", "//server/share/a.toml", "\\\\?\\C:\\a",
    "press.toml:stream", "press.toml::$DATA", "press.toml.", "press.toml ", "a*.toml", "a?.toml", 'a".toml', "a|b",
    "<a>.toml", LONG, f"runs/{LONG}/a.toml", "a/" * 600 + "a.toml", "é" * 150, "runs//a.toml", "runs/",
]  # fmt: skip


@pytest.mark.parametrize("template", PATHS, ids=range(len(PATHS)))
def test_path(client: TestClient, root: Path, template: str) -> None:
    name = template.replace("{outside}", str(root.parent)).replace("{served}", str(root))
    before = everything(root)
    with pytest.raises(UsageError):
        inside(root, name)
    answers = [
        asked(client, "/api/save", file=name, text="written", base=NOTHING),
        asked(
            client, "/api/begin", file=f"{name}.toml/" if name.endswith((".", " ")) else name, plugin="press_linkage"
        ),
        asked(client, "/api/confirm", file=name),
        asked(client, "/api/state", file=name, plugin=name + ".py", text=""),
        asked(client, "/api/run", file=name, plugin="press_linkage"),
        asked(client, "/api/columns", file="press.toml", plugin="press_linkage", text="", data=[name]),
        client.get("/edit", params={"file": name}),
        client.get("/events", params={"file": name or ".."}),
    ]
    assert {answer.status_code for answer in answers} == {422}
    assert not any(SECRET in answer.text for answer in answers)
    assert everything(root) == before
    assert not any(job.status in {"runs", "waits"} for job in client.app.app.state.bench.workers.jobs.values())


@pytest.mark.parametrize("name", ["../secret.toml", "%2e%2e/secret.toml", "..%2fsecret.toml", "/etc/passwd", ".env"])
def test_files_and_static_files_stay_inside(client: TestClient, name: str) -> None:
    for folder in ("/file/", "/static/", "/file/x/../", "/static/%2e%2e/"):
        answer = client.get(folder + name)
        assert answer.status_code in {404, 422}
        assert SECRET not in answer.text
        assert "root:" not in answer.text


# link

LINKS = ["file outside", "folder outside", "circle", "to hidden", "pipe", "device"]


@pytest.mark.skipif(not POSIX, reason="needs links and pipes")
@pytest.mark.parametrize("kind", LINKS)
def test_link(client: TestClient, root: Path, kind: str) -> None:
    link = root / "link.toml"
    targets = {
        "file outside": "../secret.toml", "folder outside": "..", "circle": "link.toml", "device": "/dev/zero",
        "to hidden": ".hidden/key.toml",
    }  # fmt: skip
    if kind == "pipe":
        os.mkfifo(link)
    else:
        link.symlink_to(targets[kind])
    try:
        name = "link.toml/secret.toml" if kind == "folder outside" else "link.toml"
        before = None if kind == "pipe" else (root.parent / "secret.toml").read_bytes()
        assert link not in list(files_below(root, (".toml",)))
        answers = [
            client.get("/"),
            client.get("/edit", params={"file": name}),
            client.get(f"/file/{name}"),
            asked(client, "/api/save", file=name, text="written", base=_digest(root.parent / "secret.toml")),
        ]
        assert not any(SECRET in answer.text for answer in answers)
        assert [answer.status_code for answer in answers[:3]] == [200, 422, 422]
        assert before is None or (root.parent / "secret.toml").read_bytes() == before
    finally:
        link.unlink()


# body

DEEP = 100_000
BODIES: list[tuple[str, bytes]] = [
    ("application/json", b""), ("application/json", b"{"), ("application/json", b"[]"), ("application/json", b"null"),
    ("application/json", b"7"), ("application/json", b'"text"'), ("application/json", b"[" * DEEP),
    ("application/json", b'{"a":' * DEEP), ("application/json", b"[" * DEEP + b"]" * DEEP),
    ("application/json", b'{"text":' + b"9" * 5000 + b"}"), ("application/json", b'{"text":NaN}'),
    ("application/json", b'{"text":-Infinity}'), ("application/json", b'{"text":"a","text":"b"}'),
    ("application/json", b'{"a":{"b":1,"b":2}}'), ("application/json", b'{"text":"\xff\xfe"}'),
    ("application/json", '{"text":"a"}'.encode("utf-16")), ("application/json", b'\xef\xbb\xbf{"text":"a"}'),
    ("application/json", b'{"text":"' + b"x" * 5_000_000 + b'"}'), ("application/json", b"[" + b"[]," * 2_000_000),
    ("text/plain", b'{"file":"press.toml"}'), ("application/x-www-form-urlencoded", b"file=press.toml"),
    ("multipart/form-data; boundary=x", b"--x--"), ("", b'{"file":"press.toml"}'),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "content"), BODIES, ids=range(len(BODIES)))
def test_body(client: TestClient, root: Path, kind: str, content: bytes) -> None:
    before = everything(root)
    for address in ("/api/state", "/api/save"):
        answer = client.post(address, content=content, headers={"content-type": kind})
        assert answer.status_code == (413 if len(content) > 4_000_000 else 422)
        assert answer.json()["faults"][0]["message"].startswith("the request ")
    assert everything(root) == before


WORDS = [None, 7, [], {}, True, [[]], {"a": 1}]


@pytest.mark.parametrize("value", WORDS)
def test_what_is_no_text_is_refused(client: TestClient, value: object) -> None:
    for address in ("/api/state", "/api/save", "/api/begin", "/api/confirm", "/api/cancel", "/api/run"):
        assert asked(client, address, file=value, text=value, plugin=value, base=value, job=value).status_code == 422


# toml

TOMLS = [
    "a = " + "[" * DEEP, "a = " + "{a=" * DEEP, ".".join("a" * 3_000) + " = 1", "[" + ".".join("a" * 3_000) + "]",
    "".join(f"[a{'.a' * number}]\n" for number in range(500)), "a = " + "9" * 100_000, "a = 1e99999999",
    'a = """' + "\\" * 99_999, "a = 1\n" * 50_000,
]  # fmt: skip


@pytest.mark.parametrize("text", TOMLS, ids=range(len(TOMLS)))
def test_toml(client: TestClient, root: Path, text: str) -> None:
    (root / "bomb.toml").write_text(text)
    try:
        about = {"file": "press.toml", "plugin": "press_linkage", "text": text}
        began = time.monotonic()
        answers = [
            asked(client, "/api/state", **about),
            asked(client, "/api/state", **about, change={"path": ["inputs", "load"], "value": "1 N"}),
            client.get("/"),
            client.get("/edit", params={"file": "bomb.toml"}),
        ]
        assert time.monotonic() - began < 10
        assert {answer.status_code for answer in answers} <= {200, 422}
        assert "press.toml" in answers[2].text
    finally:
        (root / "bomb.toml").unlink()


# upload

UPLOADS = [
    "too large",
    "too large, without length",
    "lies: more",
    "length is no number",
    "there already",
    "folder",
    "many",
]


@pytest.mark.parametrize("kind", UPLOADS)
def test_upload(client: TestClient, root: Path, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "LARGEST_UPLOAD", 100_000)
    (root / "data" / "folder.csv").mkdir(parents=True, exist_ok=True)
    (root / "data" / "there.csv").write_text("a\n1\n", encoding="utf-8")
    before = everything(root)
    content: Any = b"x" * (200_000 if kind == "too large" else 10)
    headers: dict[str, str] = {}
    name = {"there already": "there.csv", "folder": "folder.csv"}.get(kind, "upload.csv")
    if "without" in kind:
        content = (b"x" * 10_000 for _ in range(20))
    if kind == "lies: more":
        content, headers = (b"x" * 10_000 for _ in range(20)), {"content-length": "10"}
    if kind == "length is no number":
        headers = {"content-length": "²"}
    status = {"there already": 409, "folder": 422}.get(kind, 413)
    for _ in range(20 if kind == "many" else 1):
        answer = client.post(
            "/api/upload", params={"name": name}, content=b"x" * 200_000 if kind == "many" else content,
            headers={name: value.encode() for name, value in headers.items()},
        )  # fmt: skip
        assert answer.status_code == status, answer.text
    assert everything(root) == before


@pytest.mark.parametrize("template", PATHS, ids=range(len(PATHS)))
def test_an_upload_lies_in_its_folder_whatever_its_name(client: TestClient, root: Path, template: str) -> None:
    name, before = template.replace("{outside}", str(root.parent)).replace("{served}", str(root)), everything(root)
    assert client.post("/api/upload", params={"name": f"{name}.csv"}, content=b"written").status_code in {200, 422}
    new = [Path(path) for path in everything(root).keys() - before.keys()]
    for path in new:
        path.unlink()
    assert {path.parent for path in new} <= {root / "data"}
    assert everything(root) == before


def test_an_upload_is_written_whole(client: TestClient, root: Path) -> None:
    content = bytes(range(256)) * 300
    answer = client.post("/api/upload", params={"name": "new.csv"}, content=content)
    assert answer.json() == {"file": "data/new.csv"}
    assert (root / "data" / "new.csv").read_bytes() == content
    (root / "data" / "new.csv").unlink()


# request, over a socket

HEAD = f"Host: 127.0.0.1:{PORT}\r\n"
REQUESTS: list[tuple[bytes, bytes]] = [
    (b"GET / HTTP/1.1\r\n" + b"A: " + b"x" * 200_000, b"400"),
    (b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 50_000, b"400"),
    (b"GET /" + b"x" * 200_000, b"400"),
    (b"GET / HTTP/1.1\r\n\r\n", b"400"),
    (b"\x16\x03\x01\x02\x00\x01" + b"\x00" * 100 + b"\r\n\r\n", b"400"),
    (b"POST /api/save HTTP/1.1\r\n{head}Content-Length: 5\r\nContent-Length: 6\r\n\r\n", b"400"),
    (b"POST /api/save HTTP/1.1\r\n{head}Content-Length: -1\r\n\r\n", b"400"),
    (b"TRACE / HTTP/1.1\r\n{head}{cookie}\r\n", b"405"),
    (b"PUT /api/save HTTP/1.1\r\n{head}{cookie}\r\n", b"405"),
    (b"GET / HTTP/1.1\r\n{head}{cookie}Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
     b"Sec-WebSocket-Key: eHh4eHh4eHh4eHh4eHh4eA==\r\n\r\n", b"405"),
    (b"GET http://evil.example/ HTTP/1.1\r\nHost: evil.example\r\n{cookie}\r\n", b"421"),
    (b"GET / HTTP/1.1\r\n{head}Host: evil.example\r\n{cookie}\r\n", b"400"),
]  # fmt: skip


@pytest.fixture(scope="module")
def served(root: Path, workers: Workers) -> Iterator[tuple[int, Key]]:
    """A server on a port of its own, whose connections are given up early."""
    patch = pytest.MonkeyPatch()
    patch.setattr(listening, "SLOWEST_HEAD", 0.3)
    patch.setattr(guard, "SLOWEST_PART", 0.3)
    with listening._listening("127.0.0.1", 0) as own:
        port = own.getsockname()[1]
        key = Key(port)
        config = listening.configured(application(root, key, hosts_of("127.0.0.1", port), workers))
        server = uvicorn.Server(config)
        own.listen()
        thread = threading.Thread(target=server.run, kwargs={"sockets": [own]})
        thread.start()
        yield port, key
        server.should_exit = True
        thread.join(5)
    patch.undo()


def sent(served: tuple[int, Key], content: bytes) -> bytes:
    """Send bytes and return what comes until the connection ends, or nothing more for a while."""
    port, key = served
    content = content.replace(b"{head}", f"Host: 127.0.0.1:{port}\r\n".encode())
    content = content.replace(b"{cookie}", f"Cookie: {key.cookie}={key.token}\r\n".encode())
    with socket.create_connection(("127.0.0.1", port), timeout=2) as connection:
        answer = b""
        try:
            connection.sendall(content)
            while b"\r\n\r\n" not in answer and (part := connection.recv(65536)):
                answer += part
        except OSError:
            pass
        return answer


@pytest.mark.parametrize(("content", "status"), REQUESTS, ids=range(len(REQUESTS)))
def test_request(served: tuple[int, Key], content: bytes, status: bytes) -> None:
    answer = sent(served, content)
    assert answer[9:12] == status or (len(content) > 100_000 and answer == b"")  # closed while it still comes
    assert b"set-cookie" not in answer
    assert sent(served, b"GET /api/jobs HTTP/1.1\r\n{head}{cookie}\r\n").startswith(b"HTTP/1.1 200")


SLOW = [
    (b"", b""),
    (b"GET / HT", b""),
    (b"GET / HTTP/1.1\r\n{head}A: b", b""),
    (b'POST /api/save HTTP/1.1\r\n{head}{cookie}{own}Content-Length: 900\r\n\r\n{"a"', b"HTTP/1.1 408"),
]


@pytest.mark.parametrize(("content", "answered"), SLOW)
def test_what_does_not_go_on_is_given_up(served: tuple[int, Key], content: bytes, answered: bytes) -> None:
    own = f"Origin: http://127.0.0.1:{served[0]}\r\nContent-Type: application/json\r\n".encode()
    began = time.monotonic()
    answer = sent(served, content.replace(b"{own}", own))
    assert answer[:12] == answered
    assert time.monotonic() - began < 1.5


def test_connections_are_bounded(served: tuple[int, Key], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listening, "MOST_CONNECTIONS", 5)
    many = [socket.create_connection(("127.0.0.1", served[0])) for _ in range(30)]
    time.sleep(0.1)
    ended = 0
    for connection in many:
        connection.settimeout(0.01)
        try:
            ended += connection.recv(1) == b""
        except TimeoutError:
            pass
        except OSError:
            ended += 1
        connection.close()
    assert ended >= 24


def test_a_websocket_is_refused(client: TestClient) -> None:
    with pytest.raises(WebSocketDisconnect), client.websocket_connect("/events"):
        pass


# text

TEXTS = [
    "<script>alert(1)</script>", "<img src=x onerror=alert(1)>", '"><svg onload=alert(1)>', "' onmouseover='alert(1)",
    "</textarea><script>alert(1)</script>", "</title><script>alert(1)</script>", "{{ 7 * 7 }}", "{% include 'x' %}",
    "${alert(1)}", "javascript:alert(1)", "&lt;script&gt;", "\u202egnp.exe\u2028</script>",
]  # fmt: skip


ADDRESSES = {"href", "src", "action", "formaction", "srcdoc"}


class Attributes(HTMLParser):
    """Every attribute of a page, as a browser reads it."""

    def __init__(self) -> None:
        super().__init__()
        self.seen: list[tuple[str, str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen += [(name, (value or "").strip().lower()) for name, value in attrs]


@pytest.mark.parametrize("text", TEXTS)
def test_text(client: TestClient, root: Path, text: str) -> None:
    named = re.sub(r'[<>"|?*\\/:]', "_", text).strip(" .")
    (root / f"{named}.toml").write_text(f"# {text}\nplugin = '''press_linkage {text}'''\n")
    (root / "hostile.toml").write_text(f"# {text}\nplugin = 'press_linkage'\n")
    try:
        pages = [
            client.get("/"),
            client.get("/edit", params={"file": "hostile.toml"}),
            client.get("/edit", params={"file": f"{named}.toml"}),
            client.get("/edit", params={"file": text}),
            client.get("/edit", params={"file": "press.toml", "plugin": text}),
            client.get(f"/nothing/{text}"),
        ]
        assert [page.status_code for page in pages[:2]] == [200, 200]
        for page in pages:
            assert page.headers["content-type"] == "text/html; charset=utf-8"
            for sign in ("<script>alert", "<img src=x", "<svg onload", ">49<"):
                assert sign not in page.text
            read = Attributes()
            read.feed(page.text)
            assert not [name for name, _ in read.seen if name.startswith("on")]
            assert not [value for name, value in read.seen if name in ADDRESSES and value.startswith("javascript:")]
    finally:
        for file in (f"{named}.toml", "hostile.toml"):
            (root / file).unlink()


# program

PROGRAM = 'from pathlib import Path\nPath(__file__).with_name("ran").write_text("ran")\n'
PROGRAMS = [
    {"plugin": "evil.py"}, {"plugin": "./evil.py"}, {"plugin": "{root}/evil.py"}, {"plugin": "evil"},
    {"plugin": "evil.PY"}, {"plugin": "folder/../evil.py"}, {"plugin": "evil.py\0"}, {"plugin": "os.path"},
    {"plugin": "rv_gearing", "text": 'plugin = "evil.py"\n'},
]  # fmt: skip


@pytest.mark.parametrize("document", PROGRAMS)
def test_program(client: TestClient, root: Path, document: dict[str, str]) -> None:
    (root / "evil.py").write_text(PROGRAM + "# truing\n")
    (root / "evil.toml").write_text('plugin = "evil.py"\n')
    try:
        said = {name: value.replace("{root}", str(root)) for name, value in document.items()}
        for address in ("/api/state", "/api/begin", *["/api/run"] * said["plugin"].endswith("y")):
            asked(client, address, **{"file": "evil.toml", "text": "", **said})
        client.get("/")
        client.get("/edit", params={"file": "evil.toml", "plugin": said["plugin"]})
        served: Bench = client.app.app.state.bench
        end = time.monotonic() + 10
        while any(not job.is_over for job in served.workers.jobs.values()) and time.monotonic() < end:
            time.sleep(0.02)
        assert not (root / "ran").exists()
    finally:
        for name in ("evil.py", "evil.toml", "ran"):
            (root / name).unlink(missing_ok=True)


def test_a_program_runs_once_it_was_confirmed(client: TestClient, root: Path) -> None:
    (root / "own.py").write_text(PROGRAM)
    about = {"file": "press.toml", "plugin": "own.py", "text": ""}
    try:
        refused = asked(client, "/api/state", **about)
        assert (refused.status_code, refused.json()["confirm"]) == (409, "own.py")
        assert asked(client, "/api/confirm", file="own.py").status_code == 200
        asked(client, "/api/state", **about)
        assert (root / "ran").exists()
    finally:
        for name in ("own.py", "ran"):
            (root / name).unlink(missing_ok=True)


# What holds of every answer, and of every page

ANSWERS = [
    ("GET", "/", 200), ("GET", "/edit?file=press.toml", 200), ("GET", "/edit?file=no", 422), ("GET", "/nothing", 404),
    ("GET", "/static/workbench.js", 200), ("GET", "/static/nothing.js", 404), ("GET", "/file/press.toml", 200),
    ("GET", "/api/jobs", 200), ("GET", "/api/fail", 500), ("GET", "/api/nothing", 404), ("POST", "/api/jobs", 405),
    ("POST", "/api/save", 422), ("DELETE", "/", 405), ("HEAD", "/static/workbench.css", 200),
]  # fmt: skip


@pytest.mark.parametrize(("method", "address", "status"), ANSWERS)
def test_every_answer_has_the_headers(client: TestClient, method: str, address: str, status: int) -> None:
    answer = client.request(method, address)
    assert answer.status_code == status
    assert {name: answer.headers[name] for name in FIXED} == FIXED
    assert answer.headers["content-security-policy"].startswith("default-src 'none'; script-src 'self'; ") or (
        "/file/" in address and "sandbox" in answer.headers["content-security-policy"]
    )
    assert answer.headers["cache-control"] == "no-store"
    assert "access-control-allow-origin" not in answer.headers
    assert SECRET not in answer.text or answer.headers["content-type"] == "application/json"


def test_strangers_and_streams_have_the_headers(stranger: TestClient, served: tuple[int, Key]) -> None:
    for headers in ({}, {"host": "evil.example"}, {"origin": "http://evil.example"}):
        assert stranger.get("/", headers=headers).headers["content-security-policy"] == guard.POLICY
    stream = sent(served, b"GET /events HTTP/1.1\r\n{head}{cookie}\r\n").lower()
    assert b"text/event-stream" in stream
    for name, value in FIXED.items():
        assert f"{name}: {value}".lower().encode() in stream


def test_pages_hold_no_script_of_their_own_and_scripts_write_no_markup() -> None:
    folder = template_folder() / "workbench"
    for page in folder.glob("*.j2"):
        text = page.read_text(encoding="utf-8")
        text = re.sub(r"<math>{{ [\w.]+ \| safe }}</math>", "", text)  # written by our own writer of formulas
        assert not re.search(r"<script(?![^>]*\ssrc=\"/static/)|\son[a-z]+=|\|\s*safe|autoescape|javascript:", text), (
            page
        )
        assert not re.search(r"(?:src|href)=\"(?:https?:)?//", text), page
    for script in (folder / "static").glob("*.js"):
        text = script.read_text(encoding="utf-8")
        assert not re.search(r"\beval\(|new Function|document\.write|insertAdjacentHTML|outerHTML|https?://", text), (
            script
        )
        for line in re.findall(r".*innerHTML.*", text):  # what our printers have written, and nothing else
            assert re.search(r"innerHTML ?[:=] ?(`<style>\$\{\w+\}</style>\$\{)?(\w+\.)?(svg|html)\b", line), (
                script,
                line,
            )


def test_the_table_counts_the_attacks() -> None:
    groups = {
        "host": HOSTS, "origin": ORIGINS, "key": KEYS, "path": PATHS, "link": LINKS, "body": BODIES, "toml": TOMLS,
        "upload": UPLOADS, "request": REQUESTS, "text": TEXTS, "program": PROGRAMS,
    }  # fmt: skip
    stated = dict(re.findall(r"^\| (\w+) +\| +(\d+) \|", __doc__ or "", re.MULTILINE))
    assert {name: int(count) for name, count in stated.items()} == {name: len(list_) for name, list_ in groups.items()}
    names = {name.removeprefix("test_") for name in globals() if name.startswith("test_")}
    assert set(groups) <= names
