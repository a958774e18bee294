"""The server answers to its own pages alone, and its queues stay bounded."""

import asyncio
import json
import tracemalloc

import pytest

pytest.importorskip("tornado")
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from seal_mdao.studio import server
from seal_mdao.studio.project import Project
from seal_mdao.studio.server import Studio

SCENE = {
    "numbers": [{"name": "a", "low": -1.0, "high": 1.0, "value": 0.0}], "handles": [],
    "steps": 5, "minimize": None,
}  # fmt: skip

UPGRADE = {
    "Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}  # fmt: skip
"""Headers that open a web socket."""


def with_studio(folder, work):
    """Run ``work(studio)`` with a server whose worker is never started."""

    async def run():
        studio = Studio(Project(folder))
        studio.session._want = lambda: None
        studio.sockets = []
        try:
            await asyncio.wait_for(work(studio), 60.0)
        finally:
            for socket in studio.sockets:
                socket.close()
            for socket in list(studio.sockets):
                await ended(studio, socket)
            while studio.pages:
                await asyncio.sleep(0.01)
            studio.end()
            # both ends close their sockets
            await asyncio.sleep(0.1)

    asyncio.run(run())


def opened(studio):
    session = studio.session
    session.scene, session.design, session._history = SCENE, [0.0], [[0.0]]
    return session


async def status(url, **more):
    """Status of the answer to a request."""
    try:
        found = await AsyncHTTPClient().fetch(HTTPRequest(url, **more))
    except HTTPClientError as error:
        return error.code
    return found.code


def test_page_and_its_parts_come_from_this_server(tmp_path):
    async def work(studio):
        assert studio.address.startswith("http://127.0.0.1:")
        page = await AsyncHTTPClient().fetch(studio.address)
        assert "default-src 'none'" in page.headers["Content-Security-Policy"]
        assert "http" not in page.body.decode().replace("http-equiv", "")
        for name in server.ASSETS:
            assert await status(studio.address + name) == 200
        assert await status(studio.address + "other.js") == 404

    with_studio(tmp_path, work)


def test_wrong_token_host_and_origin_are_refused(tmp_path):
    async def work(studio):
        base = f"http://127.0.0.1:{studio.port}"
        assert len(studio.token) >= 32
        for path in ("/", "/wrong/", f"/{studio.token[:-1]}/", f"//{studio.token}/", "/wrong/live"):
            assert await status(base + path) == 403
        for host in ("evil.example", f"evil.example:{studio.port}", "127.0.0.1", ""):
            assert await status(studio.address, headers={"Host": host}) in (400, 403)
        for origin in ("http://evil.example", "null", f"http://127.0.0.1:{studio.port + 1}"):
            assert await status(studio.address, headers={"Origin": origin}) == 403
            assert (
                await status(f"{studio.address}live", headers=UPGRADE | {"Origin": origin}) == 403
            )
        good = {"Origin": base}
        assert await status(studio.address, headers=good) == 200
        assert await status(f"{base}/wrong/live", headers=UPGRADE | good) == 403

    with_studio(tmp_path, work)


def test_files_of_other_folders_are_not_given(tmp_path):
    folder = tmp_path / "project"
    folder.mkdir()
    (tmp_path / "secret.toml").write_text("secret")
    (folder / "bulb.toml").write_text("mine")

    async def work(studio):
        for name in ("bulb.toml",):
            assert await status(f"{studio.address}files/{name}") == 200
        for name in (
            "../secret.toml", "..%2fsecret.toml", "%2e%2e%2fsecret.toml", "%2fetc%2fpasswd",
            "..%5csecret.toml", "none.toml", "",
        ):  # fmt: skip
            assert await status(f"{studio.address}files/{name}") in (403, 404)

    with_studio(folder, work)


def live(studio):
    return studio.address.replace("http", "ws") + "live"


async def connected(studio):
    """A page, as a web socket that is closed at the end."""
    studio.sockets.append(await websocket_connect(live(studio)))
    return studio.sockets[-1]


async def ended(studio, socket):
    """Read a page to its end."""
    while await socket.read_message() is not None:
        pass
    # or Tornado warns of a connection that was not closed at this end
    socket.close()
    studio.sockets.remove(socket)


async def told(socket, kind):
    """The next message of a kind."""
    while True:
        message = json.loads(await socket.read_message())
        if message["kind"] == kind:
            return message["content"]


def test_messages_that_cannot_be_followed_change_nothing(tmp_path):
    wrong = (
        "no JSON", "[]", "3", '{"do": "format"}', '{"do": ["drag"]}', '{"do": "drag"}',
        '{"do": "drag", "design": [1, 2]}', '{"do": "drag", "design": ["0"]}',
        '{"do": "drag", "design": [NaN]}', '{"do": "drag", "design": [true]}',
        '{"do": "drag", "design": [1e999]}', '{"do": "view", "step": -1}',
        '{"do": "open", "file": "../secret.toml"}', '{"do": "save", "name": "../out"}',
        '{"do": "take", "name": "Z"}', '{"do": "improve"}', '{"do": "keep"}',
    )  # fmt: skip

    async def work(studio):
        session = opened(studio)
        socket = await connected(studio)
        for text in wrong:
            await socket.write_message(text)
            assert await told(socket, "refused")
            assert session.design == [0.0]
            assert session.job is None
        # beyond the range: the nearest value within it
        await socket.write_message('{"do": "commit", "design": [7]}')
        await told(socket, "status")
        assert session.design == [1.0]

    with_studio(tmp_path, work)
    assert list(tmp_path.iterdir()) == []


def test_ten_thousand_messages_in_a_second_leave_memory_and_queues_bounded(tmp_path):
    async def work(studio):
        session = opened(studio)
        sockets = [await connected(studio) for _ in range(2)]
        # the second page never reads what it is sent
        await told(sockets[0], "status")
        tracemalloc.start()
        before, _ = tracemalloc.get_traced_memory()
        for k in range(10_000):
            design = json.dumps({"do": "commit", "design": [k / 20_000]})
            await sockets[0].write_message(design)
            if k % 500 == 0:
                await asyncio.sleep(0)
        # the last one is followed when the second is over
        while session.design != [9_999 / 20_000]:
            await asyncio.sleep(0.05)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert len(session._history) <= 200
        for page in studio.pages:
            assert len(page._queue) <= 12
        # 10,000 messages of 50 bytes on their way, and pages with a few kinds of messages each
        assert most - before < 20 * 2**20
        await sockets[0].write_message('{"do": "undo"}')
        await told(sockets[0], "design")

    with_studio(tmp_path, work)


def test_messages_beyond_the_size_close_the_page_alone(tmp_path):
    async def work(studio):
        opened(studio)
        first, second = [await connected(studio) for _ in range(2)]
        await first.write_message("x" * (server.MESSAGE_SIZE + 1))
        await ended(studio, first)
        await second.write_message('{"do": "commit", "design": [0.5]}')
        while (await told(second, "status"))["undo"] is False:
            pass

    with_studio(tmp_path, work)


def test_pages_beyond_the_largest_number_are_closed(tmp_path):
    async def work(studio):
        sockets = [await connected(studio) for _ in range(server.MOST_PAGES)]
        for socket in sockets:
            await told(socket, "status")
        more = await connected(studio)
        await ended(studio, more)
        assert "browser pages of seal-mdao studio are already open" in more.close_reason

    with_studio(tmp_path, work)
