"""How the unknowns of a diagnosis are laid out: bounds, priors and effects in SI."""

import numpy as np
import pytest

from rotorrig.identify.extended_model.nuisance_effects import nuisance_effects
from rotorrig.identify.extended_model.parameters import KEYPHASOR, ExtendedParameters
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import Effect, Parameter, find
from tests.identify.swept import swept_response

PROBES = ("1x", "1y", "2x", "2y")


def damping(rig: RigConfig) -> list[Effect]:
    """Return the nuisance effects of a rig whose rotor turns forwards alone."""
    return nuisance_effects([Recording(swept_response(rig, speeds=(900, 2000), ramp=600))])


class Nothing(Effect):
    name = "nothing"


def nameless(*parameters: Parameter) -> Effect:
    return Nothing(parameters=parameters)


def laid_out(rig: RigConfig, *effects: Effect) -> ExtendedParameters:
    return ExtendedParameters(
        rig,
        PROBES,
        orders=(1, 2),
        hum_lines=[(0, 50.0), (1, 50.0), (1, 120.0)],
        effects=effects,
    )


def test_the_unknowns_of_a_fit_come_first_and_those_of_effects_last(rig: RigConfig) -> None:
    names = laid_out(rig, find(rig, "bow"), find(rig, "delay"))
    assert names.names[: len(names.base)] == names.base.names
    assert names.names[names.own] == ("bow: bow re", "bow: bow im", "delay: delay")
    assert names.names[names.keyphasor] == KEYPHASOR
    assert names.names[names.runouts[2]][0] == "runout 2X 1x re"
    assert names.names[names.hums][-1] == "hum 120 Hz 2 im"
    assert len(set(names.names)) == len(names)


def test_effects_are_counted_in_their_sizes_and_told_in_si(rig: RigConfig) -> None:
    names = laid_out(rig, find(rig, "bow"), find(rig, "delay"))
    p = names.start(np.zeros(0))
    p[names.own] = 1.5, -0.5, 2.0
    assert names.of_effect(p, 0) == pytest.approx({"bow re": 15e-6, "bow im": -5e-6})
    assert names.of_effect(p, 1) == pytest.approx({"delay": 3e-4})


def test_a_fit_may_go_somewhat_beyond_what_is_plausible(rig: RigConfig) -> None:
    names = laid_out(rig, find(rig, "delay"))
    low, high = (bound[names.own] for bound in names.bounds)
    (q,) = names.effects[0].parameters
    assert float(high[0] * q.size) == pytest.approx(EXTENDED_MODEL.fit_range * q.high)
    assert float(low[0] * q.size) == pytest.approx(EXTENDED_MODEL.fit_range * q.low)


def test_a_range_that_is_all_positive_is_widened_at_both_ends(rig: RigConfig) -> None:
    ratio = Parameter(name="ratio", unit="", low=0.5, high=2.0, size=0.5, at_zero=1.0)
    names = laid_out(rig, nameless(ratio))
    low, high = (bound[names.own] for bound in names.bounds)
    assert (float(low[0]), float(high[0])) == pytest.approx((0.5, 8.0))  # 0.25 and 4, in halves
    assert names.of_effect(names.start(np.zeros(0)), 0) == {"ratio": 1.0}


def test_geometry_is_off_by_the_configs_priors_and_hubs_and_tilt_stiffness_never_below_zero(rig: RigConfig) -> None:
    names = laid_out(rig)
    base, (low, high) = names.base, names.bounds
    assert [names.names[i] for i in (base.positions.start, base.positions.stop - 1)] == [
        "position disk disk",
        "position probe 2y",
    ]
    assert names.names[base.diameter] == ("diameter",)
    sigma = base.prior_sigma
    assert set(sigma[base.positions]) == {rig.prior.position}
    assert sigma[base.diameter] == [rig.prior.diameter]
    assert set(sigma[base.hubs]) == {rig.prior.hub}
    assert list(sigma[base.tilts]) == [rig.tilt_prior(bearing.name) for bearing in rig.bearings]
    for part in (base.hubs, base.tilts):
        assert (low[part] == 0).all()
        assert (high[part] > 0).all()
    assert (low[base.positions] == -high[base.positions]).all()


def test_only_nuisances_have_priors_and_they_are_those_of_the_config(rig: RigConfig) -> None:
    (slight,) = damping(rig)
    names = laid_out(rig, slight, find(rig, "bow"))
    sigma = dict(zip(names.names, names.prior_sigma, strict=True))
    assert sigma[KEYPHASOR] == rig.prior.keyphasor_angle
    assert sigma["runout 2X 2y im"] == rig.prior.runout
    assert sigma["hum 50 Hz 1 re"] == rig.prior.line_hum
    assert sigma[f"{slight.label}: {slight.parameters[0].name}"] * slight.parameters[0].size == pytest.approx(
        rig.prior.rotating_damping
    )
    assert np.isinf([sigma["kxx"], sigma["u re"], sigma["bow: bow re"]]).all()


def test_a_nuisance_one_sigma_off_costs_one(rig: RigConfig) -> None:
    names = laid_out(rig, *damping(rig))
    p = names.start(np.zeros(0))
    assert not names.prior_residual(p).any()
    for i in names.priors:
        off = p.copy()
        off[i] += names.prior_sigma[i]
        assert np.sum(names.prior_residual(off) ** 2) == pytest.approx(1.0)
    np.testing.assert_allclose(names.prior_jacobian() @ (off - p), names.prior_residual(off))


def test_a_parameter_without_room_is_held_where_it_stands(rig: RigConfig) -> None:
    time = Parameter(name="time", unit="s", low=7.0, high=7.0, size=2.0, at_zero=7.0)
    names = laid_out(rig, nameless(time))
    assert names.frozen == {len(names) - 1: 3.5}
    low, high = names.bounds
    assert low[-1] <= 3.5 <= high[-1]


def test_what_a_scan_finds_no_fit_moves(rig: RigConfig) -> None:
    step = find(rig, "unbalance_step").fix_grid_searched({"time": 42.0})
    names = laid_out(rig, step)
    assert names.frozen == {len(names) - 1: 42.0}
    assert names.of_effect(names.start(np.zeros(0)), 0) == {"step re": 0.0, "step im": 0.0, "time": 42.0}


def test_the_start_takes_over_the_base_of_another_problem(rig: RigConfig) -> None:
    smaller, larger = laid_out(rig), laid_out(rig, find(rig, "bow"))
    base = np.arange(float(len(smaller)))
    start = larger.start(base)
    np.testing.assert_array_equal(start[: len(smaller)], base)
    assert not start[larger.own].any()


def test_what_has_a_wider_prior_may_go_as_much_further(rig: RigConfig) -> None:
    laid = [
        ExtendedParameters(rig, PROBES, orders=(1,), hum_lines=(), effects=(), widened=widened)
        for widened in ((), ("position disk disk",))
    ]
    reach = [dict(zip(names.names, names.bounds[1], strict=True)) for names in laid]
    assert reach[1]["position disk disk"] == pytest.approx(EXTENDED_MODEL.wider * reach[0]["position disk disk"])
    assert reach[1]["position probe 2y"] == reach[0]["position probe 2y"]
    sigma = [names.stated_sigma for names in laid]
    assert (sigma[0] == sigma[1]).all()
