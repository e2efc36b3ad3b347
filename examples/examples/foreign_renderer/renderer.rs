//! A renderer that knows nothing of the crates: spheres and rectangles, scattering functions, and a path tracer that
//! waits until it hits the lamp.

use std::f64::consts::{PI, TAU};

use crate::vector::V;

/// Diffuse, with a lobe of Phong's around the mirrored direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    pub diffuse: V,
    pub gloss: f64,
    pub exponent: f64,
}

impl Bsdf {
    pub fn value(&self, n: V, wo: V, wi: V) -> V {
        if n.dot(wi) <= 0.0 || n.dot(wo) <= 0.0 {
            return V::default();
        }
        let lobe = (n * (2.0 * n.dot(wo)) - wo).dot(wi).max(0.0).powf(self.exponent);
        self.diffuse * (1.0 / PI) + V::splat(self.gloss * (self.exponent + 2.0) / TAU * lobe)
    }

    pub fn pdf(&self, n: V, wo: V, wi: V) -> f64 {
        if n.dot(wi) <= 0.0 || n.dot(wo) <= 0.0 {
            return 0.0;
        }
        let lobe = (n * (2.0 * n.dot(wo)) - wo).dot(wi).max(0.0).powf(self.exponent) * (self.exponent + 1.0) / TAU;
        self.glossy_share() * lobe + (1.0 - self.glossy_share()) * n.dot(wi) / PI
    }

    fn glossy_share(&self) -> f64 {
        if self.gloss > 0.0 { 0.5 } else { 0.0 }
    }

    /// A direction, `f cos / pdf`, and the density.
    pub fn sample(&self, n: V, wo: V, [lobe, u, v]: [f64; 3]) -> Option<(V, V, f64)> {
        let wi = if lobe < self.glossy_share() {
            (n * (2.0 * n.dot(wo)) - wo).around((1.0 - u).powf(1.0 / (self.exponent + 1.0)), v)
        } else {
            n.around((1.0 - u).sqrt(), v)
        };
        let pdf = self.pdf(n, wo, wi);
        (pdf > 0.0).then(|| (wi, self.value(n, wo, wi) * (n.dot(wi) / pdf), pdf))
    }
}

#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Sphere { center: V, radius: f64 },
    Rectangle { corner: V, x: V, y: V },
}

#[derive(Clone, Copy, Debug)]
pub struct Object {
    pub shape: Shape,
    pub bsdf: Bsdf,
    /// Radiance of the front.
    pub emission: V,
}

/// A point that was hit, with the normal on the side of `wo`.
#[derive(Clone, Copy, Debug)]
pub struct Hit<'s> {
    pub object: &'s Object,
    pub p: V,
    pub n: V,
    pub wo: V,
    pub is_front: bool,
}

impl Object {
    fn distance(&self, o: V, d: V, limit: f64) -> Option<f64> {
        let inside = |t: &f64| *t > 1e-7 && *t < limit;
        match self.shape {
            Shape::Sphere { center, radius } => {
                let along = (center - o).dot(d);
                let root = (along * along - (center - o).dot(center - o) + radius * radius).sqrt();
                [along - root, along + root].into_iter().find(inside)
            }
            Shape::Rectangle { corner, x, y } => {
                let n = x.cross(y);
                let t = (corner - o).dot(n) / d.dot(n);
                let q = o + d * t - corner;
                let is_in = |edge: V| (0.0..=1.0).contains(&(q.dot(edge) / edge.dot(edge)));
                Some(t).filter(|t| inside(t) && is_in(x) && is_in(y))
            }
        }
    }

    fn normal(&self, p: V) -> V {
        match self.shape {
            Shape::Sphere { center, .. } => (p - center).unit(),
            Shape::Rectangle { x, y, .. } => x.cross(y).unit(),
        }
    }

    /// A point of a rectangle, its normal, and the area.
    pub fn point(&self, u: f64, v: f64) -> (V, V, f64) {
        match self.shape {
            Shape::Rectangle { corner, x, y } => (corner + x * u + y * v, x.cross(y).unit(), x.cross(y).length()),
            Shape::Sphere { center, radius } => (center, V::default(), 2.0 * TAU * radius * radius),
        }
    }
}

impl Hit<'_> {
    pub fn emitted(&self) -> V {
        if self.is_front { self.object.emission } else { V::default() }
    }
    /// The scattering function, without a cosine.
    pub fn value(&self, wi: V) -> V {
        self.object.bsdf.value(self.n, self.wo, wi)
    }
    pub fn pdf(&self, wi: V) -> f64 {
        self.object.bsdf.pdf(self.n, self.wo, wi)
    }
    pub fn sample(&self, u: [f64; 3]) -> Option<(V, V, f64)> {
        self.object.bsdf.sample(self.n, self.wo, u)
    }
}

pub const WIDTH: usize = 32;
pub const HEIGHT: usize = 24;

/// It looks along z through the open side of a box, 4/3 wide, 1 high.
pub struct Camera {
    pub eye: V,
}

impl Camera {
    /// A ray through a place in the image, in pixels.
    pub fn ray(&self, x: f64, y: f64) -> (V, V) {
        let scale = 1.0 / HEIGHT as f64;
        (self.eye, (V(x * scale, 1.0 - y * scale, 0.0) - self.eye).unit())
    }
}

pub struct Scene {
    /// The first one is the lamp, a rectangle.
    pub objects: Vec<Object>,
    pub camera: Camera,
}

/// A box with a lamp, a diffuse and a glossy sphere.
pub fn cornell() -> Scene {
    let diffuse = |r, g, b| Bsdf { diffuse: V(r, g, b), gloss: 0.0, exponent: 1.0 };
    let dark = |shape, bsdf| Object { shape, bsdf, emission: V::default() };
    let wall = |corner, x, y, bsdf| dark(Shape::Rectangle { corner, x, y }, bsdf);
    let ball = |center, radius, bsdf| dark(Shape::Sphere { center, radius }, bsdf);
    let (x, y, z, white) = (V(4.0 / 3.0, 0.0, 0.0), V(0.0, 1.0, 0.0), V(0.0, 0.0, 1.0), diffuse(0.7, 0.7, 0.7));
    let lamp = wall(V(0.25, 0.98, 0.2), V(0.8, 0.0, 0.0), V(0.0, 0.0, 0.6), diffuse(0.0, 0.0, 0.0));
    let glossy = Bsdf { diffuse: V(0.2, 0.2, 0.3), gloss: 0.5, exponent: 20.0 };
    let objects = vec![
        Object { emission: V(6.0, 5.0, 4.0), ..lamp },
        wall(V::default(), z, x, white),
        wall(y, x, z, white),
        wall(z, x, y, white),
        wall(V::default(), y, z, diffuse(0.7, 0.1, 0.1)),
        wall(x, z, y, diffuse(0.1, 0.6, 0.1)),
        ball(V(0.4, 0.25, 0.6), 0.25, diffuse(0.6, 0.6, 0.7)),
        ball(V(0.95, 0.2, 0.35), 0.2, glossy),
    ];
    Scene { objects, camera: Camera { eye: V(2.0 / 3.0, 0.5, -1.2) } }
}

/// Uniform numbers.
pub type Numbers<'a> = dyn FnMut() -> f64 + 'a;

impl Scene {
    pub fn hit(&self, (o, d): (V, V), limit: f64) -> Option<Hit<'_>> {
        let mut nearest = (limit, None);
        for object in &self.objects {
            if let Some(t) = object.distance(o, d, nearest.0) {
                nearest = (t, Some(object));
            }
        }
        let (p, object) = (o + d * nearest.0, nearest.1?);
        let n = object.normal(p);
        let is_front = n.dot(d) < 0.0;
        Some(Hit { object, p, n: if is_front { n } else { n * -1.0 }, wo: d * -1.0, is_front })
    }

    pub fn is_free(&self, (o, d): (V, V), limit: f64) -> bool {
        self.objects.iter().all(|object| object.distance(o, d, limit).is_none())
    }

    pub fn lamp(&self) -> &Object {
        &self.objects[0]
    }

    /// What `x` reflects of the lamp's point `y`, per area, if nothing is in between; with the direction, and the factor
    /// from area to solid angle.
    pub fn unshadowed(&self, x: &Hit<'_>, y: V) -> (V, V, f64) {
        let distance = (y - x.p).length();
        let wi = (y - x.p) * (1.0 / distance);
        let per_area = (-self.lamp().normal(y).dot(wi)).max(0.0) / (distance * distance);
        (x.value(wi) * self.lamp().emission * (x.n.dot(wi).max(0.0) * per_area), wi, per_area)
    }

    pub fn sees(&self, x: &Hit<'_>, y: V) -> bool {
        let distance = (y - x.p).length();
        self.is_free((x.p, (y - x.p) * (1.0 / distance)), distance - 1e-6)
    }

    /// The truth: radiance that took one segment, two, more.
    pub fn brute_force(&self, mut ray: (V, V), u: &mut Numbers<'_>) -> [V; 3] {
        let (mut found, mut throughput) = ([V::default(); 3], V::splat(1.0));
        for length in 1_usize.. {
            let Some(x) = self.hit(ray, f64::INFINITY) else { break };
            let of = &mut found[length.min(3) - 1];
            *of += throughput * x.emitted();
            let Some((wi, weight, _)) = x.sample([u(), u(), u()]) else { break };
            match survive(throughput * weight, length, u) {
                Some(alive) => throughput = alive,
                None => break,
            }
            ray = (x.p, wi);
        }
        found
    }

    /// What `x` reflects, by next event estimation and scattered rays, which `weight(technique, densities)` combines.
    pub fn reflected<'s>(&'s self, mut x: Hit<'s>, u: &mut Numbers<'_>, weight: impl Fn(usize, [f64; 2]) -> f64) -> V {
        let (mut sum, mut throughput) = (V::default(), V::splat(1.0));
        for length in 1_usize.. {
            let (y, _, area) = self.lamp().point(u(), u());
            let (value, wi, per_area) = self.unshadowed(&x, y);
            if value.largest() > 0.0 && self.sees(&x, y) {
                let share = weight(0, [1.0 / (area * per_area), x.pdf(wi)]);
                sum += throughput * value * (area * share);
            }
            let Some((wi, factor, pdf)) = x.sample([u(), u(), u()]) else { break };
            let Some(next) = self.hit((x.p, wi), f64::INFINITY) else { break };
            if next.emitted().largest() > 0.0 {
                let share = weight(1, [1.0 / (area * self.unshadowed(&x, next.p).2), pdf]);
                sum += throughput * factor * next.emitted() * share;
            }
            match survive(throughput * factor, length, u) {
                Some(alive) => throughput = alive,
                None => break,
            }
            x = next;
        }
        sum
    }

    /// A path from the lamp: shows where it arrives with what flux.
    pub fn light_path(&self, u: &mut Numbers<'_>, mut visit: impl FnMut(&Hit<'_>, V)) {
        let (p, n, area) = self.lamp().point(u(), u());
        let mut flux = self.lamp().emission * (PI * area);
        let mut ray = (p, n.around((1.0 - u()).sqrt(), u()));
        for length in 1_usize.. {
            let Some(x) = self.hit(ray, f64::INFINITY) else { return };
            visit(&x, flux);
            let Some((wi, weight, _)) = x.sample([u(), u(), u()]) else { return };
            // Russian roulette by albedo: all photons carry about the same.
            match survive(weight, length + 3, u) {
                Some(alive) => flux *= alive,
                None => return,
            }
            ray = (x.p, wi);
        }
    }
}

/// Russian roulette from the fourth segment on.
fn survive(throughput: V, length: usize, u: &mut Numbers<'_>) -> Option<V> {
    let survival = if length > 3 { throughput.largest().min(0.95) } else { 1.0 };
    (u() < survival).then(|| throughput * (1.0 / survival))
}
