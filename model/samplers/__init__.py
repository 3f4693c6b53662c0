"""The samplers by kind: the object that holds a sampler's settings is the sampler.

A kind is a module with a subclass of `Sampler`, and its name in `Kinds`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, get_args

from pydantic import Field, TypeAdapter

from model.samplers.base import Sampler
from model.samplers.blocked import Blocked
from model.samplers.collapsed import Collapsed
from model.samplers.mixing import Mixing

Kinds = Blocked | Collapsed | Mixing
AnySampler = Annotated[Kinds, Field(discriminator="kind")]
SAMPLERS: dict[str, type[Sampler[Any]]] = {kind.model_fields["kind"].default: kind for kind in get_args(Kinds)}

__all__ = ["SAMPLERS", "AnySampler", "Blocked", "Collapsed", "Mixing", "Sampler", "sampler_of"]


def sampler_of(settings: Mapping[str, Any]) -> Sampler[Any]:
    """Build the sampler of the kind that plain settings name.

    Raises:
        ValueError: The kind is unknown, or as for `Sampler`.
    """
    return TypeAdapter[Kinds](AnySampler).validate_python(settings)
