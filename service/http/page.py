"""The page that Vite builds into ``service/static``, or a note on how to build it."""

from __future__ import annotations

from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import FileResponse, HTMLResponse, Response
from starlette.staticfiles import StaticFiles

MISSING = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Pullfocus</title>
<h1>The page is not built</h1><p>The service runs, and its REST interface is at <code>/v1</code>
(<a href="/docs">what it offers</a>). To build the page, run <code>make setup</code> in the checkout, then reload.</p>
"""


def install_page(app: FastAPI, folder: Path) -> None:
    """Serve the page at ``/`` and its files beside it.

    Args:
        app: the application.
        folder: of the built page.
    """

    @app.get("/", include_in_schema=False)
    async def page() -> Response:
        index = folder / "index.html"
        if not index.is_file():
            return HTMLResponse(MISSING, status_code=503)
        return FileResponse(index, headers={"Cache-Control": "no-cache"})

    # The names of built files contain a hash of their content.
    app.mount("/assets", StaticFiles(directory=folder / "assets", check_dir=False), name="assets")
    for file in sorted(folder.glob("*")) if folder.is_dir() else ():
        if file.is_file() and file.name != "index.html":
            _install_file(app, file)


def _install_file(app: FastAPI, file: Path) -> None:
    @app.get(f"/{file.name}", include_in_schema=False)
    async def serve() -> FileResponse:
        return FileResponse(file)
