//! A rectangle of the film that one thread owns.

use super::Pixel;

/// A rectangle of a [`Film`](super::Film)'s pixels, borrowed mutably and disjoint from all other tiles.
#[derive(Debug)]
pub struct FilmTile<'film> {
    x: u32,
    y: u32,
    rows: Vec<&'film mut [Pixel]>,
}

impl<'film> FilmTile<'film> {
    /// Cuts rows of `width` pixels each into tiles of (at most) `size` times `size` pixels, in reading order.
    pub(super) fn cut(pixels: &'film mut [Pixel], width: usize, size: usize) -> Vec<Self> {
        let mut tiles = Vec::new();
        for (band, pixels) in pixels.chunks_mut(width.saturating_mul(size)).enumerate() {
            let first = tiles.len();
            tiles.extend((0..width).step_by(size).map(|x| Self {
                x: x as u32,
                y: (band * size) as u32,
                rows: Vec::with_capacity(pixels.len() / width),
            }));
            for row in pixels.chunks_exact_mut(width) {
                for (tile, segment) in tiles[first..].iter_mut().zip(row.chunks_mut(size)) {
                    tile.rows.push(segment);
                }
            }
        }
        tiles
    }

    /// Column of the leftmost pixel.
    pub fn x(&self) -> u32 {
        self.x
    }

    /// Row of the uppermost pixel.
    pub fn y(&self) -> u32 {
        self.y
    }

    /// Width in pixels; at least one.
    pub fn width(&self) -> u32 {
        self.rows.first().map_or(0, |row| row.len() as u32)
    }

    /// Height in pixels; at least one.
    pub fn height(&self) -> u32 {
        self.rows.len() as u32
    }

    /// All pixels with their position `[x, y]` on the film, in reading order.
    pub fn pixels_mut(&mut self) -> impl Iterator<Item = ([u32; 2], &mut Pixel)> {
        let (left, top) = (self.x, self.y);
        self.rows
            .iter_mut()
            .zip(top..)
            .flat_map(move |(row, y)| row.iter_mut().zip(left..).map(move |(pixel, x)| ([x, y], pixel)))
    }
}
