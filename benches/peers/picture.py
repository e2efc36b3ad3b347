"""Side-by-side pictures: ours, theirs, and the signed difference of each block in standard errors."""

import numpy as np


def tone_map(image, exposure):
    """Exposure, then the sRGB transfer function, to 8 bits."""
    linear = np.clip(np.nan_to_num(image * exposure), 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, 1.0 / 2.4) - 0.055)
    return (255.0 * encoded + 0.5).astype(np.uint8)


def sigma_map(t, size, shape, full_scale=6.0):
    """Blocks coloured by t of the channel that differs most: white 0, red where we are brighter, blue where darker."""
    index = np.abs(np.nan_to_num(t, nan=np.inf, posinf=1e9, neginf=-1e9)).argmax(axis=2)
    signed = np.take_along_axis(np.nan_to_num(t, nan=1e9, posinf=1e9, neginf=-1e9), index[..., None], axis=2)[..., 0]
    level = np.clip(signed / full_scale, -1.0, 1.0)
    colour = np.stack([1.0 + np.minimum(level, 0.0), 1.0 - np.abs(level), 1.0 - np.maximum(level, 0.0)], axis=2)
    pixels = np.repeat(np.repeat(colour, size, axis=0), size, axis=1)[: shape[0], : shape[1]]
    return (255.0 * pixels + 0.5).astype(np.uint8)


def write(path, ours, theirs, t, size):
    """Write `ours | theirs | sigmas` as PNG, both at the exposure that maps their 90th percentile to 0.8."""
    import mitsuba as mi

    if mi.variant() is None:
        mi.set_variant("scalar_rgb")
    level = np.percentile(theirs.mean(axis=2), 90.0)
    exposure = 0.6 / level if level > 0 else 1.0
    gap = np.full((ours.shape[0], 4, 3), 128, dtype=np.uint8)
    panels = [tone_map(ours, exposure), gap, tone_map(theirs, exposure), gap, sigma_map(t, size, ours.shape)]
    mi.Bitmap(np.ascontiguousarray(np.concatenate(panels, axis=1))).write(str(path))
