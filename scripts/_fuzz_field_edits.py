"""Changes of files of the tools of marine people: XML, netCDF, lines of NMEA 0183."""

from __future__ import annotations

import tempfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from _fuzz_field import nmea_line
from _fuzz_mutate import bytes_edit, changed_or_bytes, pick, text_edit
from _fuzz_values import json_text, odd, scaled

_DOORS = (
    b'<!DOCTYPE route [<!ENTITY a "x">]>',
    b'<!DOCTYPE route [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    b'<!DOCTYPE route SYSTEM "http://127.0.0.1:9/a.dtd">',
    b'<!DOCTYPE z [<!ENTITY a "' + b"x" * 1000 + b'"><!ENTITY b "' + b"&a;" * 1000 + b'">]>',
)


def xml_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """An attribute or element changed, left out, repeated or renamed; a door to other files."""
    how = rng.random()
    if how < 0.2:
        return text_edit(rng, data)
    if how < 0.25:
        head, mark, rest = data.partition(b"?>")
        return head + mark + pick(rng, _DOORS) + rest.replace(b'"a"', b'"&a;"')
    try:
        root = ElementTree.fromstring(data)
        _element_edit(rng, root)
        return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    except Exception:  # broken by an earlier edit, or a name that XML does not have
        return text_edit(rng, data)


def _element_edit(rng: np.random.Generator, root: ElementTree.Element) -> None:
    parents = [(parent, k) for parent in root.iter() for k in range(len(parent))]
    valued = [one for one in root.iter() if one.attrib]
    how = rng.random()
    if how < 0.6 and valued:
        one = pick(rng, valued)
        _attribute_edit(rng, one, pick(rng, sorted(one.attrib)))
    elif how < 0.7 and parents:
        parent, k = pick(rng, parents)
        del parent[k]
    elif how < 0.8 and parents:
        parent, k = pick(rng, parents)
        parent.insert(k, parent[k])
    elif how < 0.85 and len(parents) > 1:
        (parent, k), (other, _) = pick(rng, parents), pick(rng, parents)
        if other not in list(parent[k].iter()):
            other.append(parent[k])
    elif how < 0.93:
        one = pick(rng, list(root.iter()))
        one.tag = pick(rng, (one.tag.rpartition("}")[2], one.tag + "s", "{urn:x}waypoint", "leg"))
    else:
        pick(rng, list(root.iter())).text = _text(odd(rng))


def _attribute_edit(rng: np.random.Generator, one: ElementTree.Element, name: str) -> None:
    value, how = one.attrib[name], rng.random()
    if how < 0.15:
        del one.attrib[name]
    elif how < 0.25:
        one.attrib[pick(rng, (name[:-1] or "a", name.upper(), "x" * 300))] = one.attrib.pop(name)
    elif how < 0.6:
        try:
            one.attrib[name] = str(scaled(rng, float(value)))
        except ValueError:
            one.attrib[name] = pick(rng, ("", value.lower(), value * 50, value[:-1]))
    else:
        one.attrib[name] = _text(odd(rng))


def _text(value: object) -> str:
    text = str(value) if isinstance(value, str | float) else json_text(value)
    return text.replace("\x00", "")[:5000]


# --- netCDF --------------------------------------------------------------------------------------

_UNITS = ("", "furlong", "m2/Hz/deg", "degree", "rad", "1", "Hz", "s", "\u00e9", "m" * 400, 7, None)


def netcdf_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A variable, its numbers, unit, dimension or type changed; or other bytes."""
    return changed_or_bytes(rng, data, _changed)


def _changed(rng: np.random.Generator, data: bytes) -> bytes:
    import xarray

    engine = "scipy" if data[:3] == b"CDF" else "h5netcdf"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.nc"
        path.write_bytes(data)
        with xarray.open_dataset(path, engine=engine, decode_times=False) as opened:
            found = opened.load()
        name = pick(rng, sorted(map(str, found.variables)))
        found = _dataset_edit(rng, found, name)
        path.unlink()
        found.to_netcdf(path, engine=engine)
        return path.read_bytes()


def _dataset_edit(rng: np.random.Generator, found, name: str):
    one, how = found[name], rng.random()
    if how < 0.2:
        unit = pick(rng, _UNITS)
        key = pick(rng, ("units", "standard_name", "_FillValue", "scale_factor"))
        one.attrs.pop(key, None) if unit is None else one.attrs.update({key: unit})
        return found
    if how < 0.3:
        return found.drop_vars(name)
    if how < 0.4:
        return found.rename({name: pick(rng, ("x", "direction", "frequency", "efth", "time"))})
    if how < 0.5:
        dim = pick(rng, sorted(map(str, found.sizes)))
        return found.isel({dim: slice(0, int(rng.integers(found.sizes[dim] + 1)))})
    if how < 0.55:
        return found.isel({pick(rng, sorted(map(str, found.sizes))): 0})
    values = np.array(one.values, dtype=float)
    if how < 0.75 and values.size:
        fill = pick(rng, (np.nan, np.inf, -1.0, 0.0, 1e300, 1e-300))
        values.flat[int(rng.integers(values.size)) :: pick(rng, (1, 7, values.size))] = fill
    elif how < 0.85:
        values = values[..., ::-1]
    else:
        values = values * pick(rng, (0.0, -1.0, 1e-9, 1e3, 1e9, 1e200))
    kind = pick(rng, ("f8", "f8", "f4", "i4", "S4"))
    with np.errstate(all="ignore"):
        values = values.astype(kind)
    return found.assign({name: (one.dims, values, one.attrs)})


# --- NMEA 0183 -----------------------------------------------------------------------------------

_FIELDS = (
    b"", b" ", b"-", b"nan", b"inf", b"1e9", b"-1", b"360", b"361", b"720.5", b"999999999", b"T",
    b"M", b"V", b"A", b"L", b"R", b"0x1", b"1.2.3", b"9" * 60, b"\xc3\xa9", b"*", b"$", b"\\",
)  # fmt: skip
_KINDS = (b"HTC", b"HSC", b"ROR", b"APB", b"HTD", b"RSA", b"XXX", b"VDM", b"TTM", b"P", b"")


def nmea_edit(rng: np.random.Generator, data: bytes) -> bytes:
    """A field, the talker or the kind of a sentence changed, with the checksum put right or not."""
    if rng.random() < 0.2:
        return bytes_edit(rng, data)
    lines = data.split(b"\r\n")
    k, how = int(rng.integers(len(lines))), rng.random()
    body, star, check = lines[k].lstrip(b"$").partition(b"*")
    fields = body.split(b",")
    j = int(rng.integers(len(fields)))
    if how < 0.5:
        fields[j] = pick(rng, _FIELDS)
    elif how < 0.6:
        del fields[j]
    elif how < 0.7:
        fields[j:j] = [pick(rng, _FIELDS)] * pick(rng, (1, 2, 30))
    elif how < 0.85:
        fields[0] = pick(rng, (b"AG", b"GP", b"", b"P", b"\xff\xff")) + pick(rng, _KINDS)
    elif how < 0.9:
        check = pick(rng, (b"", b"0", b"ZZ", b"00", b"000"))
        lines[k] = b"$" + body + star + check
        return b"\r\n".join(lines)
    else:
        lines.insert(k, lines[k] * 2)
        return b"\r\n".join(lines)
    lines[k] = nmea_line(b",".join(fields)).rstrip(b"\r\n")
    return b"\r\n".join(lines)
