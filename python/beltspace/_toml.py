"""Dictionaries as the text of a study file or of a model's file."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import tomli_w

# Keys of the file of a model that are tables.
_TABLES = ("inputs", "curves", "formulas", "conditions", "outputs", "presets")


def _plain(value: Any, place: str) -> Any:
    """A value that TOML has: numpy's numbers and arrays become numbers and lists."""
    if isinstance(value, Mapping):
        return {str(key): _plain(it, f"{place}.{key}" if place else str(key)) for key, it in value.items()}
    if isinstance(value, np.ndarray | list | tuple | range):
        return [_plain(it, place) for it in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str | bool | int | float):
        return value
    raise TypeError(f"{place}: {type(value).__name__} has no form in a study; give a number, a text, a list or a dictionary")


def text_of_study(study: Mapping[str, Any]) -> str:
    """The text of a study file."""
    return tomli_w.dumps(_plain(study, ""))


def text_of_model(parts: Mapping[str, Any]) -> str:
    """The text of a model's file. Parts that are None are left out; outputs may be a list of names."""
    given = {key: value for key, value in parts.items() if value is not None}
    if isinstance(given.get("outputs"), list | tuple):
        given["outputs"] = {name: "" for name in given["outputs"]}
    # Values stand before tables in a file.
    ordered = {key: given[key] for key in sorted(given, key=lambda key: key in _TABLES)}
    return tomli_w.dumps(_plain(ordered, ""))
