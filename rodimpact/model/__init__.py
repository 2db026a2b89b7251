"""The description of a collision: materials, bodies, contact laws, ends, and rows of them."""

from .bodies import Body, Material, RigidMass, Rod, Segment, Wall
from .ends import ENDS, Absorbing, End, Fixed, Free, Moved, Pushed
from .frozen import InvalidModel
from .laws import (
    CONTACT_LAWS,
    Bonded,
    ContactLaw,
    Hertz,
    HuntCrossley,
    PowerLaw,
    Rigid,
    Spring,
    SpringDashpot,
)
from .profiles import Profile, Samples, Steps
from .system import SIDES, System

__all__ = [
    "CONTACT_LAWS", "ENDS", "SIDES", "Absorbing", "Body", "Bonded", "ContactLaw", "End", "Fixed",
    "Free", "Hertz", "HuntCrossley", "InvalidModel", "Material", "Moved", "PowerLaw", "Profile",
    "Pushed", "Rigid", "RigidMass", "Rod", "Samples", "Segment", "Spring", "SpringDashpot", "Steps",
    "System", "Wall",
]
