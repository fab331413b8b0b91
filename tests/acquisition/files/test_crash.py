"""A process that dies, a disk that is full."""

import resource
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from rotorrig.acquisition.files.recording_mcap import read_recording, salvage
from rotorrig.rig.probes.base import Block
from tests.acquisition.files.file_parts import with_index
from tests.parameters import defer_rest

ROOT = Path(__file__).parents[3]
CONFIG = ROOT / "configs/rk4.toml"

WRITE_FOREVER = """
import sys
from pathlib import Path
import numpy as np
from rotorrig.acquisition.files.recording_mcap import RecordingWriter
from rotorrig.rig.config.description import load
from rotorrig.rig.errors import RigError
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance

rig = load(Path(sys.argv[1]))
info = DaqInfo(model="m", serial="s", sample_rate=1e4, channels=5, volts_per_count=(6e-4,) * 5, full_scale_counts=32768)
writer = RecordingWriter(Path(sys.argv[2]), rig, info, Provenance(config_hash=rig.hash, code_version="0.1.0"))
try:
    for i in range(1_000_000):
        counts = np.random.default_rng(i).integers(-9999, 9999, (200, 5), dtype=np.int32)
        writer.write_block(Block(counts=counts, first_sample=200 * i, t_ns=20_000_000 * i))
        print(i, flush=True)
except RigError as error:
    print(error, file=sys.stderr)
"""


def writing(rig_path: Path, path: Path) -> list[str]:
    return [sys.executable, "-c", WRITE_FOREVER, str(rig_path), str(path)]


def as_written(blocks: tuple[Block, ...]) -> bool:
    return all(
        block.first_sample == 200 * i
        and np.array_equal(block.counts, np.random.default_rng(i).integers(-9999, 9999, (200, 5), dtype=np.int32))
        for i, block in enumerate(blocks)
    )


def test_kill_9_costs_a_quarter_of_a_second(tmp_path: Path) -> None:
    path, saved = tmp_path / "run.mcap", tmp_path / "saved.mcap"
    child = subprocess.Popen(writing(CONFIG, path), stdout=subprocess.PIPE, text=True)
    assert child.stdout
    written = 0
    while written < 100:
        written = int(child.stdout.readline())
    child.send_signal(signal.SIGKILL)
    rest = child.stdout.read().split()
    child.stdout.close()
    child.wait(10)
    written = int(rest[-1]) if rest else written
    assert not path.exists()
    result = salvage(path.with_name("run.mcap.part"), saved)
    assert (written + 1 - result.blocks) * 0.02 <= 0.25
    assert as_written(read_recording(saved).blocks)
    assert result.blocks > 80


@pytest.fixture(scope="module")
def a_chunk_ends(tmp_path_factory: pytest.TempPathFactory) -> int:
    path = tmp_path_factory.mktemp("reference") / "run.mcap"
    limited(CONFIG, path, 200_000)
    return with_index(path)[12]


@pytest.mark.parametrize("spare", defer_rest([0, 49, 1000]))
def test_a_full_disk_is_one_sentence_and_leaves_a_valid_file(tmp_path: Path, a_chunk_ends: int, spare: int) -> None:
    """The limit on a file's size stands in for the disk; `spare` bytes are left behind the 13th chunk."""
    path = tmp_path / "run.mcap"
    done = limited(CONFIG, path, a_chunk_ends + spare)
    assert done.stderr.count("\n") == 1
    assert "run.mcap: cannot be written any further (File too large); it ends early and keeps the 0.1" in done.stderr
    with path.open("rb") as file:  # the official reader finds it valid
        assert sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages(topics="/waveform")) > 40
    read = read_recording(path)
    assert as_written(read.blocks)
    assert not read.complete
    assert not path.with_name("run.mcap.part").exists()


def limited(config: Path, path: Path, size: int) -> "subprocess.CompletedProcess[str]":
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return subprocess.run(writing(config, path), capture_output=True, text=True, preexec_fn=limit, timeout=60)


@pytest.mark.skipif(
    subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "true"], capture_output=True).returncode != 0,
    reason="needs a user namespace, to mount a small disk in",
)
def test_a_disk_that_fills_up_holds_a_valid_file_of_what_went_onto_it(tmp_path: Path) -> None:
    disk, out, listed = tmp_path / "disk", tmp_path / "kept.mcap", tmp_path / "listed"
    disk.mkdir()
    script = f'mount -t tmpfs -o size=400k none "{disk}" && cd "{disk}" && "$@"; cp run.mcap "{out}"; ls > "{listed}"'
    words = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script, "sh"]
    done = subprocess.run([*words, *writing(CONFIG, Path("run.mcap"))], capture_output=True, text=True, cwd=ROOT)
    assert (
        "run.mcap: cannot be written any further (No space left on device); it ends early and keeps the 0."
        in done.stderr
    )
    assert listed.read_text() == "run.mcap\n"
    with out.open("rb") as file:
        assert sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages(topics="/waveform")) > 100
    read = read_recording(out)
    assert as_written(read.blocks) and not read.complete


def test_a_file_whose_end_cannot_be_written_any_more_stays_to_be_salvaged(tmp_path: Path) -> None:
    """A quota that is below the file's size already: not even the room of its last second can be had again."""
    path, saved = tmp_path / "run.mcap", tmp_path / "saved.mcap"
    with subprocess.Popen(writing(CONFIG, path), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        assert child.stdout and child.stderr
        last = 0
        while last < 100:
            last = int(child.stdout.readline())
        resource.prlimit(child.pid, resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
        patience = threading.Timer(30, child.kill)
        patience.start()
        for line in child.stdout:  # to the last: `communicate` would leave out what was read ahead
            last = int(line)
        complaint = child.stderr.read()
        patience.cancel()
    assert complaint.count("\n") == 1
    assert "run.mcap.part --out saved.mcap` saves what run.mcap.part holds" in complaint
    result = salvage(path.with_name("run.mcap.part"), saved)
    cut = 0.4  # s, the four flushes that were given up for the room
    assert (last + 1 - result.blocks) * 0.02 <= cut + 0.25
    assert as_written(read_recording(saved).blocks)


def test_a_disk_that_is_full_from_the_start_leaves_nothing(tmp_path: Path) -> None:
    done = limited(CONFIG, tmp_path / "run.mcap", 1000)
    assert "nothing of it is kept" in done.stderr
    assert not any(tmp_path.iterdir())
