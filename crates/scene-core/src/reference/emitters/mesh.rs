//! Emission from the triangles of a mesh.

use core::f32::consts::PI;
use std::sync::Arc;

use glam::{Affine3A, Mat3A, Vec3A};
use qmc_sampling::warp::{PiecewiseConstant1d, sample_triangle};

use super::{direct_sample_of_area, emission_of_area, pdf_direct_of_area, pdf_emission_of_area, radiance_of_area};
use crate::ray::SurfacePoint;
use crate::reference::geometry::TriangleMesh;
use crate::traits::{DirectSample, EmissionSample, Rgb};

/// The areas of a mesh's triangles, shared by all instances that keep their ratios.
#[derive(Clone, Debug)]
pub(crate) struct AreaTable {
    choose: Arc<PiecewiseConstant1d>,
    area: f32,
}

impl AreaTable {
    /// Areas of the triangles in the coordinates that `to_world` leads to; nothing if there is no area.
    pub(crate) fn new(mesh: &TriangleMesh, to_world: &Affine3A) -> Option<Self> {
        let areas: Vec<f32> = (0..mesh.len())
            .map(|i| {
                let [a, b, c] = mesh.corners(i);
                let m = &to_world.matrix3;
                0.5 * (*m * (b - a)).cross(*m * (c - a)).length()
            })
            .collect();
        let area = areas.iter().map(|&a| f64::from(a)).sum::<f64>() as f32;
        let choose = Arc::new(PiecewiseConstant1d::new(&areas).ok()?);
        (area > 0.0 && area.is_finite()).then_some(Self { choose, area })
    }
}

/// Diffuse emission of constant radiance from the outside of a mesh. Points are sampled uniformly by area.
#[derive(Clone, Debug)]
pub struct MeshEmitter {
    mesh: Arc<TriangleMesh>,
    to_world: Affine3A,
    normal_matrix: Mat3A,
    table: AreaTable,
    radiance: Rgb,
    parallelogram: Option<Parallelogram>,
}

/// Two triangles that make a parallelogram, as most lamps are: no triangle to choose, and the square's strata stay whole.
#[derive(Clone, Copy, Debug)]
struct Parallelogram {
    corner: Vec3A,
    sides: [Vec3A; 2],
    normal: Vec3A,
    error: f32,
}

impl Parallelogram {
    /// If the mesh is one.
    fn of(mesh: &TriangleMesh, to_world: &Affine3A) -> Option<Self> {
        let &[first, second] = mesh.triangles() else { return None };
        let position = |i: u32| Vec3A::from(mesh.positions()[i as usize]);
        // The corners off the diagonal, which both triangles share.
        let apart = |from: [u32; 3], other: [u32; 3]| {
            let mut apart = from.into_iter().filter(|&i| other.iter().all(|&j| position(i) != position(j)));
            apart.next().filter(|_| apart.next().is_none())
        };
        let (corner, opposite) = (apart(first, second)?, apart(second, first)?);
        let at = first.iter().position(|&i| i == corner)?;
        let sides = [first[(at + 1) % 3], first[(at + 2) % 3]].map(|i| position(i) - position(corner));
        let gap = position(corner) + sides[0] + sides[1] - position(opposite);
        if gap.length() > 1e-5 * (sides[0].length() + sides[1].length()) {
            return None;
        }
        // Both triangles must face the same side, and so must the vertex normals, which decide on it where there are any.
        let local = sides[0].cross(sides[1]);
        let [a, b, c] = second.map(position);
        let normals = first.into_iter().chain(second).filter_map(|i| mesh.normals().get(i as usize));
        let turns: Vec<f32> = normals.map(|&n| local.dot(Vec3A::from(n))).collect();
        let (is_back, is_front) = (turns.iter().any(|&turn| turn < 0.0), turns.iter().any(|&turn| turn > 0.0));
        if (is_back && is_front) || (!is_back && !is_front && (b - a).cross(c - a).dot(local) < 0.0) {
            return None;
        }
        let outside = if is_back { -local } else { local };
        let all =
            first.into_iter().chain([opposite]).map(|i| to_world.transform_point3a(position(i)).abs().max_element());
        Some(Self {
            corner: to_world.transform_point3a(position(corner)),
            sides: sides.map(|side| to_world.transform_vector3a(side)),
            normal: (to_world.matrix3.inverse().transpose() * outside).try_normalize()?,
            error: SurfacePoint::error_of(all.fold(0.0, f32::max)),
        })
    }

    #[inline]
    fn sample(&self, [u, v]: [f32; 2]) -> SurfacePoint {
        let position = self.corner + self.sides[0] * u + self.sides[1] * v;
        SurfacePoint { position, normal: self.normal, uv: [u, v], error: self.error }
    }
}

impl MeshEmitter {
    /// `table` holds areas in coordinates that differ from the world's by a rotation and a uniform scale.
    pub(crate) fn new(mesh: Arc<TriangleMesh>, to_world: Affine3A, table: AreaTable, radiance: Rgb) -> Self {
        let normal_matrix = to_world.matrix3.inverse().transpose();
        let parallelogram = Parallelogram::of(&mesh, &to_world);
        Self { mesh, to_world, normal_matrix, table, radiance, parallelogram }
    }

    /// The emitting area, in world units.
    pub fn area(&self) -> f32 {
        self.table.area
    }

    #[inline]
    fn sample_point(&self, u: [f32; 2]) -> SurfacePoint {
        if let Some(parallelogram) = &self.parallelogram {
            return parallelogram.sample(u);
        }
        // Choose a triangle by area and use the number again.
        let (triangle, _, rest) = self.table.choose.choose(u[0]);
        let [wa, wb, wc] = sample_triangle([rest, u[1]]);
        let indices = self.mesh.triangles()[triangle].map(|i| i as usize);
        let [a, b, c] = indices.map(|i| Vec3A::from(self.mesh.positions()[i]));
        let mut normal = (b - a).cross(c - a);
        if let [Some(na), Some(nb), Some(nc)] = indices.map(|i| self.mesh.normals().get(i).copied()) {
            let shading = Vec3A::from(na) * wa + Vec3A::from(nb) * wb + Vec3A::from(nc) * wc;
            normal *= 1.0f32.copysign(normal.dot(shading));
        }
        let position = self.to_world.transform_point3a(a * wa + b * wb + c * wc);
        let normal = (self.normal_matrix * normal).normalize_or(Vec3A::Z);
        let mut point = SurfacePoint::new(position, normal);
        let corners = [a, b, c].map(|p| self.to_world.transform_point3a(p).abs().max_element());
        point.error = SurfacePoint::error_of(corners[0].max(corners[1]).max(corners[2]));
        point
    }

    pub(super) fn power(&self) -> Rgb {
        self.radiance * (PI * self.table.area)
    }

    #[inline]
    pub(super) fn sample_direct(&self, from: Vec3A, u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        direct_sample_of_area(from, self.sample_point(u), self.table.area, self.radiance)
    }

    #[inline]
    pub(super) fn pdf_direct(&self, from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>) -> f32 {
        pdf_direct_of_area(from, wi, at, self.table.area)
    }

    #[inline]
    pub(super) fn sample_emission(&self, u_position: [f32; 2], u: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        Some(emission_of_area(self.sample_point(u_position), self.table.area, self.radiance, u))
    }

    #[inline]
    pub(super) fn pdf_emission(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        pdf_emission_of_area(at, direction, self.table.area)
    }

    #[inline]
    pub(super) fn radiance(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Rgb {
        radiance_of_area(at, direction, self.radiance)
    }
}

/// Builds one table per mesh where instances are similar to each other, and one each where they are not.
#[derive(Debug, Default)]
pub(crate) struct AreaTables {
    shared: std::collections::HashMap<usize, Option<AreaTable>>,
}

impl AreaTables {
    /// The table for `mesh` placed by `to_world`.
    pub(crate) fn table(&mut self, mesh: &Arc<TriangleMesh>, to_world: &Affine3A) -> Option<AreaTable> {
        let Some(scale) = similarity_scale(to_world) else { return AreaTable::new(mesh, to_world) };
        let key = Arc::as_ptr(mesh) as usize;
        let own = self.shared.entry(key).or_insert_with(|| AreaTable::new(mesh, &Affine3A::IDENTITY)).clone()?;
        Some(AreaTable { area: own.area * scale * scale, ..own })
    }
}

/// The uniform scale of a transform, if it has no other scale.
pub(crate) fn similarity_scale(to_world: &Affine3A) -> Option<f32> {
    let m = &to_world.matrix3;
    let [x, y, z] = [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()];
    let tolerance = 1e-4 * x;
    let orthogonal = [m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis)]
        .iter()
        .all(|d| d.abs() <= tolerance * x);
    (orthogonal && (x - y).abs() <= tolerance && (x - z).abs() <= tolerance).then_some(x)
}
