"""Two-sample tests of image blocks.

Each renderer makes `n` images with independent seeds. Within a block the batch means of one channel are `n` independent,
identically distributed numbers, whatever happens inside a batch (stratification, correlated pixels). Welch's statistic

    t = (mean_a - mean_b) / sqrt(s_a^2 / n_a + s_b^2 / n_b)

compares the two expectations. Radiance estimates are heavy-tailed: that makes t conservative as long as both sides have the same
tail, and many small batches (at least 16 a side) keep it so where they differ a little. Nothing is clamped unless that is asked for
(`clamped`). Holm's step-down procedure shares one error rate among all tests of a scene.
"""

import math

import numpy as np

CHANNELS = "RGB"


def block_means(image, size):
    """Means over blocks of `size` pixels a side, (rows, columns, 3); blocks at the right and lower border may be smaller."""
    height, width, _ = image.shape
    rows, columns = np.arange(0, height, size), np.arange(0, width, size)
    sums = np.add.reduceat(np.add.reduceat(image, rows, axis=0), columns, axis=1)
    counts = np.outer(np.diff(np.append(rows, height)), np.diff(np.append(columns, width)))
    return sums / counts[..., None]


def welch(a, b):
    """Welch's t and degrees of freedom along the first axis of two arrays of samples."""
    mean_a, mean_b = a.mean(axis=0), b.mean(axis=0)
    error_a, error_b = a.var(axis=0, ddof=1) / len(a), b.var(axis=0, ddof=1) / len(b)
    error = error_a + error_b
    difference = mean_a - mean_b
    # Both sides constant: equal up to rounding is no difference (a black block, a light seen directly), anything else is.
    rounding = 1e-5 * np.maximum(np.abs(mean_a), np.abs(mean_b))
    exact = error <= np.square(rounding) / 4
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(exact, np.where(np.abs(difference) <= rounding, 0.0, np.inf * np.sign(difference)), difference / np.sqrt(error))
        freedom = np.square(error) / (np.square(error_a) / (len(a) - 1) + np.square(error_b) / (len(b) - 1))
    return t, np.where(exact, len(a) + len(b) - 2, freedom), np.sqrt(error)


def two_sided_p(t, freedom):
    """Probability that Student's t exceeds |t|: the regularised incomplete beta function I_x(freedom / 2, 1 / 2)."""
    if not math.isfinite(t):
        return 0.0
    if t == 0.0:
        return 1.0
    return incomplete_beta(freedom / 2.0, 0.5, freedom / (freedom + t * t))


def incomplete_beta(a, b, x):
    """Regularised I_x(a, b) by its continued fraction (Lentz; DLMF 8.17.22), on the side where it converges."""
    if x <= 0.0 or x >= 1.0:
        return min(max(x, 0.0), 1.0)
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - incomplete_beta(b, a, 1.0 - x)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    tiny = 1e-300
    c, d, fraction = 1.0, 1.0 / max(1.0 - (a + b) * x / (a + 1.0), tiny), 1.0
    fraction = d
    for m in range(1, 300):
        for numerator in (m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                          -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))):
            d = 1.0 + numerator * d
            d = 1.0 / (d if abs(d) > tiny else tiny)
            c = 1.0 + numerator / c
            c = c if abs(c) > tiny else tiny
            fraction *= c * d
        if abs(c * d - 1.0) < 1e-14:
            break
    return front * fraction


def holm(p, alpha):
    """Which hypotheses Holm's step-down procedure rejects at family-wise error rate `alpha`."""
    p = np.asarray(p, dtype=np.float64)
    order = np.argsort(p, kind="stable")
    rejected = np.zeros(p.size, dtype=bool)
    for rank, index in enumerate(order):
        if p[index] > alpha / (p.size - rank):
            break
        rejected[index] = True
    return rejected


def compare(ours, theirs, size, alpha):
    """Test every block and channel, and the image mean of every channel, of two stacks (batch, height, width, 3)."""
    a = np.stack([block_means(image, size) for image in ours])
    b = np.stack([block_means(image, size) for image in theirs])
    t, freedom, error = welch(a, b)
    image_a, image_b = ours.mean(axis=(1, 2)), theirs.mean(axis=(1, 2))
    image_t, image_freedom, image_error = welch(image_a, image_b)

    everything_t = np.concatenate([t.ravel(), image_t])
    everything_freedom = np.concatenate([freedom.ravel(), image_freedom])
    p = np.array([two_sided_p(x, f) for x, f in zip(everything_t, everything_freedom)])
    p[~np.isfinite(everything_t) & np.isnan(everything_t)] = 0.0  # a NaN pixel is a difference
    rejected = holm(p, alpha)

    mean_a, mean_b = a.mean(axis=0), b.mean(axis=0)
    rows, columns, _ = t.shape
    blocks = [
        {"x": int(x * size), "y": int(y * size), "size": size, "channel": CHANNELS[channel], "ours": float(mean_a[y, x, channel]),
         "theirs": float(mean_b[y, x, channel]), "t": float(t[y, x, channel]), "p": float(p[index]), "differs": bool(rejected[index])}
        for index, (y, x, channel) in enumerate(np.ndindex(rows, columns, 3))
    ]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(mean_b > 0, mean_a / mean_b, np.nan)
        relative_error = np.where(mean_b > 0, error / mean_b, np.nan)
    channels = [
        {"channel": name, "ours": float(image_a[:, c].mean()), "theirs": float(image_b[:, c].mean()),
         "ratio": float(image_a[:, c].mean() / image_b[:, c].mean()),
         "ratio_standard_error": float(image_error[c] / image_b[:, c].mean()),
         "t": float(image_t[c]), "p": float(p[t.size + c]), "differs": bool(rejected[t.size + c]),
         "median_block_ratio": float(np.nanmedian(ratio[..., c])),
         "median_block_relative_error": float(np.nanmedian(relative_error[..., c]))}
        for c, name in enumerate(CHANNELS)
    ]
    return {"tests": int(p.size), "alpha": alpha, "blocks": blocks, "channels": channels}, t


def clamped(ours, theirs, times):
    """Both stacks with their pixels clamped at `times` the median pixel that Mitsuba's mean image has.

    For images of one sample per pixel only. Then a pixel is one sample, and if both renderers sample paths alike (same techniques,
    densities, weights, Russian roulette) samples are equal in law, and so is the expectation of every function of them. The
    clamped one is bounded: t has its distribution, however heavy the tail was. What is lost is the part of the light
    above the bound. A difference is either wrong light or another way of sampling, and has to be looked into.
    """
    mean = theirs.mean(axis=0)
    limit = times * np.median(mean[mean > 0]) if (mean > 0).any() else np.inf
    return np.minimum(ours, limit), np.minimum(theirs, limit)


def clamped_ratios(ours, theirs):
    """Ratio of image means per channel after clamping pixels of single batches, and its standard error.

    Only a hint: clamping is biased, by the same amount in two renderers that sample alike. It has little noise, and so shows a wrong
    material long before the unclamped means do in a scene full of fireflies.
    """
    limit = 10.0 * np.median(theirs[theirs > 0]) if (theirs > 0).any() else 1.0
    a, b = np.minimum(ours, limit).mean(axis=(1, 2)), np.minimum(theirs, limit).mean(axis=(1, 2))
    _, _, error = welch(a, b)
    with np.errstate(divide="ignore", invalid="ignore"):
        return [{"channel": name, "limit": float(limit), "ratio": float(a[:, c].mean() / b[:, c].mean()),
                 "ratio_standard_error": float(error[c] / b[:, c].mean())} for c, name in enumerate(CHANNELS)]
