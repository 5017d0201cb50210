"""States of the page that pictures are taken of and that axe-core looks at."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import Page, expect


def show_camera(page: Page) -> None:
    """Show the settings of camera and film."""
    page.keyboard.press("c")
    page.get_by_role("heading", name="Exposure").wait_for()


def show_commands(page: Page) -> None:
    """Open the list of all commands, with something typed."""
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="Search in all commands").fill("key")


def show_sharpness(page: Page) -> None:
    """Select a point, and colour what is sharp."""
    page.keyboard.press("]")
    page.keyboard.press("Shift+Digit3")
    page.locator(".focus-legend .bar").wait_for()
    page.locator(".aim").focus()
    page.keyboard.press("Shift+ArrowRight")
    page.locator(".probe").wait_for()


def show_curve(page: Page) -> None:
    """Show the curve of a weight, with a key selected."""
    page.keyboard.press("t")
    page.locator(".knot").nth(1).click()
    page.locator(".handle").first.wait_for()


def show_groups(page: Page) -> None:
    """Give both points a colour and a group, which `take` undoes, and select the first one."""
    for name, color in (("pip", "teal"), ("mara", "orange")):
        point = page.locator(".point").filter(has=page.get_by_role("button", name=f"Remove {name}"))
        point.locator(".point-name").click()
        point.get_by_role("radio", name=color).click()
        wait_undoable(page, f"Colour {name} {color}")
        point.get_by_label("Group").fill("cast")
        point.get_by_label("Group").press("Enter")
        wait_undoable(page, f"Put {name} in cast")
    page.locator(".point-group").scroll_into_view_if_needed()


def wait_undoable(page: Page, label: str) -> None:
    """Wait until an edit is the last one; a phone has no button for it that is shown."""
    page.locator(f'button[aria-label="Undo: {label}"]').wait_for(state="attached")


def show_lenses(page: Page) -> None:
    """Look for a lens."""
    box = page.get_by_role("combobox", name="Lens on the camera")
    box.scroll_into_view_if_needed()
    box.click()
    box.press_sequentially("planar")


def show_exposure(page: Page) -> None:
    """Show the false colour of exposure."""
    page.keyboard.press("y")
    page.locator("canvas.exposure[data-painted=falseColour]").wait_for()


def show_scopes(page: Page) -> None:
    """Show scopes below the picture."""
    page.keyboard.press("Shift+h")
    page.locator(".scopes[data-stage=final]").wait_for()


def show_guides(page: Page) -> None:
    """Show a guide with a mask, safe areas, thirds and burn-ins."""
    for key in ("g", "Alt+a", "Alt+h", "Alt+x", "Shift+q", "Alt+b"):
        page.keyboard.press(key)
    page.locator(".burnt.bottom-right").wait_for()


def compare_lenses(page: Page) -> None:
    """Compare the picture with that of another lens, in the menu of tools."""
    page.get_by_role("button", name="Tools on the picture").click()
    page.locator("#tools .choice:has(> span:text-is('Lens')) select").select_option("lens biotar_58")


def show_wipe(page: Page) -> None:
    """Wipe between the picture and that of another lens."""
    compare_lenses(page)
    page.get_by_role("radio", name="Wipe").click()
    page.locator("canvas.compared[data-best=true]").wait_for()
    page.keyboard.press("Escape")


def show_difference(page: Page) -> None:
    """Show the difference of the picture and that of another lens, with the menu of tools open."""
    compare_lenses(page)
    page.get_by_role("radio", name="Difference").click()
    page.locator("canvas.compared[data-best=true]").wait_for()


def show_notes(page: Page) -> None:
    """Draw a note on the picture, which `take` undoes; the list of notes shows it."""
    page.keyboard.press("Alt+p")
    expect(page.get_by_role("textbox", name="Note")).to_be_focused()
    page.keyboard.type("Rack to mara as she turns")
    box = page.locator(".drawing-sheet").bounding_box()
    assert box is not None
    at = [
        (box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in ((0.55, 0.25), (0.7, 0.4), (0.8, 0.25))
    ]
    page.mouse.move(*at[0])
    page.mouse.down()
    for place in at[1:]:
        page.mouse.move(*place, steps=8)
    page.mouse.up()
    page.mouse.move(0, 0)
    page.keyboard.press("Control+Enter")  # which shows the list, too
    page.locator(".note-text").first.wait_for()


def show_top_view(page: Page) -> None:
    """Show the set from above."""
    page.keyboard.press("v")
    page.locator(".plan-marker").first.wait_for()


def show_ring(page: Page) -> None:
    """Show the focus ring, from which pulls are recorded."""
    page.keyboard.press("w")
    page.get_by_role("slider", name="Focus ring").wait_for()


def move_camera(page: Page) -> None:
    """Show the bar that moves the camera."""
    page.keyboard.press("Shift+e")
    page.locator(".camera-bar").wait_for()


def show_cameras(page: Page) -> None:
    """Show the cameras side by side."""
    page.keyboard.press("Alt+Shift+c")
    dialog = page.get_by_role("dialog", name="Cameras at frame")
    dialog.locator("img").first.wait_for()


def show_renders(page: Page) -> None:
    """Show the form of a render."""
    page.keyboard.press("Alt+Shift+r")
    dialog = page.get_by_role("dialog", name="Renders")
    dialog.get_by_role("textbox", name="Frames").fill("1-96:2")
    dialog.locator(".render-plan").get_by_text("frames").first.wait_for()


STATES: dict[str, Callable[[Page], None]] = {
    "open": lambda page: None,
    "camera": show_camera,
    "commands": show_commands,
    "sharpness": show_sharpness,
    "curve": show_curve,
    "groups": show_groups,
    "lenses": show_lenses,
    "exposure": show_exposure,
    "scopes": show_scopes,
    "guides": show_guides,
    "wipe": show_wipe,
    "difference": show_difference,
    "notes": show_notes,
    "top_view": show_top_view,
    "ring": show_ring,
    "moving": move_camera,
    "cameras": show_cameras,
    "renders": show_renders,
}
"""Ways to each state from the open shot, by its name."""
