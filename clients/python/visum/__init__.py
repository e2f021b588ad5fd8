"""Visum's client for Python: connect to a server, find a hardware part, take its lease, write and read its ports.

    import visum

    with visum.Client("127.0.0.1:1500", name="my_script") as client:
        arm = client.part("arm")
        desired = arm.inputs("Desired Angle")
        actual = arm.outputs("Actual Angle")
        with arm.lease():
            client.join()
            while actual[0] < 0.5:
                desired[0] = actual[0] + 0.01
                arm.write()
                client.advance_ms(10)

visum.launch("scene.yaml") starts a server of its own first.

The verbs are those of the C++ library (clients/cpp/visum.h). Units are SI and radians. Time is simulated time since the
server's last reset. Calls block, and a Client and its Parts belong to one thread. Every failure raises visum.Error.
"""

from typing import TYPE_CHECKING

from visum.client import Client, ServerInfo, SpawnedModel
from visum.errors import Error, ErrorCode
from visum.kinematics import Chain, ChainJoint, InverseSolution, Pose
from visum.model_files import model_files
from visum.part import Part
from visum.ports import Inputs, Outputs, Port
from visum.program import exit_code_of
from visum.world import Body, Contact, Joint, World, WorldView

if TYPE_CHECKING:
    from visum.launching import LaunchedClient, launch

__all__ = ["Body", "Chain", "ChainJoint", "Client", "Contact", "Error", "ErrorCode", "Inputs", "InverseSolution", "Joint",
           "LaunchedClient", "Outputs", "Part", "Port", "Pose", "ServerInfo",
           "SpawnedModel", "World", "WorldView", "exit_code_of", "launch", "model_files"]
__version__ = "0.2.0"


def __getattr__(name: str) -> object:
    """Loads what starts a server where it is asked for: a controller needs none, and would wait for the import."""
    if name not in ("LaunchedClient", "launch"):
        raise AttributeError(f"module 'visum' has no attribute '{name}'")
    from visum import launching

    return getattr(launching, name)
