//! Light from all around: constant, or an equirectangular image sampled by importance.

use core::f32::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

use glam::{Mat3A, Vec3A};
use qmc_sampling::warp::{PiecewiseConstant2d, sample_concentric_disk, sample_uniform_sphere};

use crate::frame::Frame;
use crate::ray::SurfacePoint;
use crate::texture::Image;
use crate::traits::{DirectSample, EmissionSample, Rgb, Spectrum};

/// Radiance from infinity. Power: `pi R^2 integral L dw`, what enters the scene's bounding sphere of radius `R`.
#[derive(Clone, Debug)]
pub struct EnvironmentEmitter {
    radiance: Radiance,
    center: Vec3A,
    radius: f32,
    /// Integral of the radiance over all directions, in W/m^2.
    total: Rgb,
}

#[derive(Clone, Debug)]
enum Radiance {
    Constant(Rgb),
    Image(Arc<RadianceImage>),
}

/// Nodes of a bilinear grid: node `(i, j)` lies at `u = (i + 1/2) / width` (periodic) and `v = j / (height - 1)`, as in
/// Mitsuba 3. Below, `s = u - 1 / (2 width)` puts the nodes at the borders of the cells.
#[derive(Debug)]
struct RadianceImage {
    nodes: Vec<Rgb>,
    width: usize,
    height: usize,
    /// Cells between four nodes, weighted by luminance and solid angle.
    cells: PiecewiseConstant2d,
    to_world: Mat3A,
    to_local: Mat3A,
}

impl RadianceImage {
    fn new(image: &Image, scale: f32, to_world: Mat3A) -> Option<Self> {
        let (width, height) = (image.width() as usize, (image.height() as usize).max(2));
        let clean = |rgb: Rgb| (rgb * scale).map(|x| if x.is_finite() { x.max(0.0) } else { 0.0 });
        let last = image.height().saturating_sub(1);
        let pixel = |i: usize, j: usize| clean(image.pixel(i as u32, (j as u32).min(last)));
        let nodes: Vec<Rgb> = (0..width * height).map(|k| pixel(k % width, k / width)).collect();
        let node = |i: usize, j: usize| nodes[j * width + i % width].luminance();
        let mut weights = vec![0.0; width * (height - 1)];
        for j in 0..height - 1 {
            let sin_theta = (PI * (j as f32 + 0.5) / (height - 1) as f32).sin();
            for i in 0..width {
                let mean = 0.25 * (node(i, j) + node(i + 1, j) + node(i, j + 1) + node(i + 1, j + 1));
                weights[j * width + i] = mean * sin_theta;
            }
        }
        let cells = PiecewiseConstant2d::new(&weights, width, height - 1).ok()?;
        let to_local = to_world.inverse();
        Some(Self { nodes, width, height, cells, to_world, to_local })
    }

    #[inline]
    fn lookup(&self, s: f32, v: f32) -> Rgb {
        let x = s * self.width as f32;
        let y = v.clamp(0.0, 1.0) * (self.height - 1) as f32;
        let (i, j) = ((x as usize).min(self.width - 1), (y as usize).min(self.height - 2));
        let (fx, fy) = (x - i as f32, y - j as f32);
        let next = if i + 1 == self.width { 0 } else { i + 1 };
        let row = |j: usize| self.nodes[j * self.width + i] * (1.0 - fx) + self.nodes[j * self.width + next] * fx;
        row(j) * (1.0 - fy) + row(j + 1) * fy
    }

    /// `s` in [0, 1), `v` and the sine of the polar angle.
    #[inline]
    fn coordinates(&self, direction: Vec3A) -> (f32, f32, f32) {
        let d = (self.to_local * direction).normalize_or(Vec3A::Y);
        let s = d.x.atan2(-d.z) * (0.5 * FRAC_1_PI) - 0.5 / self.width as f32;
        let sin_theta = (d.x * d.x + d.z * d.z).sqrt();
        let v = sin_theta.atan2(d.y) * FRAC_1_PI;
        (s - s.floor(), v, sin_theta)
    }

    #[inline]
    fn direction(&self, s: f32, v: f32) -> (Vec3A, f32) {
        let (sin_phi, cos_phi) = (TAU * (s + 0.5 / self.width as f32)).sin_cos();
        let (sin_theta, cos_theta) = (PI * v).sin_cos();
        let local = Vec3A::new(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta);
        ((self.to_world * local).normalize_or(Vec3A::Y), sin_theta)
    }

    /// Integral over the sphere, exactly: each row of nodes weighs the integral of its hat function times the sine.
    fn integral(&self) -> Rgb {
        use core::f64::consts::{PI, TAU};
        let step = PI / (self.height - 1) as f64;
        let mut total = [0.0f64; 3];
        for j in 0..self.height - 1 {
            let ((sin_0, cos_0), (sin_1, cos_1)) = ((step * j as f64).sin_cos(), (step * (j + 1) as f64).sin_cos());
            // integral over the strip of (theta - theta_j) / step sin(theta), and what remains of the strip.
            let lower = (sin_1 - sin_0) / step - cos_1;
            let upper = cos_0 - cos_1 - lower;
            for (row, weight) in [(j, upper), (j + 1, lower)] {
                let weight = weight * TAU / self.width as f64;
                for node in &self.nodes[row * self.width..(row + 1) * self.width] {
                    (0..3).for_each(|c| total[c] += weight * f64::from(node[c]));
                }
            }
        }
        Rgb::from(total.map(|x| x as f32))
    }
}

impl EnvironmentEmitter {
    pub(crate) fn constant(radiance: Rgb, center: Vec3A, radius: f32) -> Self {
        Self { radiance: Radiance::Constant(radiance), center, radius, total: radiance * (4.0 * PI) }
    }

    /// An image; nothing if it is black.
    pub(crate) fn image(image: &Image, scale: f32, to_world: Mat3A, center: Vec3A, radius: f32) -> Option<Self> {
        let image = RadianceImage::new(image, scale, to_world)?;
        let total = image.integral();
        Some(Self { radiance: Radiance::Image(Arc::new(image)), center, radius, total })
    }

    /// A direction to look in for light, with radiance and density.
    #[inline]
    fn sample_direction(&self, u: [f32; 2]) -> Option<(Vec3A, Rgb, f32)> {
        match &self.radiance {
            Radiance::Constant(radiance) => Some((sample_uniform_sphere(u).into(), *radiance, 0.25 * FRAC_1_PI)),
            Radiance::Image(image) => {
                let ([s, v], pdf, _) = image.cells.sample(u);
                let (direction, sin_theta) = image.direction(s, v);
                let pdf = pdf / (2.0 * PI * PI * sin_theta);
                (pdf > 0.0 && pdf.is_finite()).then(|| (direction, image.lookup(s, v), pdf))
            }
        }
    }

    #[inline]
    fn pdf_direction(&self, direction: Vec3A) -> f32 {
        match &self.radiance {
            Radiance::Constant(_) => 0.25 * FRAC_1_PI,
            Radiance::Image(image) => {
                let (s, v, sin_theta) = image.coordinates(direction);
                let pdf = image.cells.pdf([s, v]) / (2.0 * PI * PI * sin_theta);
                if pdf.is_finite() { pdf } else { 0.0 }
            }
        }
    }

    pub(super) fn power(&self) -> Rgb {
        self.total * (PI * self.radius * self.radius)
    }

    #[inline]
    pub(super) fn sample_direct(&self, _from: Vec3A, u: [f32; 2]) -> Option<DirectSample<Rgb>> {
        let (wi, radiance, pdf_solid_angle) = self.sample_direction(u)?;
        Some(DirectSample { wi, at: None, radiance, pdf_solid_angle, is_delta: false })
    }

    #[inline]
    pub(super) fn pdf_direct(&self, _from: Vec3A, wi: Vec3A, _at: Option<&SurfacePoint>) -> f32 {
        self.pdf_direction(wi)
    }

    #[inline]
    pub(super) fn sample_emission(&self, u_position: [f32; 2], u: [f32; 2]) -> Option<EmissionSample<Rgb>> {
        let (towards, radiance, pdf_solid_angle) = self.sample_direction(u)?;
        let [x, y] = sample_concentric_disk(u_position);
        let offset = Frame::from_z(towards).to_world(Vec3A::new(x, y, 1.0)) * self.radius;
        let area = PI * self.radius * self.radius;
        Some(EmissionSample {
            point: SurfacePoint::in_space(self.center + offset),
            direction: -towards,
            flux: radiance * (area / pdf_solid_angle),
            pdf_area: 1.0 / area,
            pdf_solid_angle,
        })
    }

    #[inline]
    pub(super) fn pdf_emission(&self, _at: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        (1.0 / (PI * self.radius * self.radius), self.pdf_direction(-direction))
    }

    /// Radiance seen when looking in `direction`; nothing on surfaces.
    #[inline]
    pub(super) fn radiance(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Rgb {
        if at.is_some() {
            return Rgb::ZERO;
        }
        match &self.radiance {
            Radiance::Constant(radiance) => *radiance,
            Radiance::Image(image) => {
                let (s, v, _) = image.coordinates(direction);
                image.lookup(s, v)
            }
        }
    }
}
