//! What a heuristic may ask for.

/// The densities with which each technique would have generated one given sample.
///
/// `density(i)` is `n_i * p_i(x)`: the probability density of technique `i` at the sample `x`, times the number of
/// samples that technique takes. All are given in the **same measure** (all per solid angle, or all per area, or all
/// in the product area measure of a path). [`MultiSample`](crate::MultiSample) and [`OneSample`](crate::OneSample)
/// multiply by the counts; with one sample per technique there is nothing to multiply.
///
/// Arrays and slices are `Densities`, so are references to them, and [`Lazy`](crate::Lazy) makes a closure one. `dyn Densities<F>` is
/// one, too.
///
/// # Special values
/// | density | meaning |
/// |---|---|
/// | `0` | the technique cannot generate the sample |
/// | infinite | a Dirac delta: it takes the whole weight; several of them share it |
/// | NaN, negative | the heuristics of this crate count it as `0` |
///
/// # Panics
/// Arrays and slices panic in `density(i)` if `i >= len()`, as indexing does.
///
/// # Example
/// ```
/// use mis_heuristics::{Balance, Densities, Heuristic};
///
/// /// The light and the BSDF sampler of one vertex; nothing is computed before it is asked for.
/// struct Vertex { distance_squared: f32, cos_light: f32, light_area: f32, cos_surface: f32 }
///
/// impl Densities<f32> for Vertex {
///     fn len(&self) -> usize { 2 }
///     fn density(&self, technique: usize) -> f32 {
///         match technique {
///             0 => self.distance_squared / (self.cos_light * self.light_area), // per solid angle
///             _ => self.cos_surface / core::f32::consts::PI,
///         }
///     }
/// }
///
/// let vertex = Vertex { distance_squared: 1.0, cos_light: 1.0, light_area: 1.0, cos_surface: 0.0 };
/// assert_eq!(Balance.weight(0, &vertex), 1.0);
/// ```
pub trait Densities<F> {
    /// Number of techniques.
    fn len(&self) -> usize;

    /// `n_i * p_i` of technique `i` at the sample, in the measure common to all techniques.
    fn density(&self, technique: usize) -> F;

    /// Whether there is no technique at all.
    #[inline]
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

// Its docs say so.
const _: Option<&dyn Densities<f64>> = None;

impl<F: Copy> Densities<F> for [F] {
    #[inline]
    fn len(&self) -> usize {
        <[F]>::len(self)
    }
    #[inline]
    fn density(&self, technique: usize) -> F {
        self[technique]
    }
}

impl<F: Copy, const N: usize> Densities<F> for [F; N] {
    #[inline]
    fn len(&self) -> usize {
        N
    }
    #[inline]
    fn density(&self, technique: usize) -> F {
        self[technique]
    }
}

impl<F, D: Densities<F> + ?Sized> Densities<F> for &D {
    #[inline]
    fn len(&self) -> usize {
        (**self).len()
    }
    #[inline]
    fn density(&self, technique: usize) -> F {
        (**self).density(technique)
    }
}
