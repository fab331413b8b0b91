"""One recording of a diagnosis: its rows at every order, whitened, and the rotor model swept through them."""

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model.mains_hum import hum_leaks, hum_strays
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL, ORDERS
from rotorrig.identify.measurement import Measurement, measure, told_by_falling_angle, trial_unbalance
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import ReadingContext
from rotorrig.sims.rotor.model import (
    Direction,
    LatestResponses,
    Load,
    RotorModel,
    in_recording,
    reverse_direction,
    reverse_load,
    reverse_rotor,
)
from rotorrig.sims.rotor.nonlinear import (
    ForceLaw,
    LawChange,
    LawDerivatives,
    steady_law_derivatives,
    steady_with_law,
    swept_law_derivatives,
    swept_with_law,
)
from rotorrig.sims.rotor.steady import Derivatives, load_columns, steady_derivatives
from rotorrig.sims.rotor.swept import Timeline, swept_columns, swept_derivatives, tracked_rows

Complex = NDArray[np.complex128]


class Recording:
    """The rows of one response. Those of the slow roll, one vector per probe and order, come last."""

    def __init__(
        self,
        response: OrderTrackedResponse,
        *,
        swept: bool = True,
        number: int = 0,
        backward: bool = False,
        planned: bool = False,
        orders: Sequence[int] = ORDERS,
        band: tuple[float, float] | None = None,
    ) -> None:
        """Gather the rows; `swept` False takes the speed as steady, as a table without times does.

        `number` counts the recordings of a fit from 0. `backward`: the rotor turned against the model's sense of
        rotation; all vectors here are then told by the model's shaft angle, which falls (see `as_measured`). `planned`:
        it was not made, so no vector of it is known. Other `orders`, and speeds outside `band` [rad/s], are left out.
        Raises DataError if fewer than five rows are left.
        """
        self.response = response
        self.number = number
        self.backward = backward
        self.planned = planned
        self._reversed: list[tuple[RotorModel, RotorModel]] = []  # the latest rotor, and as it turns backwards
        self._latest = LatestResponses(keep=EXTENDED_MODEL.recent)
        self.orders = tuple(order for order in orders if float(order) in response.orders)
        told = told_by_falling_angle(response) if backward else response
        self.measured = {n: measure(told, order=float(n), band=band) for n in self.orders}
        self.rows = self.measured[1].rows
        slow = response.slow_omega
        self._omega = response.omega[self.rows]
        # without a slow roll its row is not usable, but a force law has no motion at rest
        self._slow = np.array([slow if np.isfinite(slow) else np.min(self._omega, initial=np.inf)])
        known = len(response.keyphasor_t) > 3 and bool(np.isfinite(response.t[self.rows]).all())
        self._tracked = None
        if swept and known:
            self._tracked = tracked_rows(
                Timeline(response.keyphasor_t),
                t=response.t[self.rows],
                revolutions=response.revolutions[self.rows],
                window=response.window,
            )
        self.trial = trial_unbalance(told, self.rows)
        views = {order: self._view(order) for order in self.orders}
        self._views = views if planned else _with_slow_roll(views, self.measured)
        self.hum = hum_leaks(response, self.rows, views)

    @property
    def rig(self) -> RigConfig:
        """The rig, in the model's sense of rotation."""
        return self.response.rig.turned_over if self.backward else self.response.rig

    @property
    def swept(self) -> bool:
        """Whether the moving speed is in the model."""
        return self._tracked is not None

    def only(self, keep: NDArray[np.bool_]) -> "Recording":
        """Return the same recording with nothing usable but `keep`, (row,) or (row, probe), and its slow roll."""
        rows = keep.reshape(len(keep), -1)
        kept = np.concatenate([rows, rows.any(axis=0, keepdims=True)])
        return self._with({n: m.only(kept) for n, m in self.measured.items()})

    def thinned(self, kept: NDArray[np.intp]) -> "Recording":
        """Return the same recording with the rows of these numbers alone, at 1X, their speed taken as steady.

        The model's own error is that of one which predicts the vectors as measured.
        """
        other, rows = copy.copy(self), np.append(kept, len(self.rows))
        other.orders, other.rows, other._omega = (1,), self.rows[kept], self._omega[kept]
        other._tracked, other._reversed = None, []
        other._latest = LatestResponses(keep=EXTENDED_MODEL.recent)
        first = self.measured[1].at(kept)
        other.measured = {1: first.expecting_error(np.nan_to_num(first.z), self.response)}
        other.trial = {plane: amounts[rows] for plane, amounts in self.trial.items()}
        other.hum = {1: {f: leaked[rows] for f, leaked in self.hum[1].items()}}
        other._views = {1: replace(other._view(1), slow_roll=self._views[1].slow_roll)}
        return other

    def first_order(self) -> "Recording":
        """Return the same recording with nothing usable above 1X."""
        return self._with({n: m.only(np.array([[n == 1]])) for n, m in self.measured.items()})

    def instead(self, z: Mapping[int, Complex]) -> "Recording":
        """Return the same recording of other vectors (row + 1, probe) [m] per order, with the noise of its own."""
        return self._with({n: replace(m, z=z[n]) for n, m in self.measured.items()})

    def louder(self, factors: Mapping[int, NDArray[np.float64]]) -> "Recording":
        """Return the same recording with the variance of every row times a factor (row,) per order; itself if all 1."""
        if all((factor == 1).all() for factor in factors.values()):
            return self
        return self._with({n: m.louder(factors[n]) for n, m in self.measured.items()})

    def expecting_error(self, model: Mapping[int, Complex], known: Mapping[int, Complex] | None = None) -> "Recording":
        """Return the same recording with the own error of a model that predicts these vectors (row + 1, probe) [m].

        `known`, by order, as of `Measurement.expecting_error`.
        """
        own = known or {}
        each = self.measured.items()
        return self._with({n: m.expecting_error(model[1], self.response, order=n, known=own.get(n)) for n, m in each})

    def taken_for_exact(self) -> "Recording":
        """Return the same recording for a model without an error of its own."""
        return self._with({n: m.taken_for_exact() for n, m in self.measured.items()})

    def with_trial(self, unbalance: Mapping[str, complex]) -> "Recording":
        """Return the same recording with these masses [kg m] on in every row, and no others; none in the slow roll."""
        other, ones = copy.copy(self), np.append(np.ones(len(self.rows), complex), 0)
        other.trial = {plane: amount * ones for plane, amount in unbalance.items()}
        return other

    def numbered(self, number: int) -> "Recording":
        """Return the same recording with another number, of whose unknowns of its own it has a share."""
        other = copy.copy(self)
        other.number = number
        return other

    def in_metres(self) -> "Recording":
        """Return the same recording with residuals and Jacobians in metres, of every vector, measured or not."""
        return self._with({n: m.in_metres() for n, m in self.measured.items()})

    def _with(self, measured: dict[int, Measurement]) -> "Recording":
        other = copy.copy(self)
        other.measured = measured
        known = all(len(view.slow_roll) for view in self._views.values())
        other._views = _with_slow_roll(self._views, measured) if known else self._views
        return other

    def begins(self, load: Load) -> float:
        """Return when a load begins on the clock of this recording [s]: -inf before it, inf after its end."""
        since = in_recording(load, self.number).since
        pulses = self.response.keyphasor_t
        if not len(pulses):
            return -math.inf if since <= 0 else since
        return -math.inf if since <= pulses[0] else math.inf if since > pulses[-1] else since

    def columns(self, model: RotorModel, loads: Sequence[Load], *, order: int) -> Complex:
        """Return the response to each of `loads`, all of that order, (row + 1, probe, load) m per its unit."""
        if not loads:
            return np.zeros((len(self.rows) + 1, len(model.probes), 0), dtype=complex)
        return self._latest.get(model, loads, lambda: self._columns(model, loads, order=order))

    def _columns(self, model: RotorModel, loads: Sequence[Load], *, order: int) -> Complex:
        model, loads = self._turning(model, self._own(loads))
        if self._tracked is not None:
            moving = swept_columns(model, self._tracked, loads=loads, order=order)
        else:
            moving = load_columns(model, self._omega, loads) * self._begun(loads)[:, None]
        return self.as_measured(np.concatenate([moving, self._early(load_columns(model, self._slow, loads), loads)]))

    def derivatives(
        self, model: RotorModel, loads: Sequence[Load], directions: Sequence[Direction], *, order: int
    ) -> Derivatives:
        """Return that and its derivatives along `directions`, (direction, row + 1, probe, load)."""
        model, loads = self._turning(model, self._own(loads))
        directions = [reverse_direction(d) for d in directions] if self.backward else directions
        if self._tracked is not None:
            moving = swept_derivatives(model, self._tracked, loads=loads, directions=directions, order=order)
        else:
            steady = steady_derivatives(model, self._omega, loads=loads, directions=directions, order=order)
            begun = self._begun(loads)[:, None]
            moving = Derivatives(steady.z * begun, steady.by * begun)
        slow = steady_derivatives(model, self._slow, loads=loads, directions=directions, order=order)
        return Derivatives(
            self.as_measured(np.concatenate([moving.z, self._early(slow.z, loads)])),
            self.as_measured(np.concatenate([moving.by, self._early(slow.by, loads)], axis=1)),
        )

    def with_laws(
        self,
        model: RotorModel,
        loads: Sequence[Load],
        amounts: Complex,
        laws: Sequence[ForceLaw],
        *,
        orders: Sequence[int],
    ) -> dict[int, Complex]:
        """Return the motion under loads of 1X times `amounts` (load,) and force laws, order -> (row + 1, probe).

        A stiffness that turns with the shaft is left out. Raises DataError where the force is not found.
        """
        self._check_forward()
        model = _without_turning(model)
        loads = self._own(loads)
        slow = steady_with_law(model, self._slow, loads, amounts * self._acting(loads), laws, orders=orders)
        if self._tracked is not None:
            moving = swept_with_law(model, self._tracked, loads, amounts, laws, orders=orders)
        else:
            moving = steady_with_law(model, self._omega, loads, amounts, laws, orders=orders)
        both = np.concatenate([moving, slow])
        largest = EXTENDED_MODEL.largest_motion
        if not np.all(np.abs(both) < largest):  # NaN too
            raise DataError(f"under its force laws the rotor moves by more than {largest:g} m, want a bounded motion")
        return {order: both[..., i] for i, order in enumerate(orders)}

    def law_derivatives(
        self,
        model: RotorModel,
        loads: Sequence[Load],
        amounts: Complex,
        laws: Sequence[ForceLaw],
        changes: Sequence[LawChange],
        *,
        orders: Sequence[int],
    ) -> LawDerivatives:
        """Return the motion of 1X under them, (row + 1, probe), and its derivatives, order -> (row + 1, probe, change).

        Above 1X those of the laws' forces. A stiffness that turns with the shaft is left out. Raises DataError where
        the force is not found.
        """
        self._check_forward()
        model = _without_turning(model)
        changes = [c if c.direction is None else replace(c, direction=c.direction._replace(T=0.0)) for c in changes]
        loads = self._own(loads)
        acting = self._acting(loads)
        early = [c if c.amounts is None else replace(c, amounts=c.amounts * acting) for c in changes]
        slow = steady_law_derivatives(model, self._slow, loads, amounts * acting, laws, changes=early, orders=orders)
        if self._tracked is not None:
            moving = swept_law_derivatives(model, self._tracked, loads, amounts, laws, changes=changes, orders=orders)
        else:
            moving = steady_law_derivatives(model, self._omega, loads, amounts, laws, changes=changes, orders=orders)
        by = {order: np.concatenate([moving.by[order], slow.by[order]]) for order in orders}
        return LawDerivatives(np.concatenate([moving.z, slow.z]), by)

    def in_response(self, z: Complex) -> Complex:
        """Return vectors (row + 1, ...) at the rows of the response, as measured, (speed, ...); NaN elsewhere."""
        whole = np.full((len(self.response.omega), *z.shape[1:]), np.nan + 0j)
        whole[self.rows] = self.as_measured(z[:-1])
        return whole

    def as_measured(self, z: Complex) -> Complex:
        """Return vectors told by the model's shaft angle as told by the measured one, which rises, or back."""
        return z.conj() if self.backward else z

    def as_stated(self, z: Mapping[int, Complex]) -> dict[int, Complex]:
        """Return vectors, order -> (row + 1, probe), as the table states them: see `Measurement.as_stated`."""
        return {order: self.measured[order].as_stated(vectors) for order, vectors in z.items()}

    def view(self, order: int) -> ReadingContext:
        """Return what a probe-side effect may know."""
        return self._views[order]

    def _view(self, order: int) -> ReadingContext:
        response = self.response
        probes = [response.rig.probe(name) for name in response.probes]
        return ReadingContext(
            probes=response.probes,
            angle=np.array([p.angle for p in probes]),
            position=np.array([p.position for p in probes]),
            order=order,
            recording=self.number,
            omega=np.append(self._omega, self._slow) * (-1 if self.backward else 1),
            t=response.t[self.rows],
            revolutions=response.revolutions[self.rows],
            window=response.window,
            keyphasor_t=np.empty(0) if response.derived_times else response.keyphasor_t,
            strays=hum_strays(response),
            shares={hum.frequency: hum.shares for hum in response.mains if len(hum.shares)},
        )

    def _turning(self, model: RotorModel, loads: Sequence[Load]) -> tuple[RotorModel, Sequence[Load]]:
        """Return rotor and loads in the sense in which this recording's turned."""
        if not self.backward:
            return model, loads
        if not self._reversed or self._reversed[0][0] is not model:
            self._reversed = [(model, reverse_rotor(model))]
        return self._reversed[0][1], [reverse_load(load) for load in loads]

    def _check_forward(self) -> None:
        if self.backward:
            raise DataError("a force law is not followed where the rotor turns backwards, want a forward run for it")

    def _own(self, loads: Sequence[Load]) -> list[Load]:
        """Return loads, which come on the clock of all recordings, on that of this one."""
        return [in_recording(load, self.number) for load in loads]

    def _begun(self, loads: Sequence[Load]) -> NDArray[np.bool_]:
        """Return which loads act at which row of a steady model, (row, load); a row without a time is one at 0."""
        t = np.nan_to_num(self.response.t[self.rows])
        return t[:, None] >= np.array([load.since for load in loads])

    def _early(self, z: Complex, loads: Sequence[Load]) -> Complex:
        """Return responses at the slow roll, nothing of the loads that act only later."""
        return z * self._acting(loads)

    def _acting(self, loads: Sequence[Load]) -> NDArray[np.bool_]:
        """Return which loads act at the slow roll already."""
        pulses = self.response.keyphasor_t
        first = pulses[0] if len(pulses) else 0.0
        return np.array([load.since <= first for load in loads], dtype=bool)


def recordings_of(
    responses: Sequence[OrderTrackedResponse],
    *,
    like: OrderTrackedResponse | None = None,
    swept: bool = True,
    orders: Sequence[int] = ORDERS,
    band: tuple[float, float] | None = None,
) -> list[Recording]:
    """Return the recordings of responses; those turn backwards whose rig has not the sense of rotation of `like`.

    That is the first one unless it is given. Raises DataError if one holds too few rows, or other probes or orders than
    the first.
    """
    first = responses[0]
    for number, response in enumerate(responses[1:], start=2):
        for what in ("probes", "orders"):
            if (got := getattr(response, what)) != (want := getattr(first, what)):
                raise DataError(f"response {number}: has the {what} {list(got)}, want those of the first, {list(want)}")
    sense = (like or first).rig.rotation
    return [
        Recording(r, swept=swept, number=i, backward=r.rig.rotation != sense, orders=orders, band=band)
        for i, r in enumerate(responses)
    ]


def _with_slow_roll(
    views: Mapping[int, ReadingContext], measured: Mapping[int, Measurement]
) -> dict[int, ReadingContext]:
    """Return what a probe-side effect may know, the slow roll as measured among it."""
    return {order: replace(view, slow_roll=measured[order].z[-1]) for order, view in views.items()}


def _without_turning(model: RotorModel) -> RotorModel:
    """Return the model itself where no stiffness turns with its shaft: what is known of it serves on."""
    return model if model.added.T is None else replace(model, added=model.added._replace(T=None))
