from .certificate import Certificate as Certificate
from .certificate import Proof as Proof
from .certificate import Verdict as Verdict
from .certificate import certificate_facts as certificate_facts
from .certificate import certificate_file as certificate_file
from .certificate import read_certificate as read_certificate
from .certificate import write_certificate as write_certificate
from .devices import Devices as Devices
from .devices import Opened as Opened
from .devices import RigDevices as RigDevices
from .plan import plan_proof_test as plan_proof_test
from .plan import proof_speed as proof_speed
from .proof import PARTS as PARTS
from .proof import prove_protections as prove_protections

__all__ = [
    "PARTS",
    "Certificate",
    "Devices",
    "Opened",
    "Proof",
    "RigDevices",
    "Verdict",
    "certificate_facts",
    "certificate_file",
    "plan_proof_test",
    "proof_speed",
    "prove_protections",
    "read_certificate",
    "write_certificate",
]
