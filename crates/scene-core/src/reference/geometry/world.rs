//! All surfaces of a scene, in two levels.
//!
//! Meshes that are placed once (or small) are moved into the world and share one hierarchy of triangles. Everything else
//! (large meshes placed several times, spheres, disks) is an object of a second hierarchy, entered with the ray in the object's coordinates.

use std::sync::Arc;

use glam::{Affine3A, Vec3A};
use obvhs::aabb::Aabb;

use super::analytic::{intersect_disk, intersect_sphere};
use super::hierarchy::Hierarchy;
use super::mesh::TriangleMesh;
use super::triangle_bvh::{TriangleBvh, is_traceable};
use crate::ray::{Ray, SurfacePoint};

/// What one object is, in its own coordinates.
#[derive(Clone, Debug)]
pub(crate) enum ObjectShape {
    Mesh { mesh: Arc<TriangleMesh>, bvh: Arc<TriangleBvh> },
    Sphere { center: Vec3A, radius: f32, flip_normals: bool },
    Disk,
}

/// A shape placed in the world.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub shape: ObjectShape,
    pub to_world: Affine3A,
    pub to_object: Affine3A,
    /// Inverse transpose of the linear part, with the sign that keeps outside outside.
    pub normal_matrix: glam::Mat3A,
    /// Index of the surface in the scene.
    pub surface: u32,
}

impl Object {
    pub(crate) fn new(shape: ObjectShape, to_world: Affine3A, surface: u32) -> Self {
        let to_object = to_world.inverse();
        let normal_matrix = to_object.matrix3.transpose();
        Self { shape, to_world, to_object, normal_matrix, surface }
    }

    #[inline]
    fn local_ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_object.transform_point3a(ray.origin),
            direction: self.to_object.transform_vector3a(ray.direction),
            max_distance: ray.max_distance,
        }
    }

    fn bounds(&self) -> Aabb {
        let local = match &self.shape {
            ObjectShape::Mesh { bvh, .. } => match bvh.bounds() {
                Some(bounds) => bounds,
                None => Aabb { min: Vec3A::ZERO, max: Vec3A::ZERO },
            },
            ObjectShape::Sphere { center, radius, .. } => {
                Aabb { min: *center - Vec3A::splat(radius.abs()), max: *center + Vec3A::splat(radius.abs()) }
            }
            ObjectShape::Disk => Aabb { min: Vec3A::new(-1.0, -1.0, 0.0), max: Vec3A::new(1.0, 1.0, 0.0) },
        };
        let corners: [Vec3A; 8] = core::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            self.to_world.transform_point3a(Vec3A::new(
                pick(0, local.min.x, local.max.x),
                pick(1, local.min.y, local.max.y),
                pick(2, local.min.z, local.max.z),
            ))
        });
        Aabb::from_points(&corners)
    }

    /// The closest hit in world distance, with the triangle and its barycentric coordinates for meshes.
    #[inline]
    fn closest(&self, ray: &Ray) -> Option<(f32, u32, f32, f32)> {
        let local = self.local_ray(ray);
        match &self.shape {
            ObjectShape::Mesh { bvh, .. } => bvh.closest(&local).map(|h| (h.hit.t, h.triangle, h.hit.u, h.hit.v)),
            ObjectShape::Sphere { center, radius, .. } => {
                intersect_sphere(*radius, local.origin - *center, local.direction, ray.max_distance)
                    .map(|t| (t, 0, 0.0, 0.0))
            }
            ObjectShape::Disk => {
                intersect_disk(local.origin, local.direction, ray.max_distance).map(|t| (t, 0, 0.0, 0.0))
            }
        }
    }

    #[inline]
    fn any(&self, ray: &Ray) -> bool {
        match &self.shape {
            ObjectShape::Mesh { bvh, .. } => bvh.any(&self.local_ray(ray)),
            _ => self.closest(ray).is_some(),
        }
    }
}

/// A mesh moved into the world.
#[derive(Clone, Debug)]
pub(crate) struct WorldMesh {
    pub mesh: Arc<TriangleMesh>,
    /// Index of the surface in the scene.
    pub surface: u32,
}

/// Which primitive was hit, and where on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WorldHit {
    pub distance: f32,
    /// Index of the surface in the scene.
    pub surface: u32,
    pub primitive: Primitive,
    pub u: f32,
    pub v: f32,
}

/// Where the geometry of a hit is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Primitive {
    /// Triangle of a mesh in world coordinates.
    World { mesh: u32, triangle: u32 },
    /// Triangle (zero for analytic shapes) of an object.
    Object { object: u32, triangle: u32 },
}

/// All surfaces, ready for rays.
#[derive(Clone, Debug)]
pub(crate) struct World {
    meshes: Vec<WorldMesh>,
    triangles: TriangleBvh,
    /// Mesh and triangle of each triangle of the hierarchy.
    origins: Vec<(u32, u32)>,
    objects: Vec<Object>,
    hierarchy: Hierarchy,
    bounds: Option<Aabb>,
}

impl World {
    pub(crate) fn new(meshes: Vec<WorldMesh>, objects: Vec<Object>) -> Self {
        let mut corners = Vec::new();
        let mut origins = Vec::new();
        for (index, world_mesh) in meshes.iter().enumerate() {
            for triangle in 0..world_mesh.mesh.len() {
                corners.push(world_mesh.mesh.corners(triangle));
                origins.push((index as u32, triangle as u32));
            }
        }
        let triangles = TriangleBvh::new(&corners);
        let boxes: Vec<Aabb> = objects.iter().map(Object::bounds).collect();
        let mut bounds = triangles.bounds();
        for b in &boxes {
            bounds = Some(bounds.map_or(*b, |all| Aabb { min: all.min.min(b.min), max: all.max.max(b.max) }));
        }
        let hierarchy = Hierarchy::new(&boxes);
        Self { meshes, triangles, origins, objects, hierarchy, bounds }
    }

    /// Bounds of everything; nothing if there is no surface.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        self.bounds
    }

    /// The closest hit.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray) -> Option<WorldHit> {
        if !is_traceable(ray) {
            return None;
        }
        let mut best = self.triangles.closest(ray).map(|h| {
            let (mesh, triangle) = self.origins[h.triangle as usize];
            WorldHit {
                distance: h.hit.t,
                surface: self.meshes[mesh as usize].surface,
                primitive: Primitive::World { mesh, triangle },
                u: h.hit.u,
                v: h.hit.v,
            }
        });
        if !self.objects.is_empty() {
            let limit = best.map_or(ray.max_distance, |hit| hit.distance);
            best = self.closest_object(&ray.up_to(limit)).or(best);
        }
        best
    }

    #[inline]
    fn closest_object(&self, ray: &Ray) -> Option<WorldHit> {
        let mut best = None;
        self.hierarchy.traverse(ray, ray.max_distance, |range, mut limit| {
            for &index in &self.hierarchy.order()[range] {
                let object = &self.objects[index as usize];
                if let Some((distance, triangle, u, v)) = object.closest(&ray.up_to(limit)) {
                    limit = distance;
                    let primitive = Primitive::Object { object: index, triangle };
                    best = Some(WorldHit { distance, surface: object.surface, primitive, u, v });
                }
            }
            limit
        });
        best
    }

    /// Whether anything is hit.
    #[inline]
    pub(crate) fn any(&self, ray: &Ray) -> bool {
        is_traceable(ray) && (self.triangles.any(ray) || (!self.objects.is_empty() && self.any_object(ray)))
    }

    #[inline]
    fn any_object(&self, ray: &Ray) -> bool {
        let mut found = false;
        self.hierarchy.traverse(ray, ray.max_distance, |range, limit| {
            found = self.hierarchy.order()[range].iter().any(|&index| self.objects[index as usize].any(ray));
            if found { -1.0 } else { limit }
        });
        found
    }

    /// The geometry at a hit.
    #[inline]
    pub(crate) fn local_geometry(&self, ray: &Ray, hit: &WorldHit, with_tangents: bool) -> LocalGeometry {
        match hit.primitive {
            Primitive::World { mesh, triangle } => {
                let mesh = &self.meshes[mesh as usize].mesh;
                LocalGeometry::of_triangle(mesh, triangle as usize, hit.u, hit.v, with_tangents)
            }
            Primitive::Object { object, triangle } => {
                let object = &self.objects[object as usize];
                let local = match &object.shape {
                    ObjectShape::Mesh { mesh, .. } => {
                        LocalGeometry::of_triangle(mesh, triangle as usize, hit.u, hit.v, with_tangents)
                    }
                    ObjectShape::Sphere { center, radius, flip_normals } => {
                        let position = object.to_object.transform_point3a(ray.at(hit.distance));
                        LocalGeometry::of_sphere(position, *center, *radius, *flip_normals)
                    }
                    ObjectShape::Disk => {
                        LocalGeometry::of_disk(object.to_object.transform_point3a(ray.at(hit.distance)))
                    }
                };
                local.transformed(object)
            }
        }
    }
}

/// Position, normals and tangents at a point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalGeometry {
    pub point: SurfacePoint,
    pub shading_normal: Vec3A,
    pub dpdu: Vec3A,
    pub dpdv: Vec3A,
}

impl LocalGeometry {
    /// Without `with_tangents`, the derivatives are any two edges.
    #[inline(always)]
    fn of_triangle(mesh: &TriangleMesh, triangle: usize, u: f32, v: f32, with_tangents: bool) -> Self {
        let indices = mesh.triangles()[triangle].map(|i| i as usize);
        let [a, b, c] = indices.map(|i| Vec3A::from(mesh.positions()[i]));
        let w = 1.0 - u - v;
        let (e1, e2) = (b - a, c - a);
        let position = a * w + b * u + c * v;
        let mut normal = e1.cross(e2).normalize_or(Vec3A::Z);
        let mut shading_normal = normal;
        if let [Some(na), Some(nb), Some(nc)] = indices.map(|i| mesh.normals().get(i).copied()) {
            let n = Vec3A::from(na) * w + Vec3A::from(nb) * u + Vec3A::from(nc) * v;
            if let Some(n) = n.try_normalize() {
                shading_normal = n;
                // The outside is where the vertex normals point, whatever the winding.
                normal *= 1.0f32.copysign(normal.dot(n));
            }
        }
        let magnitude = a.abs().max(b.abs()).max(c.abs()).max_element();
        let mut point = SurfacePoint { position, normal, uv: [u, v], error: SurfacePoint::error_of(magnitude) };
        let (mut dpdu, mut dpdv) = (e1, e2);
        if let [Some(ta), Some(tb), Some(tc)] = indices.map(|i| mesh.uvs().get(i).copied()) {
            point.uv = core::array::from_fn(|i| ta[i] * w + tb[i] * u + tc[i] * v);
            if !with_tangents {
                return Self { point, shading_normal, dpdu, dpdv };
            }
            let (d1, d2) = ([tb[0] - ta[0], tb[1] - ta[1]], [tc[0] - ta[0], tc[1] - ta[1]]);
            let determinant = d1[0] * d2[1] - d1[1] * d2[0];
            if determinant != 0.0 {
                let inverse = 1.0 / determinant;
                dpdu = (e1 * d2[1] - e2 * d1[1]) * inverse;
                dpdv = (e2 * d1[0] - e1 * d2[0]) * inverse;
            }
        }
        Self { point, shading_normal, dpdu, dpdv }
    }

    fn of_sphere(position: Vec3A, center: Vec3A, radius: f32, flip_normals: bool) -> Self {
        let outward = (position - center).normalize_or(Vec3A::Z);
        let normal = if flip_normals { -outward } else { outward };
        let position = center + outward * radius.abs();
        let magnitude = position.abs().max(center.abs()).max_element().max(radius.abs());
        let phi = outward.y.atan2(outward.x);
        let phi = if phi < 0.0 { phi + core::f32::consts::TAU } else { phi };
        let theta = outward.z.clamp(-1.0, 1.0).acos();
        let uv = [phi / core::f32::consts::TAU, theta / core::f32::consts::PI];
        let dpdu = Vec3A::new(-outward.y, outward.x, 0.0) * (core::f32::consts::TAU * radius);
        let dpdv =
            Vec3A::new(outward.z * phi.cos(), outward.z * phi.sin(), -theta.sin()) * (core::f32::consts::PI * radius);
        let point = SurfacePoint { position, normal, uv, error: SurfacePoint::error_of(magnitude) };
        Self { point, shading_normal: normal, dpdu, dpdv }
    }

    fn of_disk(position: Vec3A) -> Self {
        let r = position.truncate().length();
        let phi = position.y.atan2(position.x);
        let phi = if phi < 0.0 { phi + core::f32::consts::TAU } else { phi };
        let uv = [r, phi / core::f32::consts::TAU];
        let (sin, cos) = phi.sin_cos();
        let position = Vec3A::new(position.x, position.y, 0.0);
        let point = SurfacePoint { position, normal: Vec3A::Z, uv, error: SurfacePoint::error_of(1.0) };
        let dpdu = Vec3A::new(cos, sin, 0.0);
        let dpdv = Vec3A::new(-sin, cos, 0.0) * (core::f32::consts::TAU * r);
        Self { point, shading_normal: Vec3A::Z, dpdu, dpdv }
    }

    /// From the object's to the world's coordinates; the bound of the round-off grows by that of the transform.
    #[inline]
    fn transformed(mut self, object: &Object) -> Self {
        let m = &object.to_world;
        let p = self.point.position;
        let position = m.transform_point3a(p);
        let scale = m.matrix3.x_axis.abs() + m.matrix3.y_axis.abs() + m.matrix3.z_axis.abs();
        let passed = m.matrix3.x_axis.abs() * p.x.abs()
            + m.matrix3.y_axis.abs() * p.y.abs()
            + m.matrix3.z_axis.abs() * p.z.abs()
            + m.translation.abs();
        let magnitude = passed.max(position.abs()).max_element();
        self.point.error = SurfacePoint::error_of(magnitude) + self.point.error * scale.max_element();
        self.point.position = position;
        self.point.normal = (object.normal_matrix * self.point.normal).normalize_or(Vec3A::Z);
        self.shading_normal = (object.normal_matrix * self.shading_normal).normalize_or(self.point.normal);
        self.dpdu = m.transform_vector3a(self.dpdu);
        self.dpdv = m.transform_vector3a(self.dpdv);
        self
    }
}
