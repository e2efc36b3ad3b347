"""Writes bsdf_reference.csv: values of Mitsuba 3.9.1 that the materials are tested against.

    python bsdf_reference.py > bsdf_reference.csv

Mitsuba's `si.wi` is our `wo`, its `wo` our `wi`. The cases have the same names in `material/cases.rs`.
"""
import numpy as np
import mitsuba as mi

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)
rng = np.random.default_rng(7)


def rgb(*value):
    return {"type": "rgb", "value": list(value)}


RED, BLUE = rgb(0.7, 0.3, 0.2), rgb(0.1, 0.27, 0.36)


def height(width=8):
    y, x = np.mgrid[0:width, 0:width]
    return ((x * 5 + y * 3) % 7).astype(np.float32) / 7.0


def bitmap(values):
    if values.ndim == 2:
        values = np.repeat(values[:, :, None], 3, axis=2)
    return {"type": "bitmap", "raw": True, "bitmap": mi.Bitmap(np.ascontiguousarray(values.astype(np.float32)))}


def rough(kind, distribution, alpha, **more):
    if isinstance(alpha, tuple):
        return {"type": kind, "distribution": distribution, "alpha_u": alpha[0], "alpha_v": alpha[1], **more}
    return {"type": kind, "distribution": distribution, "alpha": alpha, **more}


GLASS = {"int_ior": 1.5, "ext_ior": 1.0}
NORMAL = np.zeros((4, 4, 3)) + np.array([0.7, 0.4, 0.9])

# name: (description, both hemispheres, both modes)
CASES = {
    "diffuse": ({"type": "diffuse", "reflectance": RED}, False, False),
    "roughconductor-ggx-0.05": (rough("roughconductor", "ggx", 0.05, material="Au"), False, False),
    "roughconductor-ggx-0.3": (rough("roughconductor", "ggx", 0.3, material="Cu"), False, False),
    "roughconductor-ggx-aniso": (rough("roughconductor", "ggx", (0.1, 0.4), material="Al"), False, False),
    "roughconductor-beckmann-0.1": (rough("roughconductor", "beckmann", 0.1, material="Cr"), False, False),
    "roughconductor-beckmann-0.5": (rough("roughconductor", "beckmann", 0.5, material="W"), False, False),
    "roughconductor-beckmann-aniso": (
        rough("roughconductor", "beckmann", (0.4, 0.2), material="Ag", specular_reflectance=RED), False, False),
    "roughdielectric-ggx-0.1": (rough("roughdielectric", "ggx", 0.1, **GLASS), True, True),
    "roughdielectric-ggx-0.5": (
        rough("roughdielectric", "ggx", 0.5, **GLASS, specular_reflectance=RED, specular_transmittance=BLUE), True, True),
    "roughdielectric-ggx-aniso": (rough("roughdielectric", "ggx", (0.2, 0.5), int_ior=1.33, ext_ior=1.1), True, True),
    "roughdielectric-beckmann-0.3": (rough("roughdielectric", "beckmann", 0.3, **GLASS), True, True),
    "plastic": ({"type": "plastic", "diffuse_reflectance": RED}, False, False),
    "plastic-nonlinear": (
        {"type": "plastic", "diffuse_reflectance": BLUE, "int_ior": 1.9, "nonlinear": True, "specular_reflectance": 0.5},
        False, False),
    "roughplastic-ggx-0.05": (rough("roughplastic", "ggx", 0.05, diffuse_reflectance=RED), False, False),
    "roughplastic-ggx-0.2": (
        rough("roughplastic", "ggx", 0.2, diffuse_reflectance=BLUE, nonlinear=True, **GLASS), False, False),
    "roughplastic-beckmann-0.1": (
        rough("roughplastic", "beckmann", 0.1, diffuse_reflectance=RED, nonlinear=True, **GLASS), False, False),
    "roughplastic-beckmann-0.4": (
        rough("roughplastic", "beckmann", 0.4, diffuse_reflectance=BLUE, int_ior=1.9, specular_reflectance=0.7), False, False),
    "twosided-diffuse": ({"type": "twosided", "m": {"type": "diffuse", "reflectance": RED}}, True, False),
    "twosided-roughplastic": ({"type": "twosided", "m": rough("roughplastic", "ggx", 0.3, diffuse_reflectance=RED)}, True, False),
    "twosided-different": (
        {"type": "twosided", "a": {"type": "diffuse", "reflectance": RED}, "b": rough("roughconductor", "ggx", 0.4, material="Cu")},
        True, False),
    "mask": (
        {"type": "mask", "opacity": 0.3, "m": {"type": "twosided", "m": {"type": "diffuse", "reflectance": BLUE}}}, True, False),
    "bumpmap": (
        {"type": "bumpmap", "scale": 0.25, "use_shadowing_function": False, "t": bitmap(height()),
         "m": {"type": "diffuse", "reflectance": RED}}, False, False),
    "normalmap": (
        {"type": "normalmap", "use_shadowing_function": False, "normalmap": bitmap(NORMAL),
         "m": rough("roughconductor", "ggx", (0.2, 0.5), material="Cu")}, False, False),
}
UV = (0.3, 0.4)


def interaction(wi):
    si = mi.SurfaceInteraction3f()
    si.uv = mi.Point2f(*UV)
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0), mi.Vector3f(0, 0, 1))
    si.dp_du, si.dp_dv = mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0)
    si.wi = mi.Vector3f(*wi)
    return si


def direction(lower=-1.0):
    z = rng.uniform(lower, 1)
    z = np.copysign(max(abs(z), 0.02), z)
    phi = rng.uniform(0, 2 * np.pi)
    r = np.sqrt(1 - z * z)
    return np.array([r * np.cos(phi), r * np.sin(phi), z], dtype=np.float32)


def numbers(*values):
    return ",".join("%.9g" % float(x) for v in values for x in np.ravel(np.array(v, dtype=np.float64)))


def color(value):
    return [value[0], value[1], value[2]]


print("# Mitsuba %s; value: case, mode, wo, wi, f |cos| in RGB, pdf" % mi.__version__)
for name, (description, both, modes) in CASES.items():
    bsdf = mi.load_dict(description)
    for mode in ("radiance", "importance") if modes else ("radiance",):
        ctx = mi.BSDFContext(mi.TransportMode.Radiance if mode == "radiance" else mi.TransportMode.Importance)
        for i in range(32):
            wo = direction(-1.0 if both else 0.0)
            si = interaction(wo)
            if i % 4 == 3:
                wi = direction(-1.0 if both else 0.0)
            else:
                wi = np.array(bsdf.sample(ctx, si, rng.random(), mi.Point2f(rng.random(), rng.random()))[0].wo, dtype=np.float32)
                if not np.linalg.norm(wi) > 0.5:
                    continue
            value, pdf = bsdf.eval_pdf(ctx, si, mi.Vector3f(*wi))
            print("value,%s,%s,%s" % (name, mode, numbers(wo, wi, color(value), pdf)))

print("# delta: case, mode, wo, wi, weight in RGB, probability, eta")
DELTA = {
    "conductor": {"type": "conductor", "material": "Cu"},
    "conductor-none": {"type": "conductor", "material": "none", "specular_reflectance": RED},
    "dielectric": {"type": "dielectric", **GLASS, "specular_reflectance": RED, "specular_transmittance": BLUE},
    "thindielectric": {"type": "thindielectric", **GLASS},
    "plastic-delta": {"type": "plastic", "diffuse_reflectance": RED},
}
for name, description in DELTA.items():
    bsdf = mi.load_dict(description)
    for mode in ("radiance", "importance") if name == "dielectric" else ("radiance",):
        ctx = mi.BSDFContext(mi.TransportMode.Radiance if mode == "radiance" else mi.TransportMode.Importance)
        for i in range(12):
            wo = direction(-1.0 if "dielectric" in name else 0.0)
            for u in (1e-7, 1 - 1e-7):
                sample, weight = bsdf.sample(ctx, interaction(wo), u, mi.Point2f(0.3, 0.6))
                if sample.sampled_type & int(mi.BSDFFlags.Delta) or sample.sampled_type & int(mi.BSDFFlags.Null):
                    print("delta,%s,%s,%s" % (name, mode, numbers(wo, sample.wo, color(weight), sample.pdf, sample.eta)))

print("# texture: wrap, filter, u, v, RGB, luminance gradient")
pixels = np.stack([height(5), height(5).T, height(5) * 0.5], axis=2)
for wrap in ("repeat", "clamp", "mirror"):
    for filter in ("bilinear", "nearest"):
        transform = mi.ScalarTransform3f([[1.2, 0.3, 0.1], [-0.4, 0.8, 0.2], [0, 0, 1]])
        texture = mi.load_dict({**bitmap(pixels), "wrap_mode": wrap, "filter_type": filter, "to_uv": transform})
        for i in range(10):
            si = interaction((0, 0, 1))
            uv = rng.uniform(-2, 3, 2).astype(np.float32)
            si.uv = mi.Point2f(*uv)
            print("texture,%s,%s,%s" % (wrap, filter, numbers(uv, color(texture.eval(si)), texture.eval_1_grad(si))))
