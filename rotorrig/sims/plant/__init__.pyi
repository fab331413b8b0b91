from .draw import draw as draw
from .draw import expected_estimates as expected_estimates
from .plant import Plant as Plant
from .sealed_truth import seal as seal
from .sealed_truth import unseal as unseal
from .truth import FaultSpec as FaultSpec
from .truth import Truth as Truth
