"""A Rerun viewer without a window, on this machine alone, and what can be seen in it."""

import contextlib
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from rerun.experimental import ViewerClient

from rotorrig.app.viewer.sinks import free_port, proxy, quiet_environment, viewer_program

VULKAN = [Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d")]
needs_vulkan = pytest.mark.skipif(
    not any(folder.glob("*.json") for folder in VULKAN), reason="needs a Vulkan driver (Debian: mesa-vulkan-drivers)"
)


@contextlib.contextmanager
def headless_viewer(*, port: int | None = None) -> Iterator[ViewerClient]:
    """Start a viewer; it ends with the `with` block."""
    port = port or free_port()
    words = [viewer_program(), "--headless", "--bind", "127.0.0.1", "--port", str(port), "--hide-welcome-screen"]
    with tempfile.TemporaryDirectory(prefix="rerun-") as folder:  # where it keeps layouts: none of earlier viewers'
        process = subprocess.Popen(
            [*words, "--window-size", "1300x850"],
            env={**quiet_environment(), "XDG_DATA_HOME": folder},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            yield _connected(port)
        finally:
            process.terminate()
            process.wait(timeout=10)


def views(
    viewer: ViewerClient, folder: Path, *, but_hidden: bool = False, by_kind: bool = False
) -> dict[str, np.ndarray]:
    """Return what each view shows, (height, width, 3); none may report a failure.

    `but_hidden` leaves out the views in tabs that are not open, `by_kind` names them by what they are: "3D", "TextLog".
    """
    found = {}
    state = viewer.get_state()
    assert [(view.name, view.reports) for view in state.views if view.reports] == []
    for view in state.views:
        try:
            viewer.save_screenshot(str(folder / "view.png"), view.view_id)
        except ConnectionError:  # it is in a tab that is not open
            if but_hidden:
                continue
            raise
        found[view.view_class if by_kind else view.name] = np.asarray(
            Image.open(folder / "view.png").convert("RGB")
        ).astype(int)
    return found


def marked(picture: np.ndarray, colour: tuple[int, int, int], *, within: int = 30) -> np.ndarray:
    """Return where a picture has a colour, (height, width)."""
    return np.abs(picture - colour).max(axis=2) < within


def _connected(port: int) -> ViewerClient:
    for _ in range(100):
        try:
            client = ViewerClient.connect(proxy(port))
            client.get_state()
        except Exception:
            time.sleep(0.1)  # still starting
        else:
            return client
    raise AssertionError("the headless viewer did not start")


def show_tab(viewer: ViewerClient, name: str) -> None:
    """Open the tab of that name in the active recording's layout."""
    layout = viewer.get_blueprint(of="recording").blueprint
    boxes = {path.removeprefix("/"): part.get("ContainerBlueprint", {}) for path, part in layout.items()}
    wanted = next(path for path, box in boxes.items() if box.get("display_name") == name)
    (tabs,) = (box for box in boxes.values() if box.get("active_tab"))
    tabs["active_tab"] = wanted
    viewer.set_blueprint(layout, of="recording")
    time.sleep(0.5)
