//! Densities of a path written down plainly: the path is traced anew, vertex by vertex, and every technique's density is a
//! product over all vertices.

use std::f64::consts::PI;

use scene_core::glam::Vec3A;
use scene_core::{Emitter, EmitterChoice, EmitterId, Ray, Scene, Sensor, SurfacePoint, TransportMode, Vertex};
use vpl_gi::PathTechniques;

/// How many samples each technique takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counts {
    pub(crate) per_eye_path: f64,
    pub(crate) to_lens: Option<f64>,
    /// Whether Dirac emitters are connected as wholes.
    pub(crate) deltas_once: bool,
    pub(crate) max_light_segments: usize,
}

/// Cosines below are flat.
const FLAT: f32 = 0.1;

enum End {
    Surface(EmitterId),
    Distant(EmitterId),
    Delta(EmitterId),
}

/// A path that was traced anew.
pub(crate) struct Flat<X> {
    lens: Vec3A,
    first: Vec3A,
    /// `x_1 ..`: all surfaces.
    vertices: Vec<X>,
    specular: Vec<bool>,
    end: End,
    /// Direction from `x_(l-1)` to `x_l`.
    last: Vec3A,
    /// Position of a Dirac emitter.
    source: Option<Vec3A>,
}

fn by_area(pdf: f64, from: Vec3A, to: &SurfacePoint) -> f64 {
    let (a, b, n) = (from.as_dvec3(), to.position.as_dvec3(), to.normal.as_dvec3());
    let between = b - a;
    pdf * between.normalize().dot(n).abs() / between.length_squared()
}

impl<X: Vertex> Flat<X> {
    /// Nothing if something is in between, or the path is so short or so flat that single precision does not tell much.
    pub(crate) fn of<'s, S: Scene<Vertex<'s> = X> + 's>(scene: &'s S, path: &impl PathTechniques) -> Option<Self> {
        let (_, radius) = scene.bounding_sphere();
        let l = path.segments();
        let lens = path.position(0).unwrap();
        let first = path.direction(0);
        let mut vertices: Vec<X> = Vec::new();
        let has_source = path.position(l).is_none() || !path.can_hit();
        let surfaces = if has_source { l - 1 } else { l };
        for k in 0..surfaces {
            let direction = path.direction(k);
            let ray = vertices.last().map_or(Ray::new(lens, direction), |x| x.spawn_ray(direction));
            let from = path.position(k).unwrap();
            if vertices.last().is_some_and(|x| x.point().normal.dot(direction).abs() < FLAT) {
                return None;
            }
            let hit = scene.intersect(&ray)?;
            let at = hit.point();
            let expected = path.position(k + 1).unwrap();
            let is_near = at.position.distance(expected) < 1e-4 * radius;
            if !is_near || from.distance(expected) < 0.1 * radius || at.normal.dot(direction).abs() < FLAT {
                return None;
            }
            vertices.push(hit);
        }
        let last = path.direction(l - 1);
        let source = path.position(l).filter(|_| has_source);
        if has_source {
            let x = vertices.last().unwrap();
            let ray = match source {
                Some(position) => x.point().ray_to(&SurfacePoint::in_space(position)),
                None => x.spawn_ray(last),
            };
            if scene.occluded(&ray) || x.point().normal.dot(last).abs() < FLAT {
                return None;
            }
        }
        let end = match (has_source, path.can_hit()) {
            (false, _) => End::Surface(vertices.last().unwrap().emitter().unwrap()),
            (true, true) => End::Distant(scene.environment().unwrap()),
            (true, false) => {
                let x = vertices.last().unwrap().point().position;
                let shines_from_there = |emitter: &S::Emitter| {
                    let direct = emitter.sample_direct(x, [0.5; 2])?;
                    (emitter.is_delta()
                        && direct.wi.dot(last) > 0.99999
                        && direct.at.map(|(point, _)| point.position) == source)
                        .then_some(())
                };
                let index = scene.emitters().iter().position(|emitter| shines_from_there(emitter).is_some()).unwrap();
                End::Delta(EmitterId(index as u32))
            }
        };
        let specular = (0..=l).map(|k| path.is_specular(k)).collect();
        Some(Self { lens, first, vertices, specular, end, last, source })
    }

    fn segments(&self) -> usize {
        self.vertices.len() + usize::from(!matches!(self.end, End::Surface(_)))
    }

    /// Direction from `x_k` to the next vertex.
    fn onwards(&self, k: usize) -> Vec3A {
        if k < self.vertices.len() { -self.vertices[k].wo() } else { self.last }
    }

    /// `p_eye(x_k)`, over that of the lens.
    fn eye(&self, scene: &impl Scene, k: usize) -> f64 {
        if k == 1 {
            let [width, height] = scene.sensor().resolution();
            let pdf = scene.sensor().pdf_ray(self.lens, self.first).1;
            let pdf = f64::from(pdf) * f64::from(width) * f64::from(height);
            return by_area(pdf, self.lens, self.vertices[0].point());
        }
        let x = &self.vertices[k - 2];
        let pdf = match self.specular[k - 1] {
            true => 1.0,
            false => f64::from(x.pdf_solid_angle(self.onwards(k - 1), TransportMode::Radiance)),
        };
        match self.vertices.get(k - 1) {
            Some(next) => by_area(pdf, x.point().position, next.point()),
            None if matches!(self.end, End::Delta(_)) => 0.0,
            None => pdf,
        }
    }

    /// `p_light(x_k)`.
    fn light(&self, scene: &impl Scene, choice: &impl EmitterChoice, k: usize) -> f64 {
        let l = self.segments();
        let (End::Surface(id) | End::Distant(id) | End::Delta(id)) = self.end;
        let emitter = &scene.emitters()[id.index()];
        let at = match (&self.end, self.source) {
            (End::Surface(_), _) => self.vertices.last().map(|x| *x.point()),
            (_, source) => source.map(SurfacePoint::in_space),
        };
        let (area, solid_angle) = emitter.pdf_emission(at.as_ref(), -self.onwards(l - 1));
        if k == l {
            let probability = f64::from(choice.probability(None, id));
            return probability
                * match self.end {
                    End::Surface(_) => f64::from(area),
                    End::Distant(_) => f64::from(solid_angle),
                    End::Delta(_) => 1.0,
                };
        }
        let x = self.vertices[k - 1].point();
        if k + 1 == l {
            return match at {
                Some(at) => by_area(f64::from(solid_angle), at.position, x),
                None => f64::from(area) * f64::from(x.normal.dot(self.last).abs()),
            };
        }
        let next = &self.vertices[k];
        let pdf = match self.specular[k + 1] {
            true => 1.0,
            false => {
                let from = next.reversed(self.onwards(k + 1));
                f64::from(from.pdf_solid_angle(next.wo(), TransportMode::Importance))
            }
        };
        by_area(pdf, next.point().position, x)
    }

    /// `n_i p_i` of all techniques of the set.
    pub(crate) fn densities(&self, scene: &impl Scene, choice: &impl EmitterChoice, counts: Counts) -> Vec<f64> {
        let l = self.segments();
        let is_delta = matches!(self.end, End::Delta(_));
        let techniques = l + usize::from(counts.to_lens.is_some() && l > 1);
        let density = |i: usize| {
            let (x, y) = (l - i, l - i + 1);
            let is_possible = match i {
                0 => !is_delta,
                _ => i - 1 <= counts.max_light_segments && !self.specular[x] && !self.specular[y],
            };
            if !is_possible {
                return 0.0;
            }
            let product: f64 = (1..=x).map(|k| self.eye(scene, k)).product::<f64>()
                * (y..=l).map(|k| self.light(scene, choice, k)).product::<f64>();
            let n = match i {
                0 => 1.0,
                1 if is_delta && counts.deltas_once => return product / self.light(scene, choice, l),
                _ if i == l => counts.to_lens.unwrap(),
                _ => counts.per_eye_path,
            };
            n * product
        };
        (0..techniques).map(density).collect()
    }
}

/// A closed form to try the oracle on: a Lambertian vertex seen at a right angle from a distance of 2.
#[test]
fn density_by_area_of_a_lambertian_direction() {
    let to = SurfacePoint::new(Vec3A::Z * 2.0, Vec3A::Z);
    assert!((by_area(1.0 / PI, Vec3A::ZERO, &to) - 1.0 / (4.0 * PI)).abs() < 1e-12);
}
