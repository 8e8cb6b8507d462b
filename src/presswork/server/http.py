# SPDX-License-Identifier: Apache-2.0
"""HTTP for one person on this machine: who asks without the token, or under another name, is turned away.

The standard library's server, a thread a connection, suffices: there is one page that asks once a second, and what it
asks for takes longer to read from results than to send.
"""

from __future__ import annotations

import hmac
import io
import json
import math
import secrets
import socket
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from time import monotonic
from typing import Any
from urllib.parse import parse_qs, urlsplit

from presswork.results import OutputError
from presswork.server.opened_folder import RefusedError

MOST_BYTES = 64_000_000
"""Bytes of a request's body, at most."""
POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
POLICY += "frame-src 'self'; base-uri 'none'; form-action 'none'"
_TIMEOUT = 30.0
"""Seconds that a connection may be silent, and that the head of a request may take to arrive."""
_LONGEST = 300.0
"""Seconds that the body of a request may take to arrive."""
_MOST_CONNECTIONS = 500
"""Threads, at most; further connections wait in the operating system's queue."""
_PIECE = 1 << 20
"""Bytes of an answer that must be taken within the seconds of silence."""


@dataclass(frozen=True)
class Request:
    """What is asked: the last part of the address, its query, the body."""

    method: str
    name: str
    query: dict[str, list[str]]
    body: bytes = b""

    def get(self, key: str, default: str | None = None) -> str:
        """Return a value of the query, the last of several. Raises RefusedError if there is none."""
        if key in self.query:
            return self.query[key][-1]
        if default is None:
            raise RefusedError(f"the address lacks {key}=")
        return default

    def get_number(self, key: str) -> int:
        """Return a whole number of the query. Raises RefusedError."""
        text = self.get(key)
        if not (text.isascii() and text.isdigit() and len(text) < 10):
            raise RefusedError(f"{key} is not a number")
        return int(text)

    def get_json(self) -> dict[str, Any]:
        """Return the body as a table. Raises RefusedError."""
        try:
            data = json.loads(self.body, parse_constant=_read_number, parse_float=_read_number, parse_int=_read_whole)
            json.dumps(data, ensure_ascii=False).encode()  # half of a surrogate pair is no text
        except (ValueError, RecursionError) as error:
            raise RefusedError("the request is not JSON of finite numbers and text in UTF-8") from error
        if not isinstance(data, dict):
            raise RefusedError("the request is not a table")
        return data


def _read_number(text: str) -> float:
    """Return a number of JSON. Raises ValueError for one that is not finite."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is not finite")
    return number


def _read_whole(text: str) -> int:
    """Return a whole number of JSON. Raises ValueError for one of more than 64 bits, as in TOML."""
    number = int(text)
    if number.bit_length() > 63:
        raise ValueError("a whole number of more than 64 bits")
    return number


@dataclass(frozen=True)
class Response:
    """An answer."""

    content: bytes
    kind: str = "application/json"
    policy: str = POLICY


def answer_json(data: object) -> Response:
    """Return data as an answer."""
    return Response(json.dumps(data, ensure_ascii=False, allow_nan=False, default=str).encode())


Answer = Callable[[Request], Response]


class Server(ThreadingHTTPServer):
    """A server on the loopback address; `address` leads to it, with the token that it asks for."""

    daemon_threads = True
    request_queue_size = 1024

    def __init__(self, answer: Answer, port: int = 0) -> None:
        self.answer = answer
        self.token = secrets.token_urlsafe(24)
        self._free = threading.BoundedSemaphore(_MOST_CONNECTIONS)
        super().__init__(("127.0.0.1", port), _Handler)

    @property
    def address(self) -> str:
        """The address of its first page."""
        return f"http://127.0.0.1:{self.server_port}/{self.token}/"

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a connection in a thread of its own, once one is free."""
        self._free.acquire()
        try:
            super().process_request(request, client_address)
        except BaseException:
            self._free.release()
            raise

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer a connection."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Pass over connections that broke off: the page was closed."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _Arriving(io.RawIOBase):
    """What a connection sends, until a moment by which it must have come."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self.end = monotonic() + _TIMEOUT

    def readable(self) -> bool:
        """Return True."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Read what has come. Raises TimeoutError."""
        left = self.end - monotonic()
        if left <= 0.0:
            raise TimeoutError("the request takes too long")
        self._connection.settimeout(min(left, _TIMEOUT))
        try:
            return self._connection.recv_into(buffer)
        finally:
            self._connection.settimeout(_TIMEOUT)


class _Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: Server
    protocol_version = "HTTP/1.1"
    server_version = "presswork"
    sys_version = ""
    timeout = _TIMEOUT

    def setup(self) -> None:
        """Read from the connection with an end."""
        super().setup()
        self.rfile.close()
        self._arriving = _Arriving(self.connection)
        self.rfile = io.BufferedReader(self._arriving)

    def handle_one_request(self) -> None:
        """Wait for a request and answer it."""
        self._arriving.end = monotonic() + _TIMEOUT
        super().handle_one_request()

    def do_GET(self) -> None:
        """Answer a question."""
        self._serve("GET")

    def do_POST(self) -> None:
        """Do what is asked."""
        self._serve("POST")

    def _serve(self, method: str) -> None:
        status = 200
        try:
            response = self.server.answer(self._admit(method))
        except RefusedError as error:
            status, response = error.status, answer_json({"error": str(error)})
            self.close_connection = True
        except OutputError as error:
            status, response = 404, answer_json({"error": str(error)})
        except Exception:  # a fault of ours, or of a file that nobody foresaw: its words would help nobody
            status, response = 500, answer_json({"error": "the program cannot answer this; look at the files it names"})
            self.close_connection = True
        self._send(status, response)

    def _admit(self, method: str) -> Request:
        """Return the request if it may be answered. Raises RefusedError."""
        port = self.server.server_port
        hosts = (f"127.0.0.1:{port}", f"localhost:{port}")
        if self.headers.get("Host") not in hosts:  # a page elsewhere whose name leads to this machine
            raise RefusedError("this server answers to its own address only", 403)
        origin = self.headers.get("Origin")
        if origin is not None and origin not in [f"http://{host}" for host in hosts]:
            raise RefusedError("this server answers to its own pages only", 403)
        try:
            address = urlsplit(self.path)
            query = parse_qs(address.query, max_num_fields=100)
        except ValueError:
            raise RefusedError("this is not an address") from None
        token, *rest = address.path.removeprefix("/").split("/", 1)
        if not hmac.compare_digest(token.encode(), self.server.token.encode()):
            raise RefusedError("the address lacks the token", 403)
        body = self._read_body() if method == "POST" else b""
        return Request(method, rest[0] if rest else "", query, body)

    def _read_body(self) -> bytes:
        text = self.headers.get("Content-Length", "0")
        if not (text.isascii() and text.isdigit() and len(text) < 20) or self.headers.get("Transfer-Encoding"):
            raise RefusedError("the length of the request is not known", 411)
        if int(text) > MOST_BYTES:
            raise RefusedError(f"the request is larger than {MOST_BYTES / 1e6:.0f} MB", 413)
        self._arriving.end = monotonic() + _LONGEST
        try:
            body = self.rfile.read(int(text))
        except OSError as error:
            raise RefusedError("the request did not arrive in time", 408) from error
        if len(body) != int(text):
            raise RefusedError("the request broke off before its end")
        return body

    def _send(self, status: int, response: Response) -> None:
        self.send_response(status)
        for name, value in {
            "Content-Type": f"{response.kind}; charset=utf-8" if "image" not in response.kind else response.kind,
            "Content-Length": str(len(response.content)),
            "Content-Security-Policy": f"{response.policy}; frame-ancestors 'self'",
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Cache-Control": "no-store",
        }.items():
            self.send_header(name, value)
        self.end_headers()
        for start in range(0, len(response.content), _PIECE):
            self.wfile.write(response.content[start : start + _PIECE])

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing: the terminal is the user's."""
