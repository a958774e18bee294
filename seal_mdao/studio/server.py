"""Local server of the live section: pages, their web sockets, files.

It listens on 127.0.0.1 and answers under an address with a random token only, for its own host and
origin. Every page has a bounded queue in which newer pictures replace older ones.
"""

import asyncio
import hmac
import json
import secrets

from tornado.httpserver import HTTPServer
from tornado.iostream import StreamClosedError
from tornado.netutil import bind_sockets
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from seal_mdao.studio.assets_of import ASSETS, asset
from seal_mdao.studio.problem_form import write_drawing
from seal_mdao.studio.project import Project, ProjectError
from seal_mdao.studio.session import RequestError, Session

ADDRESS = "127.0.0.1"
MOST_PAGES = 8
"""Pages that may be open at once."""
MOST_MESSAGES = 500
"""Messages of a page that are followed in a second; of more the last one is followed afterwards."""
MESSAGE_SIZE = 64 * 1024
"""Largest message, bytes."""
DRAWING_SIZE = 4 * 2**20
"""Largest drawing, bytes."""
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: "
    "blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'self' "
    "http://127.0.0.1:* http://localhost:*"
)
"""Nothing is loaded from elsewhere; notebooks of this machine may show the page in a frame."""


class Studio:
    """The server with its session.

    Parameters
    ----------
    project : Project
    port : int
        0 for any that is free.

    Attributes
    ----------
    token : str
    address : str
        To open in a browser.
    """

    def __init__(self, project: Project, port: int = 0):
        self.project, self.token = project, secrets.token_urlsafe(24)
        self.pages: set[Live] = set()
        self.session = Session(project, self.broadcast)
        (socket,) = bind_sockets(port, ADDRESS)
        self.port = socket.getsockname()[1]
        self.hosts = {f"{name}:{self.port}" for name in (ADDRESS, "localhost")}
        shared = {"studio": self}
        self._server = HTTPServer(
            Application(
                [
                    (r"/([^/]*)/live", Live, shared),
                    (r"/([^/]*)/drawing", Drawings, shared),
                    (r"/([^/]*)/files/([^/]*)", Files, shared),
                    (r"/([^/]*)/([a-z.]*)", Parts, shared),
                    (r".*", Nothing, shared),
                ],
                websocket_max_message_size=MESSAGE_SIZE, log_function=lambda handler: None,
            ),
            max_body_size=DRAWING_SIZE, max_buffer_size=DRAWING_SIZE + 2**16,
        )  # fmt: skip
        self._server.add_sockets([socket])
        self.address = f"http://{ADDRESS}:{self.port}/{self.token}/"

    def broadcast(self, kind: str, content) -> None:
        """Send a message to all pages."""
        text = json.dumps({"kind": kind, "content": content}, allow_nan=False)
        for page in self.pages:
            if kind == "design":
                page.send_design()
            else:
                page.send(kind, text)

    def end(self) -> None:
        """Close all pages, the server and the worker."""
        self._server.stop()
        for page in list(self.pages):
            page.close()
        self.session.end()


class Guarded(RequestHandler):
    """Handler that accepts requests with the right host, origin and token only."""

    def initialize(self, studio: Studio) -> None:
        self.studio = studio

    def set_default_headers(self) -> None:
        self.set_header("Content-Security-Policy", POLICY)
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Cache-Control", "no-store")
        self.clear_header("Server")

    def prepare(self) -> None:
        if self.request.method == "POST" and self.request.headers.get("Origin") is None:
            raise HTTPError(403)
        request, hosts = self.request, self.studio.hosts
        # a name that leads to this machine could be of another site (DNS rebinding)
        if request.headers.get("Host") not in hosts:
            raise HTTPError(403)
        origin = request.headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}" for host in hosts}:
            raise HTTPError(403)
        given = (self.path_args or [""])[0]
        if not hmac.compare_digest(given.encode(), self.studio.token.encode()):
            raise HTTPError(403)

    def write_error(self, status_code: int, **more) -> None:
        self.finish(
            f"{status_code}: not available; open the address that seal-mdao studio printed\n"
        )


class Nothing(Guarded):
    """Handler of all other addresses."""

    def get(self) -> None:
        raise HTTPError(404)


class Parts(Guarded):
    """Handler of the page and its parts."""

    def get(self, token: str, name: str) -> None:
        if name and name not in ASSETS:
            raise HTTPError(404)
        kind = ASSETS[name][1] if name else "text/html"
        self.set_header("Content-Type", f"{kind}; charset=utf-8")
        self.finish(asset(name or "studio.html"))


class Files(Guarded):
    """Handler that downloads files of the project."""

    def get(self, token: str, name: str) -> None:
        try:
            path = self.studio.project.path(name)
            content = path.read_bytes()
        except (ProjectError, OSError) as error:
            raise HTTPError(404) from error
        self.set_header("Content-Type", "application/octet-stream")
        self.set_header("Content-Disposition", f'attachment; filename="{path.name}"')
        self.finish(content)


class Drawings(Guarded):
    """Handler of drawings that are dropped on the page."""

    async def post(self, token: str) -> None:
        name, content = self.get_query_argument("name", ""), self.request.body
        project = self.studio.project
        try:
            # read beside the event loop: a drawing may be large
            made, remark = await asyncio.to_thread(write_drawing, project, name, content)
        except (ValueError, ImportError) as error:
            self.set_status(400)
            self.finish(" ".join(str(error).split()).replace(f"{project.folder}/", ""))
            return
        self.studio.session.open(made)
        self.finish(remark or f"{made} was written")


class Live(Guarded, WebSocketHandler):
    """Handler of the web socket of a page."""

    def open(self, token: str) -> None:
        self._queue: dict[str, str] = {}
        self._filled, self._second, self._count = asyncio.Event(), 0, 0
        self._late: str | None = None
        # number of the last change of this page that was followed
        self._change = 0
        if len(self.studio.pages) >= MOST_PAGES:
            self.close(
                1013,
                f"{MOST_PAGES} browser pages of seal-mdao studio are already open; "
                "close one of them",
            )
            return
        self.set_nodelay(True)
        self.studio.pages.add(self)
        self._sender = asyncio.create_task(self._send_all())
        self._greet()

    def check_origin(self, origin: str) -> bool:
        # ``prepare`` has checked it
        return True

    def _greet(self) -> None:
        """Send all that there is to a new page."""
        session = self.studio.session
        known = {"status": session.status(), "scene": session.scene, "kept": session.kept}
        known["errors"] = session.errors
        for kind, content in (known | session.last).items():
            if content is not None:
                self.send(kind, json.dumps({"kind": kind, "content": content}))
        if session.scene is not None:
            self.send_design()

    def send_design(self) -> None:
        """Send the design with the number of the last change of this page that it follows: the page
        ignores one that is older than what it shows."""
        content = {"design": self.studio.session.design, "change": self._change}
        self.send("design", json.dumps({"kind": "design", "content": content}))

    def send(self, kind: str, text: str) -> None:
        """Queue a message; it replaces one of the same kind that was not sent yet."""
        if kind in ("scene", "exact", "view"):
            # first-order changes belong to the picture before
            self._queue.pop("rates", None)
        self._queue.pop(kind, None)
        self._queue[kind] = text
        self._filled.set()

    async def _send_all(self) -> None:
        try:
            while True:
                await self._filled.wait()
                self._filled.clear()
                while self._queue:
                    kind = next(iter(self._queue))
                    # waits while the page does not read: the queue stays bounded
                    await self.write_message(self._queue.pop(kind))
        except (WebSocketClosedError, StreamClosedError):
            pass

    def on_message(self, text) -> None:
        loop = asyncio.get_running_loop()
        if int(loop.time()) != self._second:
            self._second, self._count = int(loop.time()), 0
        self._count += 1
        if self._count > MOST_MESSAGES:
            if self._late is None:
                loop.call_at(self._second + 1.0, self._follow_late)
            self._late = text
            return
        self._follow(text)

    def _follow_late(self) -> None:
        text, self._late = self._late, None
        if self in self.studio.pages:
            self._follow(text)

    def _follow(self, text) -> None:
        try:
            message = json.loads(text)
            if isinstance(message, dict) and isinstance(message.get("change"), int):
                self._change = message["change"]
            self.studio.session.handle(message)
            if self.studio.session.scene is not None:
                self.send_design()
        except (RequestError, ProjectError) as error:
            self.send("refused", json.dumps({"kind": "refused", "content": str(error)}))
        except ValueError:
            self.send("refused", json.dumps({"kind": "refused", "content": "no message"}))

    def on_close(self) -> None:
        self.studio.pages.discard(self)
        if hasattr(self, "_sender"):
            self._sender.cancel()
