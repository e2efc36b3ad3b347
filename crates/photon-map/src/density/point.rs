//! Where a density is estimated.

use crate::vector::{dot, normalise, subtract};
use crate::{Flux, PackedPhoton};

/// A point on a surface where density is estimated, with what keeps photons of other surfaces out.
///
/// ```text
/// photon counts if  wi . n > c      and      t = (d^2 + (s^2 - 1) h^2) / r^2 < 1,      h = (x_k - x) . n
/// ```
///
/// **Symbols.** `n`: normal on the side that is looked at; `wi`: where the photon came from; `c`: least cosine; `d`:
/// distance of the photon, `h`: its height above the tangent plane, `r`: radius; `s`: compression. `t` is what the
/// [`Kernel`](crate::Kernel) gets.
///
/// - The **normal test** leaves out photons that arrived at the other side: of the back of a thin wall, of another
///   surface that faces away.
/// - The **disk compression** shrinks the ball to an ellipsoid of height `r / s` (Jensen's disk). What a wall leaks onto
///   the floor beside it is divided by `s`. On a plane `h = 0`, and nothing changes, exactly. On a surface of radius of
///   curvature `R` photons count as farther by the factor `1 + (s^2-1) d^2 / (4 R^2)` in `d^2`: keep `s r` well below `R`.
///
/// Both make estimates *less* biased at corners and walls, and neither biases them on a plane.
///
/// **Source.** H. W. Jensen, *Realistic Image Synthesis Using Photon Mapping*, 2001.
///
/// # Example
/// ```
/// use photon_map::GatherPoint;
/// let ball = GatherPoint::at([0.0; 3]);
/// let disk = GatherPoint::on([0.0; 3], [0.0, 0.0, 1.0]).with_compression(10.0);
/// assert_eq!(ball.compression(), 1.0);
/// assert_eq!(disk.compression(), 10.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherPoint {
    position: [f32; 3],
    normal: Option<[f32; 3]>,
    least_cosine: f32,
    /// `s^2 - 1`.
    flattening: f32,
}

impl GatherPoint {
    /// A compression that tells floors from walls and leaves curved surfaces alone: at a tenth of the radius of
    /// curvature the rim counts as 2 percent farther.
    pub const COMPRESSION: f32 = 4.0;

    /// A point in space: the whole ball, no normal.
    #[must_use]
    pub const fn at(position: [f32; 3]) -> Self {
        Self { position, normal: None, least_cosine: 0.0, flattening: 0.0 }
    }

    /// A point on a surface, seen from the side of the normal (of any length), with compression
    /// [`COMPRESSION`](Self::COMPRESSION).
    ///
    /// A normal that is zero or not finite counts as none.
    #[must_use]
    pub fn on(position: [f32; 3], normal: [f32; 3]) -> Self {
        let point = Self { normal: normalise(normal), ..Self::at(position) };
        if point.normal.is_some() { point.with_compression(Self::COMPRESSION) } else { point }
    }

    /// With another compression: 1 is a ball. Numbers below 1 and NaN count as 1, above 1e6 as 1e6. Without a normal
    /// it has no effect.
    #[must_use]
    pub fn with_compression(mut self, compression: f32) -> Self {
        let s = compression.clamp(1.0, 1e6);
        self.flattening = if s > 1.0 { s * s - 1.0 } else { 0.0 };
        self
    }

    /// With another least cosine between the normal and where photons come from. Zero by default: everything from the
    /// front. With -1 nothing is tested.
    #[must_use]
    pub const fn with_least_cosine(mut self, cosine: f32) -> Self {
        self.least_cosine = cosine;
        self
    }

    /// The compression.
    #[must_use]
    pub fn compression(&self) -> f32 {
        (self.flattening + 1.0).sqrt()
    }

    /// Where.
    #[must_use]
    pub const fn position(&self) -> [f32; 3] {
        self.position
    }

    /// The squared distance of a photon in the compressed metric; `None` if it does not count.
    #[inline]
    pub(crate) fn distance_squared<F: Flux>(&self, photon: &PackedPhoton<F>, distance_squared: f32) -> Option<f32> {
        let Some(normal) = self.normal else { return Some(distance_squared) };
        let c = self.least_cosine;
        if c > -1.0 {
            // Most often only the sign of the cosine matters: no need to normalise.
            let wi = photon.wi_unnormalised();
            let bound = if c == 0.0 { 0.0 } else { c * dot(wi, wi).sqrt() };
            if dot(wi, normal) <= bound {
                return None;
            }
        }
        let height = dot(subtract(photon.position(), self.position), normal);
        Some(distance_squared + self.flattening * height * height)
    }
}
