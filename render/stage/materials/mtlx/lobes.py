"""Surfaces that are built of lobes (MaterialX's physically based nodes), as the lobes that surfaces have here.

**Rules.** Diffuse lobes add up to one colour, subsurface and translucent ones among them. Specular lobes beside each other
become one of their joint reflectance at normal incidence, and of their mean roughness; one on top of another becomes the clear
coat. What is below a diffuse lobe or a metal is hidden by it, as in MaterialX's own code; below any other it is lit as if that
were not there, but for what Fresnel takes. Weights, tints, mixes and sums multiply and add reflectances. What is left out is
named.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from render.stage.materials.mtlx.arithmetic import (
    add,
    as_operand,
    at_most_one,
    complement,
    component,
    constant,
    divide,
    held,
    mean,
    multiply,
    power,
    reflectance,
    same,
)
from render.stage.materials.mtlx.library import library
from render.stage.materials.mtlx.network import Input, Network, NetworkError, Node
from render.stage.materials.mtlx.opacity import is_used
from render.stage.materials.mtlx.values import WIDTHS, numbers_of

_COAT_REFLECTANCE = 0.04
_ANISOTROPIC = "roughness_anisotropy"


@dataclass(frozen=True)
class Lobes:
    """Sum of lobes. None is nothing.

    Attributes:
        diffuse: albedo.
        f0: reflectance at normal incidence of what is no metal.
        metal: that of metals.
        roughness: of the specular lobe; alpha is its square.
        normal: in the world; None for the surface's own.
        coat: amount of a clear coat of index 1.5 that reflects as much.
        coat_roughness: likewise.
        through: share that comes from behind, by colour.
        through_weight: that share before it is coloured.
        sheen: colour of the sheen, times its weight.
        sheen_weight: its weight.
        sheen_roughness: likewise.
        is_fuzz: 1 where the sheen is Zeltner's, else 0.
        film: thickness in nm and index of the thin film on the specular lobe.
        cover: share of what is below that is hidden.
    """

    diffuse: Input | None = None
    f0: Input | None = None
    metal: Input | None = None
    roughness: Input | None = None
    normal: Input | None = None
    coat: Input | None = None
    coat_roughness: Input | None = None
    through: Input | None = None
    through_weight: Input | None = None
    sheen: Input | None = None
    sheen_weight: Input | None = None
    sheen_roughness: Input | None = None
    is_fuzz: Input | None = None
    film: tuple[Input, Input] | None = None
    cover: Input | None = None

    @property
    def is_specular(self) -> bool:
        """Whether it has a specular lobe."""
        return self.f0 is not None or self.metal is not None

    @property
    def is_empty(self) -> bool:
        """Whether it has no lobe at all."""
        return not self.is_specular and all(
            each is None for each in (self.diffuse, self.coat, self.through, self.sheen, self.cover)
        )

    def scale(self, by: Input | None) -> Lobes:
        """Lobes times a weight or a colour; what they hide stays."""
        if by is None:
            return Lobes(cover=self.cover)
        level = mean(by)
        return replace(
            self,
            diffuse=multiply(self.diffuse, by),
            f0=multiply(self.f0, by),
            metal=multiply(self.metal, by),
            coat=multiply(self.coat, level),
            through=multiply(self.through, by),
            through_weight=multiply(self.through_weight, level),
            sheen=multiply(self.sheen, by),
            sheen_weight=multiply(self.sheen_weight, level),
        )


@dataclass(frozen=True)
class Reduced:
    """Network of the surface that is drawn in place of one of lobes.

    Attributes:
        network: its surface is a ``surface`` of `SURFACES`.
        left_out: what is not drawn, for messages.
    """

    network: Network
    left_out: tuple[str, ...]


def reduce_surface(network: Network) -> Reduced:
    """Reduce a network whose surface is a ``surface`` node to the lobes that are drawn.

    Raises:
        NetworkError: none of its lobes can be drawn.
    """
    list(network.nodes())  # refuses circles
    reducer = _Reducer()
    given = network.surface.inputs
    lobes, emission = reducer.bsdf(given.get("bsdf")), reducer.edf(given.get("edf"))
    if lobes.is_empty and emission is None:
        raise NetworkError(f"it has no lobes that can be drawn {' '.join(reducer.left_out)[:200]}".rstrip(" ,"))
    found = {
        "diffuse": lobes.diffuse,
        "f0": lobes.f0,
        "metal": lobes.metal,
        "roughness": lobes.roughness if lobes.is_specular else constant(1.0),
        "normal": lobes.normal,
        "coat": lobes.coat,
        "coat_roughness": lobes.coat_roughness,
        "through": lobes.through,
        "through_weight": lobes.through_weight,
        "emission": emission,
        "opacity": given.get("opacity"),
        "sheen": lobes.sheen,
        "sheen_weight": lobes.sheen_weight,
        "sheen_roughness": lobes.sheen_roughness,
        "is_fuzz": lobes.is_fuzz,
        "film_nm": lobes.film[0] if lobes.film else None,
        "film_ior": lobes.film[1] if lobes.film else None,
    }
    inputs = {name: _as_color(each) if name in _COLORS else each for name, each in found.items() if each is not None}
    surface = Node("surface", "surfaceshader", inputs, name=network.surface.name)
    return Reduced(replace(network, surface=surface), tuple(dict.fromkeys(reducer.left_out)))


_COLORS = ("diffuse", "f0", "metal", "through", "emission", "sheen")


def _as_color(given: Input) -> Input:
    if given.type == "color3":
        return given
    return multiply(constant(1.0, 1.0, 1.0), given) or constant(0.0, 0.0, 0.0)


@dataclass(eq=False)
class _Reducer:
    left_out: list[str] = field(default_factory=list)
    _lobes: dict[int, Lobes] = field(default_factory=dict)
    _lights: dict[int, Input | None] = field(default_factory=dict)

    def bsdf(self, given: Input | None) -> Lobes:
        """Lobes of an input."""
        if given is None or given.source is None:
            return Lobes()
        node = given.source.node
        if id(node) not in self._lobes:
            reader = _BSDFS.get(node.category)
            self._lobes[id(node)] = reader(self, node) if reader is not None else self._unknown(node)
        return self._lobes[id(node)]

    def edf(self, given: Input | None) -> Input | None:
        """Light that an input emits."""
        if given is None or given.source is None:
            return None
        node = given.source.node
        if id(node) not in self._lights:
            self._lights[id(node)] = self._emitted(node)
        return self._lights[id(node)]

    def _emitted(self, node: Node) -> Input | None:
        if node.category == "mix":
            share = self._number(node, "mix", "float", 0.0)
            if held(share) in ((0.0,), (1.0,)):
                return self.edf(node.inputs.get("fg" if held(share) == (1.0,) else "bg"))
            fg, bg = self.edf(node.inputs.get("fg")), self.edf(node.inputs.get("bg"))
            return add(multiply(fg, share), multiply(bg, complement(share)))
        if node.category == "add":
            return add(self.edf(node.inputs.get("in1")), self.edf(node.inputs.get("in2")))
        if node.category == "multiply":
            return multiply(self.edf(node.inputs.get("in1")), self._factor(node))
        if node.category == "generalized_schlick_edf":
            self.left_out.append(f"the angle at which {_label(node)} emits")
            return multiply(self.edf(node.inputs.get("base")), self._color(node, "color0"))
        if node.category not in ("uniform_edf", "conical_edf", "measured_edf"):
            self._unknown(node)
            return None
        if node.category != "uniform_edf":
            self.left_out.append(f"the angle at which {_label(node)} emits")
        return self._color(node, "color")

    def diffuse(self, node: Node) -> Lobes:
        """Diffuse, subsurface or translucent lobe."""
        if node.category == "translucent_bsdf":
            self.left_out.append(f"light from behind through {_label(node)}")
        if node.category.endswith("diffuse_bsdf") and is_used(node.inputs.get("roughness")):
            self.left_out.append(f"the roughness of {_label(node)}")
        weight = self._number(node, "weight", "float", 1.0)
        return Lobes(
            multiply(self._color(node, "color"), weight), normal=node.inputs.get("normal"), cover=constant(1.0)
        )

    def dielectric(self, node: Node) -> Lobes:
        """Lobe of a dielectric, or of Schlick's approximation, that reflects, lets through, or both."""
        weight = self._number(node, "weight", "float", 1.0)
        if node.category == "dielectric_bsdf":
            tint = self._color(node, "tint")
            f0 = multiply(reflectance(self._number(node, "ior", "float", 1.5)), tint)
        else:
            f0, tint = self._color(node, "color0"), self._color(node, "color90")
            for name, plain in (("color82", 1.0), ("color90", 1.0), ("exponent", 5.0)):
                if is_used(node.inputs.get(name), plain):
                    self.left_out.append(f"{name} of {_label(node)}")
        mode = (node.inputs["scatter_mode"].value if "scatter_mode" in node.inputs else None) or "R"
        lobes = replace(self._specular(node), f0=multiply(f0, weight) if "R" in mode else None)
        if "T" in mode:
            lobes = replace(lobes, through=multiply(tint, weight), through_weight=weight)
        return lobes

    def conductor(self, node: Node) -> Lobes:
        """Lobe of a metal."""
        ior, extinction = self._color(node, "ior"), self._color(node, "extinction")
        weight = self._number(node, "weight", "float", 1.0)
        f0 = multiply(reflectance(ior or constant(0.0, 0.0, 0.0), extinction), weight)
        return replace(self._specular(node), metal=f0, cover=constant(1.0))

    def sheen(self, node: Node) -> Lobes:
        """Sheen."""
        weight = self._number(node, "weight", "float", 1.0)
        roughness = self._number(node, "roughness", "float", 0.3)
        mode = (node.inputs["mode"].value if "mode" in node.inputs else None) or ""
        return Lobes(
            normal=node.inputs.get("normal"),
            sheen=multiply(self._color(node, "color"), weight),
            sheen_weight=weight,
            sheen_roughness=roughness,
            is_fuzz=constant(1.0 if mode == "zeltner" else 0.0),
        )

    def mix(self, node: Node) -> Lobes:
        """Mix of lobes."""
        share = self._number(node, "mix", "float", 0.0)
        if held(share) in ((0.0,), (1.0,)):  # nothing of the other is left out, since nothing of it is seen
            return self.bsdf(node.inputs.get("fg" if held(share) == (1.0,) else "bg"))
        fg, bg = self.bsdf(node.inputs.get("fg")), self.bsdf(node.inputs.get("bg"))
        rest = complement(share)
        fg = replace(fg.scale(share), cover=multiply(fg.cover, share))
        bg = replace(bg.scale(rest), cover=multiply(bg.cover, rest))
        return self._beside(node, fg, bg, share)

    def add(self, node: Node) -> Lobes:
        """Sum of lobes."""
        a, b = self.bsdf(node.inputs.get("in1")), self.bsdf(node.inputs.get("in2"))
        both = self._beside(node, a, b, constant(0.5))
        return replace(both, cover=at_most_one(both.cover))

    def multiply(self, node: Node) -> Lobes:
        """Lobes times a weight or a colour."""
        return self.bsdf(node.inputs.get("in1")).scale(self._factor(node))

    def layer(self, node: Node) -> Lobes:
        """Lobes on top of others."""
        top, base = self.bsdf(node.inputs.get("top")), self.bsdf(node.inputs.get("base"))
        if base.is_empty:
            return top
        if top.through is not None:
            self.left_out.append(f"what the top of {_label(node)} lets through")
            top = replace(top, through=None, through_weight=None)
        rest = complement(top.cover)
        base = replace(base.scale(rest), cover=multiply(base.cover, rest))
        if top.f0 is not None and top.metal is None and base.is_specular:
            top = self._as_coat(node, top, base)
        elif top.coat is not None and base.coat is not None:
            self.left_out.append(f"a third specular lobe of {_label(node)}")
            base = replace(base, coat=None, coat_roughness=None)
        return self._beside(node, top, base, constant(0.5))

    def _as_coat(self, node: Node, top: Lobes, base: Lobes) -> Lobes:
        """Top whose specular lobe is the clear coat of what is below."""
        if base.coat is not None or top.coat is not None:
            self.left_out.append(f"a third specular lobe of {_label(node)}")
            return replace(top, f0=None, roughness=None, normal=base.normal, film=None)
        if not same(top.normal, base.normal):
            self.left_out.append(f"the normal of the top of {_label(node)}")
        if top.film is not None:
            self.left_out.append(f"the thin film of the top of {_label(node)}")
        amount = mean(top.f0)
        coat = divide(amount, constant(_COAT_REFLECTANCE)) if amount is not None else None
        return replace(
            top, f0=None, coat=coat, roughness=None, coat_roughness=top.roughness, normal=base.normal, film=None
        )

    def _beside(self, node: Node, a: Lobes, b: Lobes, share: Input | None) -> Lobes:
        """Sum of lobes; of roughnesses and normals of which there is one, a mean by the share of ``a``, or that of the specular
        one."""
        if a.is_empty or b.is_empty:
            return b if a.is_empty else a
        if a.is_specular and b.is_specular and not same(a.roughness, b.roughness):
            self.left_out.append(f"the separate roughness of two specular lobes of {_label(node)}")
        if not same(a.normal, b.normal):
            self.left_out.append(f"the separate normals of the lobes of {_label(node)}")
        film = a.film if a.is_specular else b.film
        if a.is_specular and b.is_specular and not _same_films(a.film, b.film):
            self.left_out.append(f"the thin film of one of two specular lobes of {_label(node)}")
            film = None
        lead = a if a.is_specular or not b.is_specular else b
        return Lobes(
            diffuse=add(a.diffuse, b.diffuse),
            f0=add(a.f0, b.f0),
            metal=add(a.metal, b.metal),
            roughness=_between(a.roughness, b.roughness, share) if a.is_specular and b.is_specular else lead.roughness,
            normal=lead.normal,
            coat=add(a.coat, b.coat),
            coat_roughness=_between(a.coat_roughness, b.coat_roughness, share),
            through=add(a.through, b.through),
            through_weight=add(a.through_weight, b.through_weight),
            sheen=add(a.sheen, b.sheen),
            sheen_weight=add(a.sheen_weight, b.sheen_weight),
            sheen_roughness=_between(a.sheen_roughness, b.sheen_roughness, share),
            is_fuzz=_between(a.is_fuzz, b.is_fuzz, share),
            film=film,
            cover=add(a.cover, b.cover),
        )

    def _specular(self, node: Node) -> Lobes:
        """Roughness and normal of a specular lobe."""
        if is_used(node.inputs.get("retroreflective")):
            self.left_out.append(f"the retroreflection of {_label(node)}")
        thickness = self._number(node, "thinfilm_thickness", "float", 0.0)
        film = (thickness, self._number(node, "thinfilm_ior", "float", 1.5)) if is_used(thickness) else None
        return Lobes(roughness=self._roughness(node), normal=node.inputs.get("normal"), film=film)

    def _roughness(self, node: Node) -> Input:
        """Roughness by the alphas along and across."""
        given = self._number(node, "roughness", "vector2", 0.05, 0.05)
        source = given.source.node if given.source is not None else None
        if source is not None and source.category == _ANISOTROPIC:
            if is_used(source.inputs.get("anisotropy")):
                self.left_out.append(f"the anisotropy of {_label(node)}")
            return self._number(source, "roughness", "float", 0.0)
        numbers = held(given)
        if numbers is not None and numbers[0] != numbers[1]:
            self.left_out.append(f"the anisotropy of {_label(node)}")
        product = multiply(component(given, 0), component(given, 1))
        return power(product, 0.25) if product is not None else constant(0.0)

    def _factor(self, node: Node) -> Input | None:
        """Second input of a product."""
        given = node.inputs.get("in2")
        kind = given.type if given is not None and given.type in ("float", "color3") else "float"
        return _held_or(as_operand(self._number(node, "in2", kind, *(1.0,) * WIDTHS[kind])))

    def _color(self, node: Node, name: str) -> Input | None:
        theirs = library().document.getMatchingNodeDefs(node.category)[0].getActiveInput(name)
        default = numbers_of(Input("color3", theirs.getValueString())) if theirs is not None else (1.0, 1.0, 1.0)
        return _held_or(as_operand(self._number(node, name, "color3", *default)))

    def _number(self, node: Node, name: str, kind: str, *default: float) -> Input:
        """An input of a type, or its default where it has none that can be used."""
        given = node.inputs.get(name)
        if given is not None and given.source is not None:
            return replace(given, type=kind)
        if given is not None and len(numbers_of(given)) == len(default):
            return replace(given, type=kind)
        return (
            replace(constant(*default), type=kind) if kind != "vector2" else Input(kind, f"{default[0]}, {default[1]}")
        )

    def _unknown(self, node: Node) -> Lobes:
        self.left_out.append(f"{_label(node)}, a {(node.category or node.definition)[:60]},")
        return Lobes()


def _between(a: Input | None, b: Input | None, share: Input | None) -> Input | None:
    """Mean of two by the share of the first; the other where one is lacking."""
    if a is None or b is None or same(a, b):
        return a if b is None else b
    return add(multiply(a, share), multiply(b, complement(share))) or constant(0.0)


def _same_films(a: tuple[Input, Input] | None, b: tuple[Input, Input] | None) -> bool:
    return a is b if a is None or b is None else same(a[0], b[0]) and same(a[1], b[1])


def _held_or(given: Input) -> Input | None:
    """Nothing for a constant that is black or zero."""
    numbers = held(given)
    return given if numbers is None or any(numbers) else None


def _label(node: Node) -> str:
    return (node.name or node.category)[:60]


_BSDFS: dict[str, Callable[[_Reducer, Node], Lobes]] = {
    **dict.fromkeys(
        ("oren_nayar_diffuse_bsdf", "burley_diffuse_bsdf", "translucent_bsdf", "subsurface_bsdf"), _Reducer.diffuse
    ),
    **dict.fromkeys(("dielectric_bsdf", "generalized_schlick_bsdf"), _Reducer.dielectric),
    "conductor_bsdf": _Reducer.conductor,
    "sheen_bsdf": _Reducer.sheen,
    "mix": _Reducer.mix,
    "add": _Reducer.add,
    "multiply": _Reducer.multiply,
    "layer": _Reducer.layer,
}
