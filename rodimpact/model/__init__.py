"""The description of a collision: materials, bodies, contact laws, ends and systems."""

from .bodies import Body, Material, RigidMass, Rod, Segment, Wall
from .drag import Drag
from .ends import Absorbing, End, Fixed, Free, Incoming, Moved, Pushed
from .frozen import InvalidModel
from .laws import Bonded, ContactLaw, Joint, Law, Plastic, Rigid, Tabulated, Yielding
from .profiles import Polynomials, Samples, Steps
from .soil import Soil
from .system import GAP, SIDES, System

__all__ = [
    "GAP",
    "SIDES",
    "Absorbing",
    "Body",
    "Bonded",
    "ContactLaw",
    "Drag",
    "End",
    "Fixed",
    "Free",
    "Incoming",
    "InvalidModel",
    "Joint",
    "Law",
    "Material",
    "Moved",
    "Plastic",
    "Polynomials",
    "Pushed",
    "Rigid",
    "RigidMass",
    "Rod",
    "Samples",
    "Segment",
    "Soil",
    "Steps",
    "System",
    "Tabulated",
    "Wall",
    "Yielding",
]
