"""Lenses of the packages rayoptics and optiland, in JSON, and of ISET, in rows."""

from __future__ import annotations

import copy
import json
from typing import Any

import pytest

from render.errors import InputError
from render.model.lens import Across, Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.paraxial import first_order

# Cooke triplet of optiland's samples: radius, thickness, glass (SK16 of Hikari, F2 of Schott).
TRIPLET = (
    (22.01359, 3.25896, "SK16"),
    (-435.76044, 6.00755, ""),
    (-22.21328, 0.99997, "F2"),
    (20.29192, 4.75041, ""),
    (79.6836, 2.95208, "SK16"),
    (-18.39533, 42.20778, ""),
)
MAKERS = {"SK16": "hikari", "F2": "schott"}
STOP = 3


def _read(model: Any, name: str) -> Prescription:
    return parse_lens_file(json.dumps(model).encode(), name)


def _optiland() -> dict[str, Any]:
    def surface(radius: float, thickness: float, glass: str, z: float, stop: bool) -> dict[str, Any]:
        air = {"type": "IdealMaterial", "index": 1.0, "absorp": 0.0}
        material = {"type": "Material", "name": glass, "reference": MAKERS.get(glass)}
        return {
            "type": "Surface",
            "thickness": thickness,
            "geometry": {"type": "StandardGeometry", "cs": _axis(z), "radius": radius, "conic": 0.0},
            "material_post": material if glass else air,
            "is_stop": stop,
            "aperture": None,
            "interaction_model": {"type": "RefractiveReflectiveModel", "is_reflective": False},
        }

    z, surfaces = 0.0, [{"type": "ObjectSurface", "geometry": {"type": "Plane", "cs": _axis(float("-inf"))}}]
    for i, (radius, thickness, glass) in enumerate(TRIPLET):
        surfaces.append(surface(radius, thickness, glass, z, i == STOP))
        z += thickness
    surfaces.append(surface(float("inf"), 0.0, "", z, False))
    return {
        "version": 1.0,
        "name": "Cooke triplet",
        "aperture": {"type": "EPD", "value": 10},
        "surface_group": {"surfaces": surfaces},
    }


def _axis(z: float) -> dict[str, Any]:
    return {"x": 0.0, "y": 0.0, "z": z, "rx": 0.0, "ry": 0.0, "rz": 0.0, "reference_cs": None}


def _object(module: str, name: str, **attributes: Any) -> dict[str, Any]:
    return {"__instance_type__": [module, name], "attributes": attributes}


def _rayoptics() -> dict[str, Any]:
    air = _object("opticalglass.opticalmedium", "Air")
    makers = {"hikari": "HikariGlass", "schott": "SchottGlass"}
    faces = [_face("dummy", 0)]
    gaps = [_object("rayoptics.seq.gap", "Gap", thi=1e11, medium=air)]
    profiles = {"0": _object("rayoptics.elem.profiles", "Spherical", cv=0.0)}
    for i, (radius, thickness, glass) in enumerate(TRIPLET, 1):
        profiles[str(i)] = _object("rayoptics.elem.profiles", "Spherical", cv=1 / radius)
        faces.append(_face("transmit", i))
        medium = _object("opticalglass", makers[MAKERS[glass]], gname=glass, coefs=[1.0]) if glass else air
        gaps.append(_object("rayoptics.seq.gap", "Gap", thi=thickness, medium=medium))
    faces.append(_face("dummy", 0))
    sequence = _object("m", "SequentialModel", ifcs=faces, gaps=gaps, stop_surface=STOP + 1)
    pupil = _object("m", "PupilSpec", _key=["aperture", "object", "epd"], value=10.0)
    system = _object("m", "SystemSpec", title="Cooke triplet", _dimensions="mm")
    optics = _object("m", "OpticalSpecs", pupil=pupil)
    parts = {"system_spec": system, "seq_model": sequence, "optical_spec": optics, "profile_dict": profiles}
    return {"optical_model": _object("m", "OpticalModel", **parts)}


def _face(mode: str, profile: int) -> dict[str, Any]:
    numbers = {"decenter": None, "max_aperture": 1.0, "clear_apertures": [], "profile_id": str(profile)}
    return _object("m", "Surface", interact_mode=mode, **numbers)


def _sequence(model: dict[str, Any]) -> dict[str, Any]:
    return model["optical_model"]["attributes"]["seq_model"]["attributes"]


@pytest.mark.parametrize(
    ("model", "name"), [(_optiland(), "triplet.json"), (_rayoptics(), "triplet.roa"), (_rayoptics(), "triplet.json")]
)
def test_the_cooke_triplet_of_a_package(model: dict[str, Any], name: str) -> None:
    lens = _read(model, name)
    assert lens.name == "Cooke triplet"
    assert [s.radius_mm for s in lens.surfaces] == pytest.approx([row[0] for row in TRIPLET])
    assert [s.thickness_mm for s in lens.surfaces] == pytest.approx([row[1] for row in TRIPLET])
    assert [s.is_stop for s in lens.surfaces].index(True) == STOP
    # optiland 0.6.3 says f = 49.999783 mm at 0.55 um, and n = 1.62040889 and 1.62004014 at 0.5875618 um.
    assert first_order(lens, 550.0).focal_length_mm == pytest.approx(49.999783, rel=1e-5)
    assert [lens.surfaces[i].glass.index for i in (0, 2)] == pytest.approx([1.62040889, 1.62004014], abs=1e-6)
    assert lens.f_stop == pytest.approx(first_order(lens).focal_length_mm / 10)


def test_optiland_aspheres_model_glass_and_rims() -> None:
    model = _optiland()
    surface = model["surface_group"]["surfaces"][1]
    surface["geometry"] |= {"type": "EvenAsphere", "conic": -0.5, "coefficients": [0.0, 1e-6, 2e-9]}
    surface["material_post"] = {"type": "AbbeMaterial", "index": 1.62, "abbe": 60.3}
    surface["aperture"] = {"type": "RadialAperture", "r_max": 8.5, "r_min": 0.0}
    model["aperture"] = {"type": "imageFNO", "value": 5.6}
    lens = _read(model, "a.json")
    first = lens.surfaces[0]
    assert (first.conic, first.aspheric, first.semi_diameter_mm) == (-0.5, (1e-6, 2e-9), 8.5)
    assert (first.glass.index, first.glass.abbe) == (1.62, 60.3)
    assert lens.f_stop == 5.6


def test_optiland_tori() -> None:
    model = _optiland()
    geometry = model["surface_group"]["surfaces"][1]["geometry"]
    geometry |= {"type": "ToroidalGeometry", "radius_rotation": 60.0, "radius_yz": 22.0, "conic_yz": -0.5}
    geometry |= {"coeffs_poly_y": [0.0, 1e-6], "geometry_type": "Toroidal"}
    del geometry["radius"], geometry["conic"]
    first = _read(model, "a.json").surfaces[0]
    assert (first.radius_mm, first.conic, first.across) == (22.0, -0.5, Across(60.0, 0.0, "upright"))
    assert first.aspheric == (1e-6,)


def test_odd_aspheres_of_packages_have_every_power() -> None:
    coefficients = [0.0, 0.0, 1e-5, 2e-6, -3e-8]
    model = _optiland()
    model["surface_group"]["surfaces"][1]["geometry"] |= {"type": "OddAsphere", "coefficients": coefficients}
    other = _rayoptics()
    profiles = other["optical_model"]["attributes"]["profile_dict"]
    profiles["1"] = _object("m", "RadialPolynomial", cv=1 / 22.01359, cc=0.0, coefs=coefficients)
    for surface in (_read(model, "a.json").surfaces[0], _read(other, "a.roa").surfaces[0]):
        assert (surface.odd, surface.aspheric) == ((1e-5, -3e-8), (2e-6,))


def test_optiland_places_give_thicknesses_of_older_files() -> None:
    model = _optiland()
    for surface in model["surface_group"]["surfaces"][1:]:
        del surface["thickness"]
    lens = _read(model, "a.json")
    assert [s.thickness_mm for s in lens.surfaces] == pytest.approx([row[1] for row in TRIPLET])


def test_rayoptics_aspheres_media_and_rims() -> None:
    model = _rayoptics()
    profiles = model["optical_model"]["attributes"]["profile_dict"]
    profiles["1"] = _object("m", "EvenPolynomial", cv=1 / 22.01359, cc=-0.5, coefs=[0.0, 1e-6, 2e-9])
    profiles["2"] = _object("m", "RadialPolynomial", cv=-1 / 435.7604, ec=0.0, coefs=[0.0])
    profiles["3"] = _object("m", "RadialPolynomial", cv=-1 / 22.21328, ec=0.75, coefs=[0.0, 0.0, 0.0, 3e-6])
    sequence = _sequence(model)
    sequence["ifcs"][1]["attributes"]["clear_apertures"] = [_object("m", "Circular", radius=8.5, x_offset=0.0)]
    sequence["gaps"][1]["attributes"]["medium"] = _object("m", "ModelGlass", label="", n=1.62, v=60.3)
    wvls, rndx = [656.27, 587.56, 486.13], [1.6150, 1.6200, 1.6320]
    sequence["gaps"][5]["attributes"]["medium"] = _object("m", "InterpolatedMedium", label="x", wvls=wvls, rndx=rndx)
    lens = _read(model, "a.roa")
    assert (lens.surfaces[0].conic, lens.surfaces[0].aspheric) == (-0.5, (1e-6, 2e-9))
    assert lens.surfaces[1].conic == -1  # a paraboloid
    assert (lens.surfaces[2].conic, lens.surfaces[2].aspheric) == (-0.25, (3e-6,))
    assert lens.surfaces[0].semi_diameter_mm == 8.5
    assert lens.surfaces[1].semi_diameter_mm == 0  # 1 is what nobody computed
    assert (lens.surfaces[0].glass.index, lens.surfaces[0].glass.abbe) == (1.62, 60.3)
    assert lens.surfaces[4].glass.index == pytest.approx(1.62, abs=1e-4)


def _change(path: str, value: Any) -> Any:
    return path.split("/"), value


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_change("surface_group/surfaces/2/interaction_model/is_reflective", True), "surface 2: mirrors"),
        (_change("surface_group/surfaces/2/geometry/cs/rx", 0.1), r"surface 2: tilts and decentres \(rx\)"),
        (_change("surface_group/surfaces/3/geometry/type", "ZernikePolynomialGeometry"), "surface 3: surfaces of type"),
        (_change("surface_group/surfaces/3/geometry/radius", "wide"), "geometry.radius: expected a number"),
        (_change("surface_group/surfaces/1/material_post/name", "XYZZY"), "surface 1: glass XYZZY is in no catalogue"),
        (_change("surface_group/surfaces/1/material_post/type", "Mirror"), "surface 1: media of the types"),
        (_change("surface_group/surfaces/1/thickness", float("nan")), "thickness: expected a number"),
        (_change("surface_group/surfaces", 3), "surface_group.surfaces: expected a list"),
        (_change("surface_group/surfaces", []), "expected an object, at least one surface and an image"),
        (_change("surface_group", None), "expected an object, at least one surface and an image"),
    ],
)
def test_what_is_wrong_in_an_optiland_file_is_named(change: tuple[list[str], Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        _read(_changed(_optiland(), *change), "a.json")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_change("ifcs/2/attributes/interact_mode", "reflect"), r"surface 2: mirrors \(reflect\)"),
        (_change("ifcs/2/attributes/decenter", {"x": 1}), "surface 2: tilts and decentres"),
        (_change("ifcs/2/attributes/phase_element", {"x": 1}), "surface 2: diffractive surfaces"),
        (_change("ifcs/2/__instance_type__", ["m", "ThinLens"]), "surface 2: ideal lenses without glass"),
        (_change("ifcs/2/attributes/profile_id", "77"), "surface 2: surfaces of profile .* got none"),
        (_change("gaps/1/attributes/medium/attributes/gname", "XYZZY"), "surface 1: glass XYZZY is in no catalogue"),
        (
            _change("gaps/1/attributes/medium/__instance_type__", ["m", "Wool"]),
            "surface 1: glass SK16|media of the kind",
        ),
        (_change("gaps/1/attributes/thi", "far"), r"gaps\[1\]\.thi: expected a number"),
        (_change("gaps", []), "expected an object, at least one surface and an image, and a gap"),
        (_change("stop_surface", "x"), "stop_surface: expected a number"),
    ],
)
def test_what_is_wrong_in_a_rayoptics_file_is_named(change: tuple[list[str], Any], message: str) -> None:
    model = _rayoptics()
    _changed(_sequence(model), *change, in_place=True)
    if "Wool" in str(change[1]):
        del _sequence(model)["gaps"][1]["attributes"]["medium"]["attributes"]["gname"]
    with pytest.raises(InputError, match=message):
        _read(model, "a.roa")


def _changed(model: dict[str, Any], path: list[str], value: Any, in_place: bool = False) -> dict[str, Any]:
    model = model if in_place else copy.deepcopy(model)
    part: Any = model
    for key in path[:-1]:
        part = part[int(key)] if isinstance(part, list) else part[key]
    part[path[-1]] = value
    return model


@pytest.mark.parametrize(
    "text", ["", "{", "[" * 100_000, '{"optical_model": 1}', "null", "3", '{"a": ' + "9" * 5000 + "}"]
)
def test_json_of_no_lens_is_one_error(text: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_lens_file(text.encode(), "a.roa")
    assert caught.value.code == "bad_lens_file"
    assert "\n" not in caught.value.detail


ISET = """\
# Name: dgauss.22deg.{name}
# Description: multi element lens
# Focal length (mm)
{focal}
# Each row is a surface.
#    radius\t axpos\tN\taperture
29.475000\t3.760000\t1.670000\t25.200000
84.830000\t0.120000\t1.000000\t25.200000
19.275000\t4.025000\t1.670000\t23.000000
40.770000\t3.275000\t1.699000\t23.000000
12.750000\t5.705000\t1.000000\t19.000000
0.000000\t4.500000\t0.000000\t17.050000
-14.495000\t1.180000\t1.603000\t17.000000
40.770000\t6.065000\t1.658000\t20.000000
-20.385000\t0.190000\t1.000000\t20.000000
437.065000\t3.220000\t1.717000\t20.000000
-39.730000\t0.000000\t1.000000\t20.000000
"""


def test_a_lens_of_iset_has_its_focal_length_above() -> None:
    lens = parse_lens_file(ISET.format(name="50mm", focal="50.000").encode(), "dgauss.dat")
    assert len(lens.surfaces) == 11
    assert lens.name == "dgauss.22deg.50mm"
    assert not any("The file says" in note for note in lens.notes)
    scaled = parse_lens_file(ISET.format(name="6mm", focal="6").encode(), "dgauss.dat")
    assert any(note.startswith("The file says 6 mm; the focal length of its surfaces is ") for note in scaled.notes)


def test_a_stop_of_iset_may_stand_in_a_medium() -> None:
    eye = "16\n7.8 0.55 1.3771 7.8\n6.5 3.05 1.3374 7.8\n0 0 0 10.2\n10.2 4 1.42 10.2\n-6 10 1 6\n"
    lens = parse_lens_file(eye.encode(), "eye.dat")
    assert lens.surfaces[2].is_stop
    assert lens.surfaces[2].glass.index == 1.3374


def test_a_second_lone_number_is_an_error() -> None:
    with pytest.raises(InputError, match="line 2, surface 1: a row has radius, thickness, index and diameter, got 1"):
        parse_lens_file(b"50\n50\n10 3 1.5 5\n-10 0 1 5\n", "a.dat")
