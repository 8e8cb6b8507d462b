# SPDX-License-Identifier: Apache-2.0
"""Attacks on the server: what is outside the opened folder stays unread, no code of a case runs, text stays text."""

from __future__ import annotations

import http.client
import json
import os
import resource
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import h5py
import numpy as np
import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.server.http import MOST_BYTES, Response, Server
from presswork.server.site import Site

SECRET = "the secret of the next folder"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one run, beside a file that is none of its business."""
    root = tmp_path_factory.mktemp("beside")
    (root / "secret.txt").write_text(SECRET)
    np.asarray([float(ord(letter)) for letter in SECRET]).tofile(root / "secret.bin")
    opened = root / "opened"
    path = copy_example("upsetting_q4", opened)
    settings = ["workpiece.mesh.cells=[3,3]", "output.steps=2", "stages.0.tools.punch.stroke=1"]
    run(Case.from_toml(path, overrides=settings), opened / "run")
    return opened


@pytest.fixture(scope="module")
def server(folder: Path) -> Iterator[Server]:
    with Server(Site(folder).answer) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server
        server.shutdown()


def ask(
    server: Server, address: str, method: str = "GET", *, token: str | None = None, body: bytes = b"", **headers: str
) -> tuple[int, str, dict[str, str]]:
    """Return status, text and headers of an answer; headers: with _ for -."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    path = f"/{server.token if token is None else token}/{address}"
    connection.request(method, path, body=body, headers={key.replace("_", "-"): text for key, text in headers.items()})
    answer = connection.getresponse()
    found = answer.status, answer.read().decode(errors="replace"), dict(answer.headers)
    connection.close()
    return found


def test_only_this_machine_is_served(server: Server) -> None:
    assert server.server_address[0] == "127.0.0.1"


@pytest.mark.parametrize("token", ["", "wrong", "..", "%00", "é"])
def test_without_the_token_nothing_is_told(server: Server, token: str) -> None:
    status, text, _ = ask(server, "runs", token=quote(token))
    assert status == 403
    assert "run" not in json.loads(text)


def test_token_cannot_be_guessed(server: Server, folder: Path) -> None:
    with Server(Site(folder).answer) as other:
        assert len(other.token) >= 32
        assert other.token != server.token


@pytest.mark.parametrize(
    "body",
    [b'{"text": NaN}', b'{"data": {"a": Infinity}}', b'{"data": {"a": 1e999}}', b'{"data": 1' + b"0" * 400 + b"}",
     b'{"text": "\\ud800"}', b"[]", b"{", b"\xff"],
)  # fmt: skip
@pytest.mark.parametrize("address", ["check?case=upsetting_q4.toml", "save?case=upsetting_q4.toml", "material"])
def test_bodies_that_are_no_plain_data_are_refused(server: Server, address: str, body: bytes) -> None:
    status, text, _ = ask(server, address, "POST", body=body)
    assert status == 400
    assert json.loads(text)["error"].startswith("the request is no")


@pytest.mark.parametrize("line", ["GET runs", "GET ?a", "GET http://[x", "GET *", "POST x"])
def test_request_lines_that_name_no_page_are_refused(server: Server, line: str) -> None:
    port = server.server_port
    with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
        connection.sendall(f"{line} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
        answer = connection.makefile("rb").readline()
    assert answer.split()[1] in (b"400", b"403")


def test_a_fault_of_the_program_is_no_exception_in_words(folder: Path) -> None:
    def fail(_: object) -> Response:
        raise ZeroDivisionError("a secret of the program")

    with Server(fail) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        status, text, _ = ask(server, "runs")
        server.shutdown()
    assert status == 500
    assert "secret" not in text


def test_other_names_of_the_server_are_refused(server: Server) -> None:
    """A page elsewhere may have its name lead to 127.0.0.1 (DNS rebinding)."""
    assert ask(server, "runs", Host=f"evil.example:{server.server_port}")[0] == 403
    assert ask(server, "runs", Host=f"localhost:{server.server_port}")[0] == 200


def test_pages_of_others_cannot_act(server: Server) -> None:
    assert ask(server, "stop?run=run", "POST", Origin="http://evil.example")[0] == 403


OUTSIDE = ["..", "../opened/../../beside0", "/etc", "run/../..", "%2e%2e", "run/../../", "\x00", "a" * 5000, "~"]


@pytest.mark.parametrize("name", OUTSIDE)
@pytest.mark.parametrize("page", ["run?run=", "picture?run=", "table?sweep=", "news?steps=0&rows=0&run="])
def test_no_name_leads_out_of_the_folder(server: Server, page: str, name: str) -> None:
    status, text, _ = ask(server, page + quote(name, safe="%"))
    assert status in (400, 403, 404)
    assert SECRET not in text


@pytest.mark.parametrize(
    "name", ["../site.py", "/etc/passwd", "..%2fsite.py", "list.html/../../site.py", "__init__.py"]
)
def test_no_file_but_those_of_the_pages_is_sent(server: Server, name: str) -> None:
    assert ask(server, f"files/{name}")[0] == 404


def test_links_that_lead_out_are_not_followed(server: Server, folder: Path) -> None:
    """A run whose case, or whose folder, is a link to something outside."""
    made = folder / "linked"
    made.mkdir()
    for name in ("results.vtkhdf", "summary.json", "history.csv"):
        (made / name).write_bytes((folder / "run" / name).read_bytes())
    (made / "case.toml").symlink_to(folder.parent / "secret.txt")
    (made / "plots").mkdir()
    (made / "plots" / "mesh_x.png").symlink_to(folder.parent / "secret.txt")
    (folder / "out").symlink_to(folder.parent)
    for address in ("run?run=linked", "picture?run=linked", "runs", "run?run=out/opened/run", "picture?run=out"):
        assert SECRET not in ask(server, address)[1], address
    assert ask(server, "run?run=linked")[0] == 403
    (folder / "out").unlink()


@pytest.mark.parametrize("kind", ["link", "raw", "virtual"])
def test_results_that_take_data_from_other_files_are_refused(server: Server, folder: Path, kind: str) -> None:
    made = folder / f"hdf_{kind}"
    made.mkdir()
    path = made / "results.vtkhdf"
    path.write_bytes((folder / "run" / "results.vtkhdf").read_bytes())
    with h5py.File(path, "r+") as file:
        body = file["VTKHDF"]
        if kind == "link":
            body["taken"] = h5py.ExternalLink("../../secret.h5", "/")
        elif kind == "raw":
            size = len(SECRET)
            body.create_dataset("taken", (size,), "f8", external=[(folder.parent / "secret.bin", 0, 8 * size)])
        else:
            layout = h5py.VirtualLayout((4,), "f8")
            layout[:] = h5py.VirtualSource("../../secret.h5", "x", (4,))
            body.create_virtual_dataset("taken", layout)
    status, text, _ = ask(server, f"run?run=hdf_{kind}")
    assert status == 403
    assert "other files" in text


def test_case_with_code_does_not_go_on_from_the_browser(server: Server, folder: Path) -> None:
    made = folder / "coded"
    made.mkdir()
    for name in ("results.vtkhdf", "checkpoint.h5"):
        (made / name).write_bytes((folder / "run" / name).read_bytes())
    (made / "case.toml").write_text('analysis = "axisymmetric"\n[materials.m]\numat = "law.so"\n')
    status, text, _ = ask(server, "resume?run=coded", "POST")
    assert status == 403
    assert "code" in text
    (made / "case.toml").write_text('analysis = "axisymmetric"\n[workpiece.mesh]\npath = "../../secret.txt"\n')
    assert ask(server, "resume?run=coded", "POST")[0] == 403


def test_stop_signals_nobody_whom_a_file_names(server: Server, folder: Path) -> None:
    """progress.json may be written by anyone; without a run at work in the folder it is not believed."""
    process = os.getpid()
    (folder / "run" / "progress.json").write_text(json.dumps({"process": process, "fraction": 0, "text": ""}))
    for action in ("stop", "pause"):
        assert ask(server, f"{action}?run=run", "POST")[0] == 409
    (folder / "run" / "progress.json").unlink()


def test_requests_without_end_are_refused(server: Server) -> None:
    assert ask(server, "stop?run=run", "POST", Content_Length=str(MOST_BYTES + 1))[0] == 413
    assert ask(server, "stop?run=run", "POST", Content_Length="-5")[0] == 411
    assert ask(server, "stop?run=run", "POST", Transfer_Encoding="chunked")[0] == 411


@pytest.mark.parametrize(
    "address", ["array?run=run&what=field&step=99&of=0&field=x", "array?run=run&what=points&step=-1&of=0"]
)
def test_what_is_not_there_is_an_answer_not_a_crash(server: Server, address: str) -> None:
    status, text, _ = ask(server, address)
    assert status in (400, 404)
    assert json.loads(text)["error"]


@pytest.mark.parametrize("address", ["", "runs", "run?run=run", "sweep", "files/list.js", "nothing"])
def test_every_answer_forbids_foreign_and_inline_scripts(server: Server, address: str) -> None:
    headers: dict[str, Any] = ask(server, address)[2]
    policy = dict(rule.strip().split(" ", 1) for rule in headers["Content-Security-Policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert policy["frame-ancestors"] == "'self'"
    assert "unsafe" not in policy["script-src"]
    assert not {"*", "http:", "https:", "data:"} & set(" ".join(policy.values()).split()) - {"data:"}
    assert "data:" not in policy["script-src"]
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "no-referrer", "the token stays here"


def begin_upload(server: Server, name: str, length: int, body: bytes) -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", server.server_port), timeout=60)
    head = f"POST /{server.token}/upload?case=upsetting_q4.toml&name={name} HTTP/1.1\r\n"
    head += f"Host: 127.0.0.1:{server.server_port}\r\nContent-Length: {length}\r\n\r\n"
    connection.sendall(head.encode() + body)
    return connection


def test_uploads_that_break_off_are_refused_and_leave_nothing(server: Server, folder: Path) -> None:
    before = sorted(folder.rglob("*"))
    with begin_upload(server, "tool.csv", 100, b"0 0\n1 0\n") as connection:
        connection.shutdown(socket.SHUT_WR)
        answer = connection.makefile("rb").read()
    assert b" 400 " in answer.splitlines()[0]
    assert b"broke off" in answer
    begin_upload(server, "tool.csv", 100, b"0 0\n1 0\n").close()
    assert ask(server, "runs")[0] == 200
    assert sorted(folder.rglob("*")) == before


def test_clients_that_send_slowly_are_cut_off(server: Server, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Though no silence is long: a letter of the head, or of the body, every twentieth of a second."""
    monkeypatch.setattr("presswork.server.http._TIMEOUT", 0.5)
    monkeypatch.setattr("presswork.server.http._LONGEST", 0.5)

    def trickle(connection: socket.socket) -> None:
        for _ in range(1000):
            connection.sendall(b"0")
            time.sleep(0.05)

    head = socket.create_connection(("127.0.0.1", server.server_port), timeout=60)
    for connection in (head, begin_upload(server, "tool.csv", 1000, b"0")):
        with connection, pytest.raises(ConnectionError):
            trickle(connection)
    assert not (folder / "tool.csv").exists()


def test_hundreds_of_connections_at_once_are_answered(server: Server) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))
    try:
        connections = [socket.create_connection(("127.0.0.1", server.server_port), timeout=120) for _ in range(700)]
        request = f"GET /{server.token}/files/list.js HTTP/1.1\r\nHost: 127.0.0.1:{server.server_port}\r\n"
        for connection in connections:
            connection.sendall(f"{request}Connection: close\r\n\r\n".encode())
        for connection in connections:
            with connection, connection.makefile("rb") as answer:
                assert b" 200 " in answer.readline()
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


# --- cases that are edited -------------------------------------------------------------------------------------------


def send(server: Server, address: str, **data: object) -> tuple[int, dict[str, Any]]:
    status, text, _ = ask(server, address, "POST", body=json.dumps(data).encode())
    return status, json.loads(text)


@pytest.mark.parametrize(
    "name", ["../out", "/tmp/out", "a/../../out", "", ".hidden", "x" * 300, "a\x00b", "sub/x", "run"]
)
def test_new_case_lies_in_the_folder_under_a_plain_name(server: Server, folder: Path, name: str) -> None:
    before = {path for path in folder.parent.rglob("*") if folder not in path.parents}
    status, _, _ = ask(server, f"create?starter=cylindrical_cup&name={quote(name, safe='')}", "POST")
    assert {path for path in folder.parent.rglob("*") if folder not in path.parents} == before
    assert (status == 200) == (name == "run"), "run.toml may lie beside the folder run"
    (folder / "run.toml").unlink(missing_ok=True)


def test_starter_is_none_but_those_offered(server: Server) -> None:
    assert ask(server, "create?starter=..%2F..%2Fsecret&name=taken", "POST")[0] == 404


def test_nothing_is_saved_outside_or_as_anything_but_a_case(server: Server, folder: Path) -> None:
    for name in ("../secret.toml", "run/summary.json", "../../etc/x.toml"):
        assert send(server, f"save?case={quote(name)}", text="a = 1", before="")[0] == 403
    link = folder / "link.toml"
    link.symlink_to(folder.parent / "secret.txt")
    assert send(server, "save?case=link.toml", text="a = 1", before=SECRET)[0] == 403
    assert ask(server, "draft?case=link.toml")[0] == 403
    assert (folder.parent / "secret.txt").read_text() == SECRET
    link.unlink()


def test_case_changed_elsewhere_is_not_written_over(server: Server, folder: Path) -> None:
    (folder / "mine.toml").write_text("a = 1")
    assert send(server, "save?case=mine.toml", text="a = 3", before="a = 2")[0] == 409
    assert send(server, "save?case=mine.toml", text="a = 3", before="a = 1")[0] == 200
    assert (folder / "mine.toml").read_text() == "a = 3"
    assert send(server, "save?case=mine.toml", text="a = ", before="a = 3")[0] == 400, "no TOML"
    (folder / "mine.toml").unlink()


@pytest.mark.parametrize(
    ("name", "content", "word"),
    [
        ("part.stl", b"\x00" * 80 + b"\xff\xff\xff\xff" + b"\x00" * 500, "not an STL"),
        ("part.exe", b"MZ", "takes"),
        ("part.step", b"MZ", "not a STEP"),
        ("part.stp", b"ISO-10303-21;\x00", "not text"),
        ("law.so", b"\x7fELF", "takes"),
        ("..%2Fpart.stl", b"solid x", "name"),
        ("%2Ftmp%2Fpart.stl", b"solid x", "name"),
        ("profile.csv", b"\x00\x01\x02", "not text"),
        ("mesh.inp", b"*Node\n*INCLUDE, INPUT=/etc/passwd\n", "INCLUDE"),
        ("results.vtkhdf", b"", "takes"),
    ],
)
def test_files_that_no_case_takes_are_not_written(
    server: Server, folder: Path, name: str, content: bytes, word: str
) -> None:
    before = sorted(folder.parent.rglob("*"))
    status, text, _ = ask(server, f"upload?case=upsetting_q4.toml&name={name}", "POST", body=content)
    assert status == 400
    assert word in json.loads(text)["error"]
    assert sorted(folder.parent.rglob("*")) == before


def test_uploaded_file_lies_beside_the_case_and_replaces_none(server: Server, folder: Path) -> None:
    address = "upload?case=upsetting_q4.toml&name=tool.csv"
    assert ask(server, address, "POST", body=b"0 0\n1 0\n")[0] == 200
    assert (folder / "tool.csv").read_bytes() == b"0 0\n1 0\n"
    assert ask(server, address, "POST", body=b"0 0\n2 0\n")[0] == 409
    (folder / "tool.csv").unlink()


def test_drafts_read_nothing_outside(server: Server, folder: Path) -> None:
    text = (folder / "upsetting_q4.toml").read_text(encoding="utf-8")
    for line in ('path = "../secret.txt"', 'path = "/etc/passwd"', 'path = "out/secret.txt"'):
        head, tail = text.split("[workpiece.mesh]")
        draft = f"{head}[workpiece.mesh]\n{line}\n[was]{tail}"
        status, answer = send(server, "check?case=upsetting_q4.toml", text=draft)
        assert status == 200
        assert answer["problems"]
        assert "secret of" not in json.dumps(answer["problems"])
        assert "root:" not in json.dumps(answer)


def test_files_named_by_other_files_are_not_opened(server: Server, folder: Path) -> None:
    """A mesh that includes another, put there by other means than an upload: the process that reads it is confined."""
    (folder / "mesh.inp").write_text(f"*INCLUDE, INPUT={folder.parent}/secret.txt\n")
    text = (folder / "upsetting_q4.toml").read_text(encoding="utf-8")
    head, tail = text.split("[workpiece.mesh]")
    draft = f'{head}[workpiece.mesh]\npath = "mesh.inp"\n[was]{tail}'
    answer = send(server, "check?case=upsetting_q4.toml", text=draft)[1]
    assert answer["problems"]
    assert SECRET not in json.dumps(answer["problems"])
    (folder / "mesh.inp").unlink()


def test_code_of_a_case_is_neither_checked_nor_run(server: Server, folder: Path) -> None:
    """A library that would leave a file is named; neither check nor run opens it."""
    text = (folder / "upsetting_q4.toml").read_text(encoding="utf-8")
    head, _, tail = text.partition("[materials.steel]")
    stages = tail[tail.index("[tools") :]
    draft = f'{head}[materials.steel]\numat = "law.so"\nyoung = 1\npoisson = 0.3\nconstants = [1]\n{stages}'
    (folder / "law.so").write_bytes(b"\x7fELF, and no library")
    (folder / "coded.toml").write_text(draft)
    assert send(server, "check?case=coded.toml", text=draft)[0] == 200
    status, answer = send(server, "begin?case=coded.toml")
    assert status == 403
    assert "code" in answer["error"]
    for path in ("law.so", "coded.toml"):
        (folder / path).unlink()


@pytest.mark.parametrize(
    "deed",
    [
        "open({}/'f')",
        "os.mkdir({}/'new')",
        "os.rename({}/'f', {}/'g')",
        "os.remove({}/'f')",
        "os.symlink('x', {}/'l')",
        "os.truncate({}/'f', 0)",
        "os.remove('f', dir_fd=held)",
        "open({}/'linked'/'f', 'w')",
    ],
)
def test_confined_process_opens_and_changes_nothing_outside(tmp_path: Path, deed: str) -> None:
    for name in ("in", "out", "scratch"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "f").write_text(name)
    (tmp_path / "in" / "linked").symlink_to(tmp_path / "out")
    (tmp_path / "out" / "linked").symlink_to(tmp_path / "out")

    def look() -> dict[Path, tuple[int, int]]:
        return {path: (path.lstat().st_size, path.lstat().st_mtime_ns) for path in (tmp_path / "out").rglob("*")}

    before = look()
    for place in ("in", "out"):
        program = (
            "import os, sys, pathlib; from presswork.server.confined import confine; p = pathlib.Path(sys.argv[1])\n"
        )
        program += f"held = os.open(p / '{place}', os.O_RDONLY); confine(p / 'in', p / 'scratch')\n"
        program += deed.replace("{}", f"(p/'{place}')")
        found = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, check=False)
        assert (found.returncode == 0) == (place == "in" and "linked" not in deed), found.stderr
        assert look() == before


def test_saving_writes_through_no_link(server: Server, folder: Path) -> None:
    """Temporaries have names that nobody can guess, and a link in the place of a new file is not followed."""
    (folder / "mine.toml").write_text("a = 1")
    for name in ("mine.toml.tmp", "tool.csv.tmp", "new.toml"):
        (folder / name).symlink_to(folder.parent / f"made_by_{name}")
    assert send(server, "save?case=mine.toml", text="a = 3", before="a = 1")[0] == 200
    assert ask(server, "upload?case=mine.toml&name=tool.csv", "POST", body=b"0 0\n")[0] == 200
    assert ask(server, "create?starter=cylindrical_cup&name=new", "POST")[0] in (403, 409)
    assert not list(folder.parent.glob("made_by_*"))
    for name in ("mine.toml", "tool.csv", "mine.toml.tmp", "tool.csv.tmp", "new.toml"):
        (folder / name).unlink()


def test_a_pipe_in_the_place_of_a_file_holds_nobody(server: Server, folder: Path) -> None:
    made = folder / "piped"
    (made / "plots").mkdir(parents=True)
    (made / "results.vtkhdf").write_bytes((folder / "run" / "results.vtkhdf").read_bytes())
    for name in ("summary.json", "history.csv", "case.toml", "plots/mesh_x.png", "progress.json"):
        os.mkfifo(made / name)
    assert ask(server, "runs")[0] == 200
    for address in ("run?run=piped", "state?run=piped", "picture?run=piped", "draft?case=piped%2Fcase.toml"):
        assert ask(server, address)[0] in (200, 403, 404), address
    shutil.rmtree(made)


def test_modules_in_the_opened_folder_are_not_run(tmp_path: Path) -> None:
    """A folder from elsewhere may hold a numpy.py; processes that begin in it import the installed one."""
    (tmp_path / "numpy.py").write_text("open('taken', 'w')")
    case = copy_example("upsetting_q4", tmp_path)
    program = "import sys, pathlib; from presswork.server.site import Site; site = Site(pathlib.Path(sys.argv[1]))\n"
    program += f"print(site.drafts.check('{case.name}', pathlib.Path('{case.name}').read_text(), None).get('drawn'))\n"
    program += "site.close()"
    done = subprocess.run(
        [sys.executable, "-P", "-c", program, str(tmp_path)], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.stdout.strip() == "1", done.stderr
    assert not (tmp_path / "taken").exists()
