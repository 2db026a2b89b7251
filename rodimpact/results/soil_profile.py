"""The soil along the shaft of a rod at one time of a run."""

from typing import NamedTuple

from ..hints import explain_missing
from ..methods.signals import Floats
from ..model import Rod, Soil
from .fields import Fields
from .grid_fields import GridFields


@explain_missing()
class SoilProfile(NamedTuple):
    """Soil along a rod at one time, at the nodes of the mesh, [n] each.

    Attributes
    ----------
    x : array
        Positions, m from the left end of the rod.
    resistance : array
        Ultimate resistance R_u of the soil around each node, N. The sum is the
        resistance of the rod.
    mobilised : array
        Mobilised share R/R_u of the resistance, from -1 to 1; 0 without soil. It is
        positive if the soil pushes the rod to the left.
    displacement : array
        Displacement of the rod since t = 0, m.
    plastic_set : array
        Plastic displacement of the soil since t = 0, m: the displacement minus its
        elastic part, which is the quake times the change of the share.

    Examples
    --------
    >>> import rodimpact as ri
    >>> soil = ri.Soil(resistance=400e3, quake=2.5e-3)
    >>> steel = ri.materials.steel
    >>> pile = ri.Rod(15.0, area=0.0094, material=steel, velocity=2.0, shaft=soil)
    >>> profile = ri.solve(ri.System([pile]), until=3e-3, cells=50).soil(0, 3e-3)
    >>> bool(profile.mobilised.max() == 1.0 and profile.plastic_set.min() > 0)
    True
    """

    x: Floats
    resistance: Floats
    mobilised: Floats
    displacement: Floats
    plastic_set: Floats


def soil_profile(fields: Fields, body: int, tick: int) -> SoilProfile:
    """Soil about the nodes of a rod whose `shaft` is `Soil`, at `tick`, on a grid.

    The displacement is relative to t = 0. The plastic set is the displacement minus the
    quake times the growth of the mobilised share since t = 0; it is 0 at nodes without
    soil.
    """
    assert isinstance(fields, GridFields)  # no other method has soil
    rod = fields.clock.system.bodies[body]
    assert isinstance(rod, Rod)
    assert isinstance(rod.shaft, Soil)
    at_start = fields.soil_at_nodes(body, 0)  # at the tick 0
    now = fields.soil_at_nodes(body, tick)
    x = now.places
    times = [0.0, tick * fields.clock.tick]
    displacements = fields.displacement(body, x[:, None], times)  # [node, time]
    since_start = displacements[:, 1] - displacements[:, 0]
    elastic = float(rod.shaft.quake) * (now.mobilised - at_start.mobilised)
    plastic_set = since_start - elastic
    plastic_set[now.ultimate == 0] = 0.0  # there is no soil that could yield
    return SoilProfile(
        x=x,
        resistance=now.ultimate,
        mobilised=now.mobilised,
        displacement=since_start,
        plastic_set=plastic_set,
    )
