"""How well a nameplate is known: the `[prior]` table of a config."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from rotorrig.rig.config.nameplate import Angle, Length, Part, Time
from rotorrig.rig.config.units import read_share, reads

LATER_PRIORS = (
    "position",
    "diameter",
    "hub",
    "tilt",
    "model_error",
    "repeatability",
    "harmonic_error",
    "damping_over_speed",
    "mark_radius",
)  # keys that a config of before does not have
Share = Annotated[float, BeforeValidator(read_share), Field(gt=0, le=1)]


class Prior(Part):
    """Uncertainty of the nameplate, one standard deviation each: nuisances of every fit, no causes within that.

    What is relative is a number or text in per cent: 0.002 or "0.2 %".
    """

    youngs_modulus: Share = 0.01  # relative
    disk_mass: Share = 0.01  # relative
    bearing: Share = 0.05  # relative, stiffness of the bearings not identified
    position: Length = 1e-3  # of every disk, bearing and probe along the shaft
    diameter: Share = 0.002  # relative, of all of the shaft
    #: of a disk's hub: share of the shaft's flexibility in bending that it takes away, one-sided from 0; 0.5 is twice
    #: the second moment of area
    hub: Annotated[float, BeforeValidator(read_share), Field(gt=0, le=0.9)] = 0.5
    #: tilt stiffness of every bearing, beyond what it states, one-sided; default: 1 % of EI / diameter of the shaft
    tilt: Annotated[float, reads("tilt stiffness"), Field(gt=0)] | None = None
    probe_gain: Share = 0.01  # relative
    probe_linearity: Annotated[float, BeforeValidator(read_share)] = Field(
        0.003, ge=0, le=1
    )  # of the reading: nonlinearity that remains after calibration
    probe_angle: Annotated[Angle, Field(gt=0)] = 0.01745329  # 1 degree, of every probe
    runout: Length = 10e-6  # per probe, 0-peak; the slow-roll vector narrows it
    keyphasor_angle: Annotated[Angle, Field(gt=0)] = 0.034906585  # 2 degrees, of the mark; trial masses narrow it
    rotating_damping: Time = 5e-6  # of the shaft: stress proportional to strain rate; of steel
    #: of the model itself: share by which its 1X motion may be off at a speed, smooth over speed; 0: it is exact
    model_error: Annotated[float, BeforeValidator(read_share)] = Field(0.005, ge=0, le=1)
    #: of the rig: share by which that motion differs from run to run, smooth over speed
    repeatability: Annotated[float, BeforeValidator(read_share)] = Field(0.0025, ge=0, le=1)
    #: of the model's 2X and 3X, which need not be nothing: share of a probe's largest 1X motion, there; it falls with
    #: the square of that motion at 2X, with its cube at 3X
    harmonic_error: Annotated[float, BeforeValidator(read_share)] = Field(0.0005, ge=0, le=1)
    #: of the bearings sought: share by which their damping at a speed may be another than the constant identified,
    #: smooth over speed; 0: it is constant
    damping_over_speed: Annotated[float, BeforeValidator(read_share)] = Field(0.1, ge=0, le=1)
    #: of the keyphasor's mark: how far from the shaft's axis it is, at the driven end, whose motion moves it past the
    #: probe; far off it does not move
    mark_radius: Annotated[Length, Field(gt=0)] = 0.015
    line_hum: Length = 0.2e-6  # 0-peak, mains hum in a probe
