"""A live page in a tab of a browser: its state, real mouse, touch and keys."""

from __future__ import annotations

from pathlib import Path
from typing import Any

ELEMENT = "document.querySelector('ulna-robot')"
PLACE = (
    "([k, way]) => { const s = "
    + ELEMENT
    + """.session, g = s.gizmos[k], v = g.group.position.clone();
    v.add(v.clone().set(...way).applyQuaternion(g.handles.quaternion).multiplyScalar(g.group.scale.x));
    v.project(s.stage.camera); return [(v.x + 1) / 2 * s.canvas.clientWidth, (1 - v.y) / 2 * s.canvas.clientHeight]; }"""
)


def state_of(page: Any) -> str | None:
    """What the element of a page says of its start, once it says something."""
    return page.wait_for_selector("ulna-robot[data-state]", state="attached").get_attribute("data-state")


class Tab:
    """A live page in a tab, with what it requested."""

    def __init__(self, chromium: Any, file: Path, size: tuple[int, int] = (800, 520), **options: Any) -> None:
        self.context = chromium.new_context(viewport={"width": size[0], "height": size[1]}, **options)
        self.page = self.context.new_page()
        self.requests: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(file.as_uri())

    def started(self) -> str | None:
        return state_of(self.page)

    def ask(self, expression: str) -> Any:
        return self.page.evaluate(f"{ELEMENT}.{expression}")

    def drag(self, way: tuple[float, float, float], by: tuple[float, float], gizmo: int = 0) -> None:
        """Takes a part of the handles with the mouse and moves it by some pixels; the button stays pressed."""
        x, y = self.place_of(way, gizmo)
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        for k in range(1, 7):
            self.page.mouse.move(x + by[0] * k / 6, y + by[1] * k / 6)

    def place_of(self, way: tuple[float, float, float] = (0, 0, 0), gizmo: int = 0) -> tuple[float, float]:
        """Where a point of the handles is on the page [pixels]; `way` is along their axes, the rings' radius is 0.74."""
        x, y = self.page.evaluate(PLACE, [gizmo, way])
        return x, y

    def touch(self, kind: str, *fingers: tuple[float, float]) -> None:
        """A touch event, "touchStart", "touchMove" or "touchEnd", with all fingers that are on the screen after it."""
        if not hasattr(self, "_session"):
            self._session = self.context.new_cdp_session(self.page)
        points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(fingers)]
        self._session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
