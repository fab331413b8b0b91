"""A page as a browser draws it: a screenshot by Chromium, without a window."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from PIL import Image

from rotorrig.rig import RigError

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
PATIENCE = 120.0  # s to draw one page
QUIET = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
    "--hide-scrollbars",
    "--virtual-time-budget=8000",
    "--force-device-scale-factor=2",
)


def screenshot(page: Path, size: tuple[int, int]) -> Image.Image:
    """Return what the first `size` CSS pixels of a page look like, two pixels for each. Raises RigError."""
    browser = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if browser is None:
        raise RigError("there is no Chromium on the path, want one to draw a page with (Debian: chromium)")
    with tempfile.TemporaryDirectory(prefix="rotor-picture-") as folder:
        shot = Path(folder, "shot.png")
        words = [browser, *QUIET, f"--user-data-dir={folder}/profile", f"--window-size={size[0]},{size[1]}"]
        try:
            done = subprocess.run(
                [*words, f"--screenshot={shot}", page.resolve().as_uri()],
                capture_output=True,
                text=True,
                timeout=PATIENCE,
            )
        except subprocess.TimeoutExpired as error:
            raise RigError(f"{browser}: drew no picture of {page.name} within {PATIENCE:g} s") from error
        if done.returncode or not shot.is_file():
            said = done.stderr.strip().splitlines() or ["it said nothing"]
            raise RigError(f"{browser}: drew no picture of {page.name}: {said[-1]}")
        with Image.open(shot) as picture:
            return picture.convert("RGB")
