"""A lab on a scheduler that speaks TLS: as docs/lab.md says it is set up, with the scheduler and worker of Dask."""

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import yaml

from rotorrig.rig.config.description import RigConfig
from tests.app.lab.conftest import write_run_up

ROOT = Path(__file__).parents[3]
WAIT = 60.0  # s, on a busy machine

pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(shutil.which("openssl") is None, reason="no openssl to make a certificate with"),
]


@contextmanager
def started(*words: object) -> Iterator["subprocess.Popen[bytes]"]:
    """A program of Dask's that ends with the block."""
    process = subprocess.Popen([sys.executable, "-m", *map(str, words)], cwd=ROOT, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.terminate()
        process.wait(timeout=WAIT)


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    """A folder with a key and a certificate that signs itself."""
    words = "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=lab -keyout lab.key -out lab.pem"
    subprocess.run(words.split(), cwd=tmp_path, check=True, capture_output=True)
    return tmp_path


@pytest.fixture
def settings(keys: Path) -> Path:
    """A config folder of Dask's, as somebody who runs `rotor lab` has it."""
    pair = {"key": str(keys / "lab.key"), "cert": str(keys / "lab.pem")}
    tls = {"ca-file": pair["cert"], "client": pair, "scheduler": pair, "worker": pair}
    (keys / "dask").mkdir()
    (keys / "dask" / "distributed.yaml").write_text(yaml.safe_dump({"distributed": {"comm": {"tls": tls}}}))
    return keys / "dask"


def wait_until(met: Callable[[], bool]) -> None:
    until = time.monotonic() + WAIT
    while not met():
        assert time.monotonic() < until
        time.sleep(0.1)


def test_recordings_are_worked_through_over_tls_and_not_without_a_certificate(
    settings: Path, rig_config: RigConfig, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    recordings = tmp_path / "recordings"
    recordings.mkdir()
    write_run_up(recordings / "run.mcap", rig_config)
    found = tmp_path / "scheduler.json"
    rotor = [sys.executable, "-m", "rotorrig.app.cli", "lab", "run", recordings, "--steps", "track", "--scheduler"]
    with monkeypatch.context() as patch:
        patch.setenv("DASK_CONFIG", str(settings))
        scheduler = ("distributed.cli.dask_scheduler", "--protocol", "tls", "--host", "127.0.0.1", "--port", 0)
        worker = ("distributed.cli.dask_worker", "--nthreads", 1, "--no-dashboard", "--scheduler-file", found)
        with started(*scheduler, "--no-dashboard", "--scheduler-file", found):
            wait_until(found.exists)
            address = yaml.safe_load(found.read_text())["address"]
            assert address.startswith("tls://127.0.0.1:")
            with started(*worker, "--local-directory", tmp_path):
                run = subprocess.run([*rotor, address], cwd=ROOT, capture_output=True, text=True, timeout=120)
                assert (run.returncode, run.stdout.startswith("1 recording: 1 done in ")) == (0, True), run.stderr
                patch.delenv("DASK_CONFIG")
                shutil.rmtree(recordings / "lab")
                stranger = subprocess.run([*rotor, address], cwd=ROOT, capture_output=True, text=True, timeout=120)
                wanted = "Dask's config has no certificate, want ca-file and client of distributed.comm.tls"
                assert (stranger.returncode, stranger.stderr) == (1, f"error: {address}: {wanted}\n")
