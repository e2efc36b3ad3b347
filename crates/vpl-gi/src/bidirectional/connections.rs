//! Which connections are tested for occlusion.

use scene_core::{Ray, Spectrum};

/// Decides which of the connections of an eye path get a shadow ray.
///
/// # Laws
/// The expectation of all that [`connect`](Self::connect) and [`finish`](Self::finish) return for one eye path is the sum of the values of the
/// connections that are not occluded. `finish` leaves nothing behind: the next eye path starts anew.
///
/// Not dyn compatible, because `connect` is generic: to choose at run time, implement it for an enum of the choices.
pub trait ConnectionTests<P: Spectrum> {
    /// Whether [`connect`](Self::connect) traces every ray it is given: rays may then be traced before weights are known.
    const TESTS_ALL: bool = false;

    /// A connection along `ray` contributes `value` unless it is occluded: what is to be added for it now.
    fn connect(&mut self, value: P, ray: Ray, is_occluded: impl FnOnce(&Ray) -> bool) -> P;

    /// The eye path has ended: what is to be added for connections that were put off.
    fn finish(&mut self, is_occluded: impl FnMut(&Ray) -> bool) -> P;
}

/// A shadow ray for every connection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EveryConnection;

impl<P: Spectrum> ConnectionTests<P> for EveryConnection {
    const TESTS_ALL: bool = true;

    #[inline]
    fn connect(&mut self, value: P, ray: Ray, is_occluded: impl FnOnce(&Ray) -> bool) -> P {
        if is_occluded(&ray) { P::ZERO } else { value }
    }

    #[inline]
    fn finish(&mut self, _: impl FnMut(&Ray) -> bool) -> P {
        P::ZERO
    }
}
