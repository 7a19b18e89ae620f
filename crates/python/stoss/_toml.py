"""Scenes as dicts into TOML."""

import json
import math
import numbers


def _key(name):
    plain = name and all(c.isascii() and (c.isalnum() or c in "-_") for c in name)
    return name if plain else json.dumps(name, ensure_ascii=False)


def _value(value, place):
    if hasattr(value, "tolist"):  # NumPy's arrays and numbers.
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # TOML's escapes are those of JSON, but for the character 127.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        value = float(value)
        if math.isnan(value):
            return "nan"
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return repr(value)
    if isinstance(value, dict):
        items = (f"{_key(k)} = {_value(v, f'{place}.{k}')}" for k, v in value.items() if v is not None)
        return "{ " + ", ".join(items) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(v, f"{place}[{i}]") for i, v in enumerate(value)) + "]"
    raise TypeError(f"{place}: a {type(value).__name__} cannot be part of a scene: give numbers, texts, lists, dicts, arrays or meshes")


def dumps(scene):
    """The text of a scene: a table for each dict, a ``[[table]]`` for each dict in a list. Keys whose value is None are left out."""
    lines = []
    for name, value in scene.items():
        if value is None:
            continue
        is_list = isinstance(value, (list, tuple)) and value and all(isinstance(v, dict) for v in value)
        tables = value if is_list else [value]
        for number, table in enumerate(tables):
            if not isinstance(table, dict):
                lines.insert(0, f"{_key(name)} = {_value(table, name)}")
                continue
            lines.append(f"[[{_key(name)}]]" if is_list else f"[{_key(name)}]")
            place = f"{name}[{number}]" if is_list else name
            lines += [f"{_key(k)} = {_value(v, f'{place}.{k}')}" for k, v in table.items() if v is not None]
            lines.append("")
    return "\n".join(lines) + "\n"
