//! Numbers that are drawn in groups, and handed out one or two at a time.

/// The numbers of one stream, group by group.
///
/// `B` is the group: `[f32; 4]`, or `[f32; 1]` where drawing several at once gains nothing.
pub(super) trait DrawGroup<B> {
    /// Draws group number `group`.
    fn draw(&self, group: u32, numbers: &mut B);
}

/// A group of numbers, one to four.
pub(super) trait Group: Copy {
    /// How many there are: 1, 2 or 4.
    const LEN: u32;
    /// Before anything was drawn.
    const EMPTY: Self;

    /// Number `i`, below [`LEN`](Self::LEN).
    fn get(&self, i: u32) -> f32;
}

impl<const N: usize> Group for [f32; N] {
    const LEN: u32 = N as u32;
    const EMPTY: Self = [0.0; N];

    #[inline]
    fn get(&self, i: u32) -> f32 {
        // The mask spares the compiler a check: lengths are powers of two.
        self[i as usize & (N - 1)]
    }
}

/// Hands out the numbers of a stream, and remembers the rest of the group begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Groups<S, B> {
    pub(super) stream: S,
    /// The next dimension.
    dimension: u32,
    /// The group that `dimension` lies in, valid unless `dimension` is the first one of its group.
    group: B,
}

impl<S: DrawGroup<B>, B: Group> Groups<S, B> {
    /// From the first number on.
    #[inline]
    pub(super) const fn new(stream: S) -> Self {
        Self { stream, dimension: 0, group: B::EMPTY }
    }

    /// The number of the next group of which nothing was taken yet; leaves out what remains of the one begun.
    #[inline]
    pub(super) fn skip_group(&mut self) -> u32 {
        let group = self.dimension.div_ceil(B::LEN);
        self.dimension = B::LEN * (group + 1);
        group
    }

    /// Draws the group that begins here, if one does.
    #[inline]
    fn provide(&mut self) {
        if self.dimension.is_multiple_of(B::LEN) {
            self.stream.draw(self.dimension / B::LEN, &mut self.group);
        }
    }

    /// The next number.
    #[inline]
    pub(super) fn next_1d(&mut self) -> f32 {
        self.provide();
        let x = self.group.get(self.dimension % B::LEN);
        self.dimension = self.dimension.wrapping_add(1);
        x
    }

    /// The next aligned pair of a group; in groups of one, the next two numbers.
    #[inline]
    pub(super) fn next_2d(&mut self) -> [f32; 2] {
        if B::LEN == 1 {
            return [self.next_1d(), self.next_1d()];
        }
        self.dimension = self.dimension.wrapping_add(self.dimension % 2);
        self.provide();
        let first = (self.dimension % B::LEN) & !1;
        self.dimension = self.dimension.wrapping_add(2);
        [self.group.get(first), self.group.get(first + 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number `n` of the stream is `n`.
    #[derive(Clone)]
    struct Count;

    impl<const N: usize> DrawGroup<[f32; N]> for Count {
        fn draw(&self, group: u32, numbers: &mut [f32; N]) {
            *numbers = core::array::from_fn(|i| (group * N as u32) as f32 + i as f32);
        }
    }

    #[test]
    fn every_number_once_and_pairs_are_aligned() {
        let mut fours = Groups::<_, [f32; 4]>::new(Count);
        assert_eq!(fours.next_1d(), 0.0);
        assert_eq!(fours.next_2d(), [2.0, 3.0]);
        assert_eq!(fours.next_2d(), [4.0, 5.0]);
        assert_eq!([fours.next_1d(), fours.next_1d(), fours.next_1d()], [6.0, 7.0, 8.0]);
        assert_eq!((fours.skip_group(), fours.next_1d()), (3, 16.0));
        let mut ones = Groups::<_, [f32; 1]>::new(Count);
        assert_eq!((ones.next_1d(), ones.next_2d(), ones.next_1d()), (0.0, [1.0, 2.0], 3.0));
    }
}
