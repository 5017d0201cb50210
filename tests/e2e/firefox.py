"""Firefox on a display of its own, driven by Mozilla's Marionette, and readings from its page."""

from __future__ import annotations

import base64
import io
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from marionette_driver import By, Wait
from marionette_driver.marionette import Marionette
from numpy.typing import NDArray
from PIL import Image

# As in conftest.py: a small page, half a pixel of the device to each of its own, and patience.
WIDTH, HEIGHT, PIXEL_RATIO = 900, 560, 0.5
PATIENCE_S = 240

ERRORS = """
    const [service] = arguments;
    const isOurs = said => said.category.startsWith("CSP") ||
        !(said.flags & said.warningFlag) && (said.category === "content javascript" || said.sourceName.startsWith(service));
    const errors = Services.console.getMessageArray().filter(said => said instanceof Ci.nsIScriptError && isOurs(said));
    return errors.map(error => `${error.sourceName}: ${error.errorMessage}`);
"""


def find_firefox() -> str:
    """Find a Firefox that Marionette can drive; skip the test where there is none."""
    path = shutil.which("firefox-esr") or shutil.which("firefox")
    if path is None:
        pytest.skip("firefox is not installed")
    with open(path, "rb") as file:
        is_snap = Path(path).resolve().name == "snap" or b"/snap/" in file.read(4096)
    if is_snap:
        pytest.skip("this firefox is a snap, which does not see the profile in our temporary folder")
    return path


@contextmanager
def display() -> Iterator[str]:
    """Run an X server without a screen, since Firefox has no WebGL without a display; yield its name."""
    server = shutil.which("Xvfb")
    if server is None:
        pytest.skip("Xvfb is not installed, and firefox has no WebGL without a display")
    command = [server, "-displayfd", "1", "-screen", "0", "1280x1024x24"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        try:
            number = process.stdout.readline().strip()
            assert number, "Xvfb did not start"
            yield f":{number}"
        finally:
            process.terminate()


class Firefox:
    """A Firefox with one page, which looks at one service."""

    def __init__(self, marionette: Marionette, service: str) -> None:
        self._marionette = marionette
        self._service = service

    @classmethod
    @contextmanager
    def started(cls, service: str, folder: Path) -> Iterator[Firefox]:
        """Start Firefox with a fresh profile in a folder, and end it."""
        path = find_firefox()
        with display() as name:
            with pytest.MonkeyPatch.context() as environment:
                environment.setenv("DISPLAY", name)
                environment.setenv("MOZ_ENABLE_WAYLAND", "0")
                marionette = Marionette(
                    app="fxdesktop",
                    bin=path,
                    port=0,
                    startup_timeout=PATIENCE_S,
                    workspace=str(folder),
                    gecko_log=str(folder / "firefox.log"),
                    prefs={"layout.css.devPixelsPerPx": str(PIXEL_RATIO)},
                )
            try:
                marionette.start_session()
                marionette.timeout.script = PATIENCE_S
                frame = marionette.execute_script("return [outerWidth - innerWidth, outerHeight - innerHeight]")
                marionette.set_window_rect(x=0, y=0, width=WIDTH + frame[0], height=HEIGHT + frame[1])
                yield cls(marionette, service)
            finally:
                profiles = [marionette.instance.profile]
                marionette.cleanup()
                profiles.append(marionette.instance.profile)  # cleanup makes a new one
                for profile in profiles:
                    profile.restore = False  # else it is removed once more when Python ends, which then fails

    def open(self, path: str) -> None:
        """Load a page of the service."""
        self._marionette.navigate(f"{self._service}{path}")

    def read(self, script: str, *arguments: Any) -> Any:
        """Return what a script returns."""
        return self._marionette.execute_script(script, arguments)

    def read_later(self, script: str, *arguments: Any) -> Any:
        """Return what a script gives to the function that is its last argument."""
        return self._marionette.execute_async_script(script, arguments)

    def until(self, condition: Callable[[], Any], wanted: str) -> Any:
        """Wait until a condition is met, and return what it returns."""
        return Wait(self._marionette, timeout=PATIENCE_S).until(lambda _: condition(), message=wanted)

    def wait(self, script: str, *arguments: Any) -> Any:
        """Wait until a script returns something that is true, and return it."""
        return self.until(lambda: self.read(script, *arguments), f"{script} {arguments}")

    def wait_for(self, selector: str) -> Any:
        """Wait for an element, and return it."""
        return self.wait("return document.querySelector(arguments[0])", selector)

    def wait_settled(self, time: float) -> None:
        """Wait until the best picture of a frame is on screen."""
        self.wait_for(f'canvas[data-settled=true][data-time="{time:g}"]')

    def revision(self) -> int:
        """Return the number of edits that the picture on screen includes."""
        return int(self.read("return document.querySelector('canvas').dataset.revision"))

    def wait_edited(self, revision: int) -> int:
        """Wait until the best picture after an edit is on screen, and return its revision."""
        script = "return document.querySelector('canvas[data-settled=true]')?.dataset.revision > arguments[0]"
        self.wait(script, revision)
        return self.revision()

    def box(self, label: str) -> Any:
        """Return the box with a label that one types in."""
        return self.wait_for(f"input[type=text][aria-label={label}]")

    def value(self, label: str) -> str:
        """Return the text of a box."""
        return str(self.box(label).get_property("value"))

    def wait_value(self, label: str, text: str) -> None:
        """Wait until a box has a text."""
        self.until(lambda: self.value(label) == text, f"{label}: {text}")

    def picture(self, selector: str = "canvas") -> NDArray[np.uint8]:
        """Return what a canvas shows, ``(height, width, 4)``."""
        self.wait_for(selector)
        address = self.read("return document.querySelector(arguments[0]).toDataURL()", selector)
        return np.asarray(Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGBA"))

    def press(self, *keys: str) -> None:
        """Press keys together."""
        actions = self._marionette.actions.sequence("key", "keyboard")
        for key in keys:
            actions.key_down(key)
        for key in reversed(keys):
            actions.key_up(key)
        actions.perform()

    def press_button(self, name: str) -> None:
        """Press a button by its text."""
        path = f'//button[normalize-space()="{name}"]'
        self.until(lambda: self._marionette.find_elements(By.XPATH, path), path)[0].click()

    def drag(self, *way: tuple[float, float]) -> None:
        """Drag the mouse along a way, in pixels of the page; a way of one place is a click."""
        actions = self._marionette.actions.sequence("pointer", "mouse", {"pointerType": "mouse"})
        for count, (x, y) in enumerate(way):
            actions.pointer_move(round(x), round(y))
            if count == 0:
                actions.pointer_down()
        actions.pointer_up().perform()

    def errors(self) -> list[str]:
        """Return the errors of the page: those that it did not catch, and what its security policy stopped."""
        with self._marionette.using_context("chrome"):
            errors: list[str] = self.read(ERRORS, self._service)
            return errors

    def forget(self) -> None:
        """Forget the errors, and all that the page remembers in the browser."""
        self.read("localStorage.clear(); sessionStorage.clear()")
        with self._marionette.using_context("chrome"):
            self.read("Services.console.reset()")
