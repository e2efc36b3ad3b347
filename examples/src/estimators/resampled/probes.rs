//! A cheap guess of visibility.

use glam::Vec3A;
use qmc_sampling::warp::sample_uniform_sphere;
use scene_core::{Ray, Scene, Vertex};

/// Distances to occluders, seen from the cells of a grid in a few directions.
///
/// A guess costs one look-up. It is never zero, so targets with it stay positive wherever light is: estimates are unbiased however wrong the
/// guesses are.
#[derive(Clone, Debug)]
pub struct VisibilityProbes {
    low: Vec3A,
    cell: f32,
    /// Of each cell, in the order of the directions.
    distances: Vec<f32>,
}

/// Cells along each axis.
const CELLS: usize = 16;
/// Strips of directions, and directions in each: equal solid angles.
const STRIPS: usize = 6;
const SECTORS: usize = 8;
/// The guess for what seems occluded.
const OCCLUDED: f32 = 0.2;

impl VisibilityProbes {
    /// Traces one ray for each cell of the scene's bounding cube and each direction: 196,608 in all.
    pub fn new<S: Scene>(scene: &S) -> Self {
        let (center, radius) = scene.bounding_sphere();
        let (low, cell) = (center - Vec3A::splat(radius), 2.0 * radius / CELLS as f32);
        let mut distances = Vec::with_capacity(CELLS * CELLS * CELLS * STRIPS * SECTORS);
        for k in 0..CELLS * CELLS * CELLS {
            let [x, y, z] = [k % CELLS, k / CELLS % CELLS, k / (CELLS * CELLS)].map(|i| i as f32 + 0.5);
            let origin = low + Vec3A::new(x, y, z) * cell;
            for direction in 0..STRIPS * SECTORS {
                let u = [
                    ((direction / SECTORS) as f32 + 0.5) / STRIPS as f32,
                    ((direction % SECTORS) as f32 + 0.5) / SECTORS as f32,
                ];
                let ray = Ray::new(origin, sample_uniform_sphere(u).into());
                let hit = scene.intersect(&ray);
                distances.push(hit.map_or(f32::INFINITY, |hit| (hit.point().position - origin).length()));
            }
        }
        Self { low, cell, distances }
    }

    /// A guess between 0.2 and 1 whether light from `distance` in direction `wi` arrives at `position`.
    pub fn guess(&self, position: Vec3A, wi: Vec3A, distance: f32) -> f32 {
        let place = ((position + wi * (0.5 * self.cell) - self.low) / self.cell).to_array();
        let [x, y, z] = place.map(|x| (x.max(0.0) as usize).min(CELLS - 1));
        let [u, v] = qmc_sampling::warp::invert_uniform_sphere(wi.to_array());
        let strip = ((u * STRIPS as f32) as usize).min(STRIPS - 1);
        let sector = ((v * SECTORS as f32) as usize).min(SECTORS - 1);
        let cell = (z * CELLS + y) * CELLS + x;
        let free = self.distances[(cell * STRIPS + strip) * SECTORS + sector];
        // Within the cell the probe says nothing about this point.
        if free + self.cell < distance { OCCLUDED } else { 1.0 }
    }
}
