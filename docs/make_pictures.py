"""The pictures of the documents, made from what `rotor demo` wrote: `make pictures`, or this with the demo's folder.

docs/img/demo.png: a Bode plot and the orbit at the critical speed, as in the report, drawn by Chromium.
docs/img/lab-page.png: the pages of a lab that is made up but for its newest runs, which are the demo's.
docs/img/live.png: the live view during the coast-down, played from the recording into Rerun's viewer without a window.
"""

import contextlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from datetime import timedelta
from html import escape
from importlib import resources
from pathlib import Path

import numpy as np
from PIL import Image
from plotly.offline import get_plotlyjs
from rerun.experimental import ViewerClient

from docs.browser import screenshot
from docs.origin import origin, save_png
from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import read_recording
from rotorrig.app.lab.page import write_lab_page
from rotorrig.app.plot_data import representative_rows, sweeps, vectors
from rotorrig.app.report.drawings import orbit_pictures
from rotorrig.app.report.figures import bode as bode_figure
from rotorrig.app.viewer import LiveView
from rotorrig.app.viewer.sinks import Sink, free_port, proxy, quiet_environment, viewer_program
from rotorrig.identify import read_identification
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import read_response
from rotorrig.rig import RigError
from tests.app.browser import browser
from tests.app.lab.page.catalogue_maker import DAYS, FIRST_DAY, add_real_run, make_lab

COMMAND = "python -m docs.make_pictures demo"
IMAGES = Path(__file__).parent / "img"
PAGE = (1200, 520)  # CSS pixels; the picture has two of its own for each
LAB = (1280, 2700)  # of the window: all of it is seen, and drawn
WINDOW = (1500, 987)  # of the viewer
MENU = 37  # pixels at its top: the viewer's own menu, with remarks on the machine it runs on
FAST = 15.0  # recorded seconds per second, up to the last moments
LAST = 3.0  # s that are played as they were: the time base shows what came in last
BEYOND = 0.94  # of the critical speed: where the coast-down is caught


def main() -> None:
    """Make the pictures; a missing folder or program ends in one sentence."""
    demo = Path(sys.argv[1] if len(sys.argv) > 1 else "demo")
    try:
        for name in ("run.mcap", "response.mcap", "fit.json", "diagnosis.json", "bowed/diagnosis.json"):
            if not (demo / name).is_file():
                raise RigError(f"{demo / name}: there is no such file, want what `rotor demo --out {demo}` writes")
        IMAGES.mkdir(exist_ok=True)
        response = read_response(demo / "response.mcap")
        picture_result(response, demo / "fit.json", IMAGES / "demo.png")
        picture_lab(demo, response.rig.hash, IMAGES / "lab-page.png")
        picture_live(read_recording(demo / "run.mcap"), _moment(response), IMAGES / "live.png")
    except RigError as error:
        sys.exit(f"error: {error}")


def picture_result(response: OrderTrackedResponse, fit: Path, out: Path) -> None:
    """Draw measurement and fit at one probe beside the largest orbit. Raises RigError."""
    prediction = read_identification(fit).fits[0].prediction
    bode = bode_figure(response, 0, prediction=prediction)
    bode.update_layout(height=PAGE[1] - 60, font_size=15, margin_t=44)  # large enough for the width of a README
    with tempfile.TemporaryDirectory(prefix="rotor-picture-") as folder:
        page = Path(folder, "page.html")
        page.write_text(_page(response.probes[0], bode.to_json(), _largest_orbit(response)), encoding="utf-8")
        save_png(screenshot(page, PAGE), out, origin=origin(COMMAND, response.rig.hash))


def _largest_orbit(response: OrderTrackedResponse) -> str:
    """Return the plane nearest the coupling and its orbit at the critical speed as HTML."""
    plane, drawn = orbit_pictures(response)[0]
    z = vectors(response)[:, [response.probes.index(name) for name in plane.probes]]
    rows = representative_rows(response, z, run=sweeps(response)[0])  # those that were drawn
    largest = drawn[int(np.argmax(np.abs(z[rows]).max(axis=1)))]
    return f"<h3>Orbit of {escape(plane.name)}</h3>{largest}"


def _page(probe: str, bode: str, orbit: str) -> str:
    style = resources.files("rotorrig.app").joinpath("assets", "report.css").read_text(encoding="utf-8")
    return f"""<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><style>{style}
:root {{ color-scheme: light; }}
body {{ max-width: none; padding: 14px 24px; display: grid; grid-template-columns: 1fr 350px; gap: 34px; }}
h3 {{ margin: 0 0 6px; }}
.orbit svg {{ max-width: none; margin-top: 16px; }} .orbit figcaption {{ font-size: 1rem; }}
</style></head><body>
<div><h3>Probe {escape(probe)} at 1X: dots measured, lines identified</h3><div id="bode"></div></div>
<div>{orbit}</div>
<script>{get_plotlyjs()}</script>
<script>
const figure = {bode};
Plotly.newPlot("bode", figure.data, figure.layout, {{ displayModeBar: false, responsive: true }});
</script>
</body></html>"""


def picture_lab(demo: Path, config_hash: str, out: Path) -> None:
    """Draw the pages of a lab of a thousand runs, two of the demo over one another as Bode plots. Raises RigError."""
    with tempfile.TemporaryDirectory(prefix="rotor-picture-") as folder:
        lab = Path(folder, "bearing lab")
        make_lab(lab)
        (lab / "lab/results").mkdir()
        newest = []
        for name, results in {"healthy": demo, "bowed": demo / "bowed"}.items():
            place = lab / "lab/results" / name
            place.symlink_to(results.resolve())
            when = FIRST_DAY + timedelta(days=DAYS + len(newest))
            newest.append(add_real_run(lab, place, when=when, name=f"{when:%Y-%m}/{name}/run.mcap"))
        index = write_lab_page(lab, lab / "lab/page").index
        shot = Path(folder, "lab.png")
        with browser(Path(folder, "profile")) as tab:
            tab.look(width=LAB[0], height=LAB[1])
            tab.open(index, fragment=f"size=10&bode={'+'.join(newest)}", wait="rotorLab.shown")
            time.sleep(3.0)  # until both plots are drawn
            tab.picture(shot, scale=2)
        with Image.open(shot) as picture:
            save_png(picture, out, origin=origin(COMMAND, config_hash))


def _moment(response: OrderTrackedResponse) -> float:
    """Return when the coast-down has just passed the critical speed [s on the recording's clock]."""
    down = [i for i in sweeps(response) if response.runs[i].direction < 0]
    rows = np.flatnonzero(np.isin(response.run, down[:1]) & response.usable.all(axis=1))
    if not len(rows):
        raise RigError("the response has no coast-down, want the demo's for the picture of the live view")
    critical = response.omega[rows[np.argmax(np.abs(response.order(1.0)[rows]).max(axis=1))]]
    return float(response.t[rows[response.omega[rows] < BEYOND * critical][0]])


def picture_live(recording: RawRecording, moment: float, out: Path) -> None:
    """Play a recording up to `moment` [s] into a live view and keep what it shows. Raises RigError."""
    with _viewer() as (client, address):
        sink = Sink(targets=(address,))
        with LiveView(recording.rig, recording.daq, sink) as view:
            _play(recording, moment, view)
        if view.fault:
            raise RigError(f"the live view ended: {view.fault}")
        time.sleep(2.0)  # until the last of it is drawn
        with tempfile.TemporaryDirectory(prefix="rotor-picture-") as folder:
            shot = Path(folder, "live.png")
            client.save_screenshot(str(shot))
            picture = Image.open(shot).convert("RGB")
        save_png(picture.crop((0, MENU, *picture.size)), out, origin=origin(COMMAND, recording.rig.hash))


def _play(recording: RawRecording, moment: float, view: LiveView) -> None:
    for block in recording.blocks:
        at = block.t_ns / 1e9
        if at > moment:
            return
        view.show(block)
        seconds = len(block.counts) / recording.daq.sample_rate
        time.sleep(seconds if at > moment - LAST else seconds / FAST)


@contextlib.contextmanager
def _viewer() -> Iterator[tuple[ViewerClient, str]]:
    """Start a viewer without a window; yield what steers it and where streams go. Raises RigError."""
    port = free_port()
    words = [viewer_program(), "--headless", "--bind", "127.0.0.1", "--port", str(port), "--hide-welcome-screen"]
    process = subprocess.Popen(
        [*words, "--window-size", f"{WINDOW[0]}x{WINDOW[1]}"],
        env=quiet_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield _connected(proxy(port)), proxy(port)
    finally:
        process.terminate()
        process.wait(timeout=10)


def _connected(address: str) -> ViewerClient:
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        with contextlib.suppress(Exception):  # still starting; its own classes of error are not public
            client = ViewerClient.connect(address)
            client.get_state()
            return client
        time.sleep(0.2)
    raise RigError(
        "the Rerun viewer did not start without a window, want a Vulkan driver (Debian: mesa-vulkan-drivers)"
    )


if __name__ == "__main__":
    main()
