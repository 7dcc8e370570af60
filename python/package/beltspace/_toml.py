"""Dictionaries as the text of a study file or of a model's file.

Every value stands on the line of its key: the order of axes is that of the dictionary, which decides how designs are numbered.
"""

import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np


def _text(text: str) -> str:
    # TOML escapes as JSON does, and DEL besides.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _key(key: object) -> str:
    name = str(key)
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _inline(value: Any, place: str) -> str:
    """A value on one line; numpy's numbers and arrays are numbers and lists."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Mapping):
        parts = [f"{_key(key)} = {_inline(it, f'{place}.{key}')}" for key, it in value.items()]
        return "{ " + ", ".join(parts) + " }" if parts else "{}"
    if isinstance(value, np.ndarray | list | tuple | range):
        return "[" + ", ".join(_inline(it, place) for it in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, int | float):
        return repr(value)
    raise TypeError(f"{place}: {type(value).__name__} has no form in a study; give a number, a text, a list or a dictionary")


def _file(content: Mapping[str, Any]) -> str:
    lines = [f"{_key(key)} = {_inline(value, str(key))}" for key, value in content.items() if not isinstance(value, Mapping)]
    for name, table in content.items():
        if isinstance(table, Mapping):
            lines += ["", f"[{_key(name)}]"]
            lines += [f"{_key(key)} = {_inline(value, f'{name}.{key}')}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def text_of_study(study: Mapping[str, Any]) -> str:
    """The text of a study file."""
    return _file(study)


def text_of_model(parts: Mapping[str, Any]) -> str:
    """The text of a model's file. Parts that are None are left out; outputs may be a list of names."""
    given = {key: value for key, value in parts.items() if value is not None}
    if isinstance(given.get("outputs"), list | tuple):
        given["outputs"] = {name: "" for name in given["outputs"]}
    return _file(given)
