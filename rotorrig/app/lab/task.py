"""What a worker does for one recording: its steps, its part-files, and a few words for whoever waits for it."""

import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from distributed import get_worker
from threadpoolctl import threadpool_limits

from rotorrig.app.lab.kernels import do_in_new_process, has_compiled, receive_job
from rotorrig.app.lab.rows import rows_of
from rotorrig.app.lab.steps import Job, Outcome, do_steps
from rotorrig.app.lab.storage import read_part, write_parts
from rotorrig.rig import ConfigError, RigError, code_version

STATUS = ("run_id", "key", "file", "status", "step", "sentence")  # columns of runs that a worker answers with
PROGRAM = "rotorrig.app.lab.task"  # this file, as the program of another process


def work_through(job: Job) -> dict[str, Any]:
    """Do the steps of a recording, write results and part-files, and return its status in a small dictionary.

    Whatever is wrong with the recording is its result: a row that failed, with its sentence. One that is done is not
    done again: its worker may have been killed between its last file and its answer. Raises ConfigError if this is
    another version of the program than the one that asks, DataError if the catalogue cannot be written.
    """
    if code_version() != job.code_version:
        raise ConfigError(
            f"a worker runs rotorrig {code_version()}, want {job.code_version} as the command; start the workers anew"
        )
    made = read_part(job.lab, "runs", job.recording.run_id, job.key)
    if made and made[0]["file"] == job.recording.file:
        return _status(made[0])
    if not has_compiled():
        outcome = _attempt(job)
        if not has_compiled():
            return write_outcome(job, outcome)
        for step in outcome.seconds:
            outcome.files[step].unlink(missing_ok=True)
    if do_in_new_process(PROGRAM, job):
        made = read_part(job.lab, "runs", job.recording.run_id, job.key)
        return {**_status(made[0]), "to_restart": _address()}
    return write_outcome(job, _attempt(job))


def main() -> None:
    """Work through the recording that another process sends, whatever is compiled on the way."""
    job = receive_job()
    write_outcome(job, _attempt(job))


def _address() -> str:
    """Return the address of the worker that this is; empty outside of one."""
    try:
        return str(get_worker().address)
    except ValueError:
        return ""


def _attempt(job: Job) -> Outcome:
    """Do the steps of a recording; what is wrong with it is a sentence in the outcome."""
    outcome = Outcome()
    try:
        with threadpool_limits(1, user_api="blas"):
            do_steps(job, outcome)
    except RigError as error:
        outcome.sentence = str(error).replace(f"{job.lab.root}/", "")
    except Exception as error:  # a defect costs one recording, and not the night's run
        outcome.sentence = _defect_in_a_sentence(error)
    return outcome


def write_outcome(job: Job, outcome: Outcome) -> dict[str, Any]:
    """Write the part-files of a computation and return its status. Raises DataError if they cannot be written."""
    rows = rows_of(job, outcome)
    write_parts(job.lab, job.recording.run_id, job.key, rows)
    return _status(rows["runs"][0])


def _status(run: Mapping[str, Any]) -> dict[str, Any]:
    return {name: run[name] for name in STATUS}


def _defect_in_a_sentence(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return "the memory did not suffice; run with fewer workers"
    last = traceback.extract_tb(error.__traceback__)[-1]
    said = " ".join(str(error).split())
    return (
        f"a defect of this program: {type(error).__name__} ({said}) in {Path(last.filename).name}, line {last.lineno}"
    )


if __name__ == "__main__":
    main()
