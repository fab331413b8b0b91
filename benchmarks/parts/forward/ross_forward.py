"""Unbalance responses by ROSS, timed: run by benchmarks/forward.py under the Python of ROSS's own environment.

Reads cases as JSON (forward_peers.ross_case), answers on the last line of the output. Three times per case, each
process CPU and wall, median of `REPEATS`: "fresh" builds the rotor and responds, as a search must for every candidate;
"response" is of a rotor already built that has answered nothing yet; "cached" asks the same rotor the same once more.
"""

import json
import statistics
import sys
import time
import warnings

warnings.simplefilter("ignore")  # of packages ROSS imports: properties of fluids that no rotor here has

import numpy as np  # noqa: E402
import ross as rs  # noqa: E402

REPEATS = 5


def main() -> None:
    """Answer every case."""
    answers = {name: answer(case) for name, case in json.loads(sys.stdin.read()).items()}
    print()  # ROSS's imports may leave an unfinished line
    print(json.dumps({"version": rs.__version__, "numpy": np.__version__, "cases": answers}))


def answer(case: dict) -> dict:
    """Time one case and return its response at the probes."""
    times = {"build": [], "response": [], "cached": []}
    respond(built(case), case)  # whatever is compiled or imported late
    for _ in range(REPEATS):
        rotor = timed(lambda: built(case), times["build"])
        result = timed(lambda rotor=rotor: respond(rotor, case), times["response"])
        timed(lambda rotor=rotor: respond(rotor, case), times["cached"])
    times["fresh"] = [(a[0] + b[0], a[1] + b[1]) for a, b in zip(times["build"], times["response"], strict=True)]
    dof = rotor.number_dof
    z = [
        np.cos(angle) * result.forced_resp[dof * node] + np.sin(angle) * result.forced_resp[dof * node + 1]
        for node, angle in case["probes"]
    ]
    medians = {name: [statistics.median(column) for column in zip(*rows, strict=True)] for name, rows in times.items()}
    return {"cpu_wall": medians, "dof": rotor.ndof, "re": np.real(z).T.tolist(), "im": np.imag(z).T.tolist()}


def built(case: dict) -> rs.Rotor:
    """Return the rotor of a case."""
    steel = rs.Material(name="shaft", **case["material"])
    shaft = [rs.ShaftElement(L=L, idl=case["inner"], odl=case["outer"], material=steel) for L in case["lengths"]]
    disks = [rs.DiskElement(**disk) for disk in case["disks"]]
    return rs.Rotor(shaft, disks, [rs.BearingElement(**bearing) for bearing in case["bearings"]])


def respond(rotor: rs.Rotor, case: dict) -> rs.ForcedResponseResults:
    """Return the unbalance response."""
    unbalance = case["unbalance"]
    return rotor.run_unbalance_response(unbalance["node"], unbalance["amount"], 0.0, np.array(case["omega"]))


def timed(work, times: list):
    """Do `work`, note its CPU and wall time [s], return what it returned."""
    cpu, wall = time.process_time(), time.perf_counter()
    result = work()
    times.append((time.process_time() - cpu, time.perf_counter() - wall))
    return result


if __name__ == "__main__":
    main()
