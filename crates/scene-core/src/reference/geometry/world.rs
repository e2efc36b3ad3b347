//! All surfaces of a scene, in two levels.
//!
//! Meshes that are placed once (or small) are moved into the world and share one hierarchy of triangles. Everything else
//! (large meshes placed several times, spheres, disks) is an object of a second hierarchy, entered with the ray in the object's coordinates.

use std::sync::Arc;

use glam::{Affine3A, Vec3A};
use obvhs::aabb::Aabb;

use super::analytic::{intersect_disk, intersect_sphere};
use super::hierarchy::Hierarchy;
use super::local_geometry::LocalGeometry;
use super::mesh::TriangleMesh;
use super::shading_triangle::Triangles;
use super::triangle_bvh::is_traceable;
use crate::ray::Ray;

/// What one object is, in its own coordinates.
#[derive(Clone, Debug)]
pub(crate) enum ObjectShape {
    Mesh(Arc<Triangles>),
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
            ObjectShape::Mesh(triangles) => match triangles.bvh().bounds() {
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

    /// The closest hit in world distance, with the slot of the triangle and its barycentric coordinates for meshes.
    #[inline]
    fn closest(&self, ray: &Ray) -> Option<(f32, u32, f32, f32)> {
        let local = self.local_ray(ray);
        match &self.shape {
            ObjectShape::Mesh(triangles) => {
                triangles.bvh().closest(&local).map(|h| (h.hit.t, h.slot, h.hit.u, h.hit.v))
            }
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
            ObjectShape::Mesh(triangles) => triangles.bvh().any(&self.local_ray(ray)),
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
    /// Slot of a triangle in world coordinates.
    World { slot: u32 },
    /// Slot of a triangle (zero for analytic shapes) of an object.
    Object { object: u32, slot: u32 },
}

/// All surfaces, ready for rays.
#[derive(Clone, Debug)]
pub(crate) struct World {
    triangles: Triangles,
    objects: Vec<Object>,
    hierarchy: Hierarchy,
    bounds: Option<Aabb>,
}

impl World {
    pub(crate) fn new(meshes: Vec<WorldMesh>, objects: Vec<Object>) -> Self {
        let triangles = Triangles::new(meshes.iter().map(|placed| (&*placed.mesh, placed.surface)));
        let boxes: Vec<Aabb> = objects.iter().map(Object::bounds).collect();
        let mut bounds = triangles.bvh().bounds();
        for b in &boxes {
            bounds = Some(bounds.map_or(*b, |all| Aabb { min: all.min.min(b.min), max: all.max.max(b.max) }));
        }
        let hierarchy = Hierarchy::new(&boxes);
        Self { triangles, objects, hierarchy, bounds }
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
        let mut best = self.triangles.bvh().closest(ray).map(|h| WorldHit {
            distance: h.hit.t,
            surface: self.triangles.surface(h.slot),
            primitive: Primitive::World { slot: h.slot },
            u: h.hit.u,
            v: h.hit.v,
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
        self.hierarchy.traverse(ray, ray.max_distance, |pack, mut limit| {
            for &index in self.hierarchy.pack(pack) {
                let object = &self.objects[index as usize];
                if let Some((distance, slot, u, v)) = object.closest(&ray.up_to(limit)) {
                    limit = distance;
                    let primitive = Primitive::Object { object: index, slot };
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
        is_traceable(ray) && (self.triangles.bvh().any(ray) || (!self.objects.is_empty() && self.any_object(ray)))
    }

    #[inline]
    fn any_object(&self, ray: &Ray) -> bool {
        let found = |pack| self.hierarchy.pack(pack).iter().any(|&index| self.objects[index as usize].any(ray));
        self.hierarchy.any(ray, ray.max_distance, found)
    }

    /// The geometry at a hit.
    #[inline]
    pub(crate) fn local_geometry(&self, ray: &Ray, hit: &WorldHit, with_tangents: bool) -> LocalGeometry {
        match hit.primitive {
            Primitive::World { slot } => self.triangles.geometry(slot, hit.u, hit.v, with_tangents),
            Primitive::Object { object, slot } => {
                let object = &self.objects[object as usize];
                let local = match &object.shape {
                    ObjectShape::Mesh(triangles) => triangles.geometry(slot, hit.u, hit.v, with_tangents),
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
