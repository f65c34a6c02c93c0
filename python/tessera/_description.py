"""The meaning of a texture's coordinates and samples."""
from __future__ import annotations

import dataclasses
from typing import Tuple

from . import _library as lib

# In the order of their numbers in tessera.h, with the names that `tessera info` prints.
NAMES = {
    "proxy": ("none", "sphere", "mesh", "sphere-inside"),
    "surface_map": ("none", "sphere-longitude-latitude", "mesh-uv"),
    "angular_map": ("none", "hemisphere-alpha-beta", "planar-views", "octahedral-hemisphere",
                    "octahedral-mirrored"),
    "transfer": ("unspecified", "srgb", "linear"),
    "primaries": ("unspecified", "bt709"),
    "alpha": ("none", "straight", "premultiplied"),
}


@dataclasses.dataclass(frozen=True)
class Description:
    """What coordinates and samples mean (format/FORMAT.md, 1.1). The codec ignores it.

    proxy          the surface that u and v parametrise: "none", "sphere", "mesh", "sphere-inside"
    surface_map    how: "none", "sphere-longitude-latitude", "mesh-uv"
    angular_map    the directions of s and t: "none", "hemisphere-alpha-beta", "planar-views",
                   "octahedral-hemisphere", "octahedral-mirrored"
    transfer       "unspecified", "srgb", "linear"
    primaries      "unspecified", "bt709"
    alpha          "none", "straight", "premultiplied"
    sphere_centre  world units
    sphere_radius  world units; above 0 for a sphere, 0 for any other proxy
    viewing_radius least and greatest distance of viewers from the centre; (0, 0): no limits

    A value from a later version of the format reads as "unknown-NUMBER".
    """

    proxy: str = "none"
    surface_map: str = "none"
    angular_map: str = "none"
    transfer: str = "unspecified"
    primaries: str = "unspecified"
    alpha: str = "none"
    sphere_centre: Tuple[float, float, float] = (0.0, 0.0, 0.0)
    sphere_radius: float = 0.0
    viewing_radius: Tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        for member, names in NAMES.items():
            value = getattr(self, member)
            if value not in names and not str(value).startswith("unknown-"):
                raise ValueError(f"{member} is {value!r}; it can be {', '.join(names)}")
        for member, count in (("sphere_centre", 3), ("viewing_radius", 2)):
            if len(getattr(self, member)) != count:
                raise ValueError(f"{member} has {len(getattr(self, member))} numbers, not {count}")


def to_c(description: Description) -> lib.Description:
    numbers = {}
    for member, names in NAMES.items():
        value = getattr(description, member)
        numbers[member] = names.index(value) if value in names else int(value.rpartition("-")[2])
    return lib.Description(
        sphere_centre=tuple(description.sphere_centre), sphere_radius=description.sphere_radius,
        viewing_radius=tuple(description.viewing_radius), **numbers)


def from_c(found: lib.Description) -> Description:
    def name(member: str) -> str:
        number = getattr(found, member)
        names = NAMES[member]
        return names[number] if 0 <= number < len(names) else f"unknown-{number}"

    return Description(sphere_centre=tuple(found.sphere_centre), sphere_radius=found.sphere_radius,
                       viewing_radius=tuple(found.viewing_radius),
                       **{member: name(member) for member in NAMES})
