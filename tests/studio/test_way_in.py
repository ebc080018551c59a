"""Way of the browser to the studio: a file of this user alone, since everybody can read the words of a command."""

from __future__ import annotations

import re
import threading
import urllib.request
import webbrowser
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from fingertip.studio import server as server_module
from tests.conftest import run_fingertip


def test_the_browser_gets_the_token_from_a_private_file_that_is_gone_when_used(monkeypatch: pytest.MonkeyPatch) -> None:
    servers: list[server_module.StudioServer] = []
    opened: dict[str, object] = {}

    class Recorded(server_module.StudioServer):
        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments)  # type: ignore[arg-type]
            servers.append(self)

    def browse(address: str) -> bool:
        path = Path(urlsplit(address).path)
        opened.update(address=address, text=path.read_text(), folder=path.parent)
        opened["modes"] = [oct(place.stat().st_mode & 0o777) for place in (path, path.parent)]

        def follow() -> None:
            found = re.search(r'http-equiv="refresh" content="0; url=(.*?)"', str(opened["text"]))
            assert found
            with urllib.request.urlopen(found[1], timeout=20) as page:
                opened["page"] = page.read()
            opened["left"] = path.exists()
            servers[0].shutdown()

        threading.Thread(target=follow).start()
        return True

    monkeypatch.setattr(server_module, "render_studio", lambda design, token: b"page")
    monkeypatch.setattr(server_module, "StudioServer", Recorded)
    monkeypatch.setattr(webbrowser, "open", browse)
    done = run_fingertip("studio", "--port", "0")
    assert done.returncode == 0
    assert done.stdout == f"studio: {servers[0].url}\n"
    assert str(opened["address"]).startswith("file:///")
    assert servers[0].token not in str(opened["address"])
    assert opened["modes"] == ["0o600", "0o700"]
    assert '<meta name="referrer" content="no-referrer">' in str(opened["text"])
    assert (opened["page"], opened["left"]) == (b"page", False)
    assert not Path(str(opened["folder"])).exists()
