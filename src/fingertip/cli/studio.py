"""Command `fingertip studio`: a local page with a form, whose parts follow each change."""

from __future__ import annotations

from typing import Annotated

import typer

from fingertip.cli.console import Console
from fingertip.cli.options import OptionalDesignArgument, SetOption, command, load_design

DEFAULT_PORT = 8350
"""Port at which the page is served unless another one is named."""


@command
def studio(
    console: Console,
    design: OptionalDesignArgument = None,
    port: Annotated[
        int | None, typer.Option(metavar="N", help=f"Port to listen on; {DEFAULT_PORT} by default, 0 for any free one.")
    ] = None,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Print the address and open no browser.")] = False,
    changes: SetOption = None,
) -> None:
    """Serve a page on this machine where sliders change a design: its parts and checks follow, files are downloaded."""
    import contextlib
    import webbrowser

    from fingertip.foundation.files import TemporaryFolder
    from fingertip.foundation.interruption import INTERRUPTIONS
    from fingertip.studio.server import StudioServer

    loaded = load_design(design, changes, console)
    with StudioServer(loaded, DEFAULT_PORT if port is None else port) as server:
        with contextlib.suppress(*INTERRUPTIONS):  # the way to end it, no failure
            console.result({"url": server.url, "port": server.server_port}, f"studio: {server.url}")
            console.progress("Ctrl-C ends it")
            with contextlib.ExitStack() as stack:
                if not no_browser:
                    way_in = server.write_way_in(stack.enter_context(TemporaryFolder()))
                    if not webbrowser.open(way_in.as_uri()):
                        console.progress("no browser was found; open the address above in one of this machine")
                server.serve_forever()
        console.progress("studio ended")
