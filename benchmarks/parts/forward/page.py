"""What benchmarks/forward.py prints and writes."""

from typing import Any

from benchmarks.parts.forward.growth import LARGEST_DENSE, POPULATION
from benchmarks.parts.tables import markdown


def page(tables: str, summary: dict[str, float], versions: str, rounds: int) -> str:
    """Return docs/forward-speed.md."""
    s = summary
    one, more = f"{s['rk4_single_us']:.1f}", f"{s['jacobian_over_value']:.1f}"
    ratios = f"{s['rk4_vs_ross']:,.0f} and {s['lalanne_vs_ross']:,.0f}"
    return f"""# What one unbalance response costs

Written by `benchmarks/forward.py --write` (`make bench`); do not edit.

Once per speed grid `sims/rotor/steady/receptance.py` condenses the rotor to the bearings that change, the unbalance and
the probes. A candidate (k, c, u) is then a solve of twice the number of these bearings per speed. All figures are of
one run and one thread: medians of {rounds} rounds, of the dense solves {(rounds + 4) // 5}, of ROSS 5; CPU time of the
process, beside it wall time. Other load on the machine moves them by up to a factor of two, the ratios less.

RK4: configs/rk4.toml, 84 speeds, one bearing of eight coefficients. Lalanne: benchmarks/lalanne.toml, 75 speeds, two
bearings alike. Four probes each. {versions}.

- In a population of {POPULATION}, with the objective of eq. (15) on amplitudes less the slow roll: RK4
  {s["rk4_us"]:.1f} us, Lalanne {s["lalanne_us"]:.1f} us. ROSS's `run_unbalance_response` on a rotor already built
  that has answered nothing yet takes {ratios} times as long ("ROSS, response").
- A search must build the rotor anew for every k and c ("ROSS, built anew"). A rotor asked again for the same k and c,
  whatever the unbalance, has its transfer matrices at hand ("ROSS, asked again"). ROSS has six degrees of freedom per
  node, two of which have no part in this.
- A single call on the RK4 takes {one} us. With the derivatives by all eight coefficients and the unbalance
  it is {more} times the response alone (the worse of the two rotors).
- The largest difference to any of the others is {s["max_rel_diff"]:.1e} of the peak.

{tables}

The cost of a candidate does not depend on the number of elements, and for many speeds is proportional to their number;
a mesh whose matrices are narrow bands (from about eight elements) is condensed as such. The dense solve is timed up to
about {LARGEST_DENSE} elements. "k, c, u" counts the parameters that the derivatives are taken by.
"""


def table(name: str, found: dict[str, Any]) -> str:
    """Return the table of one rotor."""
    ours = found["times"]["population + objective"][0]
    rows = [(what, f"{cpu:,.1f}", f"{wall:,.1f}", f"{cpu / ours:,.1f}") for what, (cpu, wall) in found["times"].items()]
    head = (f"{name}: one response", "CPU, us", "wall, us", "times ours")
    return f"{markdown(head, rows)}\n\nLargest relative difference of ours to any other: {found['difference']:.1e}."
