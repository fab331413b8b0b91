"""`Extension`: an effect added to the model of a nameplate, a table `[[effects]]` of the config.

It is plain data here; whoever uses it resolves the name, in sims/effects for a model, in sims/plant/faults for a
simulated rig, and says in one sentence what it has no effect for.
"""

from typing import Annotated, Self

from pydantic import AfterValidator, Field, Strict, model_validator

from rotorrig.rig.config.nameplate import Name, Part, Text, check_size

Number = Annotated[float, Strict(), AfterValidator(check_size)]  # SI: no text with a unit


class Extension(Part):
    """One effect at one place, with the values of its unknowns, SI."""

    name: Name  # "bow": a file in sims/effects
    where: Text = ""  # "plane 2"; empty if there is only one place
    parameters: dict[Name, Number]  # "bow re" -> value
    sigmas: dict[str, Annotated[Number, Field(ge=0)]] = Field(default_factory=dict)  # one standard deviation of each

    @property
    def label(self) -> str:
        """Name and place: "runout, plane 2"."""
        return f"{self.name}, {self.where}" if self.where else self.name

    @model_validator(mode="after")
    def _sigmas_are_of_parameters(self) -> Self:
        for name in self.sigmas:
            if name not in self.parameters:
                raise ValueError(f"sigmas: '{name}' is none of the parameters, want one of {sorted(self.parameters)}")
        return self
