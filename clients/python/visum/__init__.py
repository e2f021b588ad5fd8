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
from visum.part import Part
from visum.ports import Inputs, Outputs, Port
from visum.program import exit_code_of
from visum.world import Body, Contact, Joint, World, WorldView

if TYPE_CHECKING:
    from visum.kinematics import Chain, ChainJoint, InverseSolution, Pose
    from visum.launching import LaunchedClient, launch
    from visum.model_gathering import model_files

__all__ = ["Body", "Chain", "ChainJoint", "Client", "Contact", "Error", "ErrorCode", "Inputs", "InverseSolution", "Joint",
           "LaunchedClient", "Outputs", "Part", "Port", "Pose", "ServerInfo",
           "SpawnedModel", "World", "WorldView", "exit_code_of", "launch", "model_files"]
__version__ = "0.2.0"


# Names and their modules, which are loaded where they are asked for: most controllers need none of them, and
# would wait for the import.
_LATER = {"Chain": "kinematics", "ChainJoint": "kinematics", "InverseSolution": "kinematics", "Pose": "kinematics",
          "LaunchedClient": "launching", "launch": "launching", "model_files": "model_gathering"}


def __getattr__(name: str) -> object:
    from importlib import import_module

    if name == "kinematics":  # the module itself, as before it was loaded late
        return import_module("visum.kinematics")
    if name not in _LATER:
        raise AttributeError(f"module 'visum' has no attribute '{name}'")
    return getattr(import_module(f"visum.{_LATER[name]}"), name)
