//! The laws of `Sensor`.

use scene_core::{Ray, Sensor, SensorRay};

use super::{direction, is_unit};
use crate::domain::Sphere;
use crate::laws::{Law, hold, near};
use crate::normalisation::{Normalisation, Total};
use crate::outcome::{Outcome, Report};
use crate::seed::{Uniforms, seed};

/// Rays that are looked at.
const RAYS: usize = 1000;
/// How far two places on the raster may be from each other and still be the same, as a share of its size.
const RASTER: f32 = 1e-4;
/// Relative tolerance of densities and weights.
const TOLERANCE: f64 = 0.02;
/// A step on the film or the lens, as a share of its size.
const STEP: f32 = 2e-3;

/// Checks the laws of a [`Sensor`] with the default [`SensorLaws`].
///
/// ```
/// # fn camera<S: scene_core::Scene>(scene: &S) {
/// estimator_checks::laws::scene::check_sensor("camera", scene.sensor()).expect_pass();
/// # }
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_sensor(test: &str, sensor: &impl Sensor) -> Report {
    SensorLaws::new().run(test, sensor)
}

/// Checks the laws of a [`Sensor`].
///
/// ```text
/// (1)  rays have unit directions; weights are finite and positive
/// (2)  connect from a point on a ray, with the same place on the lens, returns the same raster position, the opposite direction,
///      the distance, and a lens that looks towards the point
/// (3)  pdf_solid_angle |d(dir)/dx x d(dir)/dy| width height = 1          by finite differences on the raster
/// (4)  pdf_area |d(lens)/du x d(lens)/dv| = 1, or pdf_area = 1 for a pinhole
/// (5)  weight of the connection = weight of the ray * pdf_solid_angle * width * height / distance^2
/// (6)  pdf_solid_angle integrates to at most one
/// ```
///
/// `dir`: direction of the ray through raster position `(x, y)`; `lens`: its origin at `(u, v)`. (3) says that `pdf_ray` is
/// what [`Sensor::sample_ray`] does with uniform raster positions, and with (5) that the measurement of a pixel is the
/// mean radiance over it: `W_e |cos|` is the weight over the densities. (6) finds densities where there is no film.
///
/// Nothing of it is random but the places that are looked at: densities and weights agree within 2 %, the error of the finite
/// differences; raster positions within 1e-4 of the raster. Cost: some 10 000 rays, and the quadrature of (6).
#[derive(Clone, Copy, Debug)]
pub struct SensorLaws {
    connections: bool,
}

impl Default for SensorLaws {
    fn default() -> Self {
        Self::new()
    }
}

impl SensorLaws {
    /// All laws.
    pub fn new() -> Self {
        Self { connections: true }
    }

    /// Leaves out all but (1): for sensors that only ever start paths, whose `connect` and `pdf_ray` return nothing.
    #[must_use]
    pub fn without_connections(self) -> Self {
        Self { connections: false }
    }

    /// Checks the laws: two outcomes, or one.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn run(&self, test: &str, sensor: &impl Sensor) -> Report {
        let mut uniforms = Uniforms::new(seed(test));
        let exact = Outcome::of_laws(test, self.laws(sensor, &mut uniforms));
        let mut outcomes = vec![exact];
        if self.connections && outcomes[0].passed() {
            let [width, height] = sensor.resolution().map(|n| n as f32);
            let ray = |x: f32, y: f32| sensor.sample_ray([x * width, y * height], [0.5; 2]).ray;
            let lens = ray(0.5, 0.5).origin;
            let quadrature = Normalisation::on(Sphere).total(Total::AtMostOne).tolerance(TOLERANCE);
            let film = [(0.5, 0.5), (0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9)];
            let quadrature = film
                .into_iter()
                .fold(quadrature, |quadrature, (x, y)| quadrature.peak(ray(x, y).direction.to_array().map(f64::from)));
            let density = |w: [f64; 3]| sensor.pdf_ray(lens, direction(w)).1.into();
            outcomes.push(quadrature.run(&format!("{test}: the density of all rays"), density));
        }
        Report { outcomes }
    }

    fn laws(&self, sensor: &impl Sensor, uniforms: &mut Uniforms) -> Law {
        let resolution = sensor.resolution();
        hold("a sensor has pixels", resolution.iter().all(|&n| n > 0), || format!("{resolution:?}"))?;
        let [width, height] = resolution.map(|n| n as f32);
        for _ in 0..RAYS {
            let [x, y, u, v, distance] = uniforms.array().map(|u| u as f32);
            // Finite differences stay on the film, and clear of the seams of what maps squares to lenses.
            let inside = |x: f32| 0.01 + 0.98 * x;
            let raster = [inside(x) * width, inside(y) * height];
            let u_lens = [inside(u), inside(v)];
            let sampled = sensor.sample_ray(raster, u_lens);
            let SensorRay { ray, weight } = sampled;
            let shown = || format!("{sampled:?} at {raster:?}, lens {u_lens:?}");
            let finite = ray.origin.is_finite() && ray.max_distance > 0.0;
            hold("rays are finite, of unit direction", finite && is_unit(ray.direction), shown)?;
            hold("weights are finite and positive", weight.is_finite() && weight > 0.0, shown)?;
            if self.connections {
                let film = solid_angle(sensor, raster, u_lens);
                let (area, angle) = sensor.pdf_ray(ray.origin, ray.direction);
                let shown = || format!("{angle} and {film} sr for the film, {}", shown());
                let same = near(f64::from(angle) * film, 1.0, TOLERANCE);
                hold("pdf_ray is the density of rays by solid angle", same, shown)?;
                lens(sensor, raster, u_lens, area)?;
                connection(sensor, sampled, raster, u_lens, 0.1 * (10.0 * distance).exp2())?;
            }
        }
        Ok(())
    }
}

/// The solid angle that the whole film would have if it were as dense everywhere as here.
fn solid_angle(sensor: &impl Sensor, [x, y]: [f32; 2], u_lens: [f32; 2]) -> f64 {
    let [width, height] = sensor.resolution().map(|n| n as f32);
    let towards =
        |dx: f32, dy: f32| sensor.sample_ray([x + dx * width, y + dy * height], u_lens).ray.direction.as_dvec3();
    let along_x = towards(STEP, 0.0) - towards(-STEP, 0.0);
    let along_y = towards(0.0, STEP) - towards(0.0, -STEP);
    along_x.cross(along_y).length() / f64::from(4.0 * STEP * STEP)
}

/// (4)
fn lens(sensor: &impl Sensor, raster: [f32; 2], [u, v]: [f32; 2], pdf: f32) -> Law {
    let place = |du: f32, dv: f32| sensor.sample_ray(raster, [u + du, v + dv]).ray.origin.as_dvec3();
    let along_u = place(STEP, 0.0) - place(-STEP, 0.0);
    let along_v = place(0.0, STEP) - place(0.0, -STEP);
    let area = along_u.cross(along_v).length() / f64::from(4.0 * STEP * STEP);
    let shown = || format!("{pdf} for a lens of area {area} at {u}, {v}");
    if along_u.length() + along_v.length() == 0.0 {
        return hold("a pinhole has density 1", pdf == 1.0, shown);
    }
    // Maps of the square to a lens have seams, where differences mean nothing.
    let on_seam = [u - 0.5, v - 0.5, (u - 0.5).abs() - (v - 0.5).abs()].iter().any(|x| x.abs() < 4.0 * STEP);
    hold(
        "pdf_ray is the density of rays by area of the lens",
        on_seam || near(f64::from(pdf) * area, 1.0, TOLERANCE),
        shown,
    )
}

/// (2) and (5)
fn connection(sensor: &impl Sensor, sampled: SensorRay, raster: [f32; 2], u_lens: [f32; 2], distance: f32) -> Law {
    let SensorRay { ray, weight } = sampled;
    let resolution = sensor.resolution().map(|n| n as f32);
    let found = sensor.connect(Ray::at(&ray, distance), u_lens);
    let shown = || format!("{found:?} at {raster:?}, lens {u_lens:?}, distance {distance}");
    let Some(found) = &found else { return hold("a point on a ray is seen", false, shown) };
    let same = |axis: usize| (found.raster[axis] - raster[axis]).abs() <= RASTER * resolution[axis];
    hold("a point on a ray is seen where the ray started", same(0) && same(1), shown)?;
    let opposite = found.wi.distance(-ray.direction) <= 1e-3;
    hold("the direction to the lens is that of the ray, reversed", opposite, shown)?;
    let apart = (found.distance - distance).abs() + found.lens.position.distance(ray.origin);
    hold("the lens is where the ray started", apart <= 1e-3 * distance, shown)?;
    hold("the lens looks towards what it sees", found.lens.normal.dot(ray.direction) > 0.0, shown)?;
    let angle = sensor.pdf_ray(ray.origin, ray.direction).1;
    let expected = weight * angle * resolution[0] * resolution[1] / (distance * distance);
    let shown = || format!("{expected} for {}", shown());
    hold(
        "the weight of a connection is that of the ray over density and distance squared",
        near(found.weight.into(), expected.into(), TOLERANCE),
        shown,
    )?;
    // What is behind may be seen by a panorama, but then truly.
    if let Some(behind) = sensor.connect(ray.origin - ray.direction * distance, u_lens) {
        let back = sensor.sample_ray(behind.raster, u_lens).ray.direction;
        let shown = || format!("{behind:?} behind {raster:?}, where rays go along {back}");
        return hold("what is seen is where rays go", back.distance(-ray.direction) <= 1e-2, shown);
    }
    Ok(())
}
