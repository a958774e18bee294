"""The page in a notebook."""

import asyncio

import pytest
from studio.small_seal import write

pytest.importorskip("tornado")
from seal_mdao.studio.notebook import show
from seal_mdao.studio.project import ProjectError


def test_frame_has_the_address_and_opens_the_file(tmp_path):
    path = write(tmp_path)

    async def cell():
        frame = show(path, 700)
        try:
            shown = frame._repr_html_()
            assert shown.startswith("<iframe ")
            assert f'src="{frame.studio.address}"' in shown
            assert 'height="700"' in shown
            while frame.studio.session.scene is None:
                assert not frame.studio.session.failure
                await asyncio.sleep(0.1)
            assert frame.studio.session.file == "bulb.toml"
        finally:
            frame.close()

    asyncio.run(asyncio.wait_for(cell(), 200.0))


def test_outside_of_a_notebook_it_says_what_to_do(tmp_path):
    with pytest.raises(RuntimeError, match="in a terminal use the command seal-mdao studio"):
        show(write(tmp_path))


def test_a_wrong_file_is_refused_before_the_server_starts(tmp_path):
    async def cell():
        with pytest.raises(ProjectError):
            show(tmp_path / "bulb.py")

    asyncio.run(cell())
