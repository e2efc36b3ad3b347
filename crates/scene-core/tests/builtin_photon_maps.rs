//! The scenes for photon maps are what they say: in the rooms each lamp reaches little beyond its own, the slit lets little light
//! through, and glass and metal focus what comes from the lamp, or from the bright wall.

use std::collections::HashMap;

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::{self, Builtin};
use scene_core::glam::Vec3A;
use scene_core::{
    Emitter, ReferenceScene, Rgb, Scene, SceneDescription, Sensor, Spectrum, SurfacePoint, TransportMode, Vertex,
};

fn build(description: SceneDescription) -> ReferenceScene {
    ReferenceScene::new(description).expect("a builtin scene")
}

/// For each of `count` points that the camera sees: where it is, and the direct light that each emitter sends from it to the
/// camera, by one sample.
fn direct_light(scene: &ReferenceScene, count: u64) -> Vec<(SurfacePoint, Vec<f32>)> {
    let [width, height] = scene.sensor().resolution();
    let seen = (0..count).filter_map(|path| {
        let mut sampler = Independent::new(5).sampler(0, path);
        let [x, y] = sampler.next_2d();
        let ray = scene.sensor().sample_ray([x * width as f32, y * height as f32], [0.0; 2]).ray;
        let vertex = scene.intersect(&ray)?;
        let point = *vertex.point();
        let light = scene.emitters().iter().map(|emitter| {
            let sample = emitter.sample_direct(point.position, sampler.next_2d())?;
            let value = vertex.eval(sample.wi, TransportMode::Radiance) * sample.radiance;
            // The shadow ray is by far the most expensive part.
            let is_visible = value != Rgb::ZERO && scene.visible(&point, &sample.at?.0);
            is_visible.then(|| value.luminance() / sample.pdf_solid_angle)
        });
        Some((point, light.map(|value| value.unwrap_or(0.0)).collect()))
    });
    seen.collect()
}

#[test]
fn rooms_are_as_many_as_stated() {
    for (name, lamps, triangles) in [
        ("rooms", 100, 25_000..40_000),
        ("rooms-1000", 1000, 100_000..120_000),
        ("rooms-10000", 10_000, 900_000..1_100_000),
    ] {
        let scene = build(Builtin::named(name).expect("a builtin scene").description());
        assert_eq!(scene.emitters().len(), lamps);
        assert!(triangles.contains(&scene.triangle_count()), "{name}: {}", scene.triangle_count());
    }
    assert_eq!(build(builtin::rooms(0, 3)).emitters().len(), 3);
}

#[test]
fn lamps_light_their_own_room_and_leak_into_the_next() {
    for (columns, rows) in [(10, 10), (40, 25)] {
        let scene = build(builtin::rooms(columns, rows));
        let points = direct_light(&scene, 1500);
        let count = scene.emitters().len();
        let own = (rows / 2 * columns + columns / 2) as usize;
        let totals: Vec<f32> = (0..count).map(|k| points.iter().map(|(_, light)| light[k]).sum()).collect();
        let all: f32 = totals.iter().sum();
        let share = totals[own] / all;
        assert!((0.7..0.995).contains(&share), "{share}");
        // Few lamps reach what the camera sees at all, the number of rooms whatever.
        let contributing = totals.iter().filter(|total| **total > 0.0).count();
        assert!((4..25).contains(&contributing), "{contributing}");
        let seen = |(_, light): &(SurfacePoint, Vec<f32>)| light.iter().filter(|value| **value > 0.0).count() as f32;
        let mean = points.iter().map(seen).sum::<f32>() / points.len() as f32;
        assert!((0.6..2.0).contains(&mean), "{mean}");
        let powers: Vec<f32> = scene.emitters().iter().map(|e| e.power().luminance()).collect();
        let [least, most] = [f32::min, f32::max].map(|f| powers.iter().copied().reduce(f).expect("lamps"));
        assert!((3.0..7.0).contains(&(most / least)), "{least} {most}");
    }
}

/// How much of the flux of the first emitter meets `is_there` first.
fn share_of_flux(scene: &ReferenceScene, count: u64, is_there: impl Fn(&SurfacePoint) -> bool) -> f32 {
    let hits = (0..count).filter(|&path| {
        let mut sampler = Independent::new(9).sampler(0, path);
        let start = scene.emitters()[0].sample_emission(sampler.next_2d(), sampler.next_2d()).expect("lambertian");
        scene.intersect(&start.point.ray_along(start.direction)).is_some_and(|vertex| is_there(vertex.point()))
    });
    hits.count() as f32 / count as f32
}

#[test]
fn the_slit_lets_little_light_through() {
    let scene = build(builtin::door_slit());
    assert_eq!(scene.emitters().len(), 1);
    assert!(scene.sensor().sample_ray([0.0; 2], [0.0; 2]).ray.origin.x < -0.1);
    let through = share_of_flux(&scene, 200_000, |point| point.position.x < -0.06);
    assert!((3e-4..8e-3).contains(&through), "{through}");
    let points = direct_light(&scene, 4000);
    let dark: Vec<_> = points.iter().filter(|(point, _)| point.position.x < -0.05).collect();
    let lit = dark.iter().filter(|(_, light)| light[0] > 0.0).count() as f32 / dark.len() as f32;
    // A sheet of light on the floor and the desk, and else only what scatters.
    assert!((3e-3..0.15).contains(&lit), "{lit} {through}");
    assert!(dark.len() as f32 > 0.8 * points.len() as f32);
}

#[test]
fn the_caustic_room_is_lit_by_its_wall() {
    let scene = build(builtin::caustic_room());
    let on_wall = |point: &SurfacePoint| point.position.x < -1.99;
    let in_box = |point: &SurfacePoint| (-1.73..-1.3).contains(&point.position.x) && point.position.y > 1.3;
    let wall = share_of_flux(&scene, 20_000, on_wall);
    assert!((0.05..0.5).contains(&wall), "{wall}");
    assert_eq!(share_of_flux(&scene, 20_000, |point| !on_wall(point) && !in_box(point)), 0.0);
    // Nothing else that the camera sees has direct light.
    let points = direct_light(&scene, 4000);
    assert!(points.iter().all(|(point, light)| light[0] == 0.0 || on_wall(point) || in_box(point)));
    let table = |p: Vec3A| (p.y - 0.72).abs() < 2e-3 && (p.x + 0.3).abs() < 0.74 && p.z.abs() < 0.61;
    let caustic = caustic_photons(&scene, 400_000, 2).into_iter().filter(|photon| table(photon.position));
    assert!(caustic_photons(&scene, 20_000, 0).is_empty(), "directly from the lamp");
    let count = caustic.count();
    assert!((100..20_000).contains(&count), "{count}");
}

/// A photon on a diffuse surface after specular scattering.
struct CausticPhoton {
    position: Vec3A,
    flux: f32,
    /// Whether it went through glass.
    through_glass: bool,
}

/// Photons of `count` light paths from the first emitter that end on a diffuse surface after one or more specular
/// bounces, which follow `diffuse` diffuse bounces at most.
fn caustic_photons(scene: &ReferenceScene, count: u64, diffuse: u32) -> Vec<CausticPhoton> {
    let mut photons = Vec::new();
    for path in 0..count {
        let mut sampler = Independent::new(17).sampler(0, path);
        let start = scene.emitters()[0].sample_emission(sampler.next_2d(), sampler.next_2d()).expect("lambertian");
        let (mut ray, mut flux) = (start.point.ray_along(start.direction), start.flux.luminance() / count as f32);
        let (mut is_caustic, mut through_glass, mut bounces) = (false, false, 0);
        for _ in 0..12 {
            let Some(vertex) = scene.intersect(&ray) else { break };
            let lobe = sampler.next_1d();
            let [u, v] = sampler.next_2d();
            let Some(sample) = vertex.sample([lobe, u, v], TransportMode::Importance) else { break };
            if !sample.is_specular {
                if is_caustic {
                    photons.push(CausticPhoton { position: vertex.point().position, flux, through_glass });
                }
                bounces += 1;
                if bounces > diffuse {
                    break;
                }
            }
            is_caustic = sample.is_specular;
            through_glass |=
                is_caustic && vertex.point().normal.dot(sample.wi) * vertex.point().normal.dot(ray.direction) > 0.0;
            flux *= sample.throughput.luminance();
            ray = vertex.spawn_ray(sample.wi);
        }
    }
    photons
}

#[test]
fn ball_and_ring_focus_light_on_the_floor() {
    let scene = build(builtin::glass_ball());
    let power = scene.emitters()[0].power().luminance();
    let photons = caustic_photons(&scene, 2_000_000, 0);
    let on_floor = |photon: &&CausticPhoton| photon.position.y.abs() < 1e-3;
    // Irradiance of squares with sides of 2 cm.
    let side = 0.02;
    let peak = |photons: &mut dyn Iterator<Item = &CausticPhoton>| {
        let mut squares: HashMap<[i32; 2], f32> = HashMap::new();
        for photon in photons {
            let square = [photon.position.x, photon.position.z].map(|x| (x / side).floor() as i32);
            *squares.entry(square).or_insert(0.0) += photon.flux / (side * side);
        }
        squares.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("photons")
    };
    // Without glass and ring, in the middle: intensity power / pi on the axis, cosine and distance.
    let distance = Vec3A::new(1.75, 1.55, 0.35).length();
    let direct = power / std::f32::consts::PI * (1.55 / distance) / (distance * distance);
    let (square, glass) = peak(&mut photons.iter().filter(on_floor).filter(|p| p.through_glass));
    assert!(glass > 5.0 * direct && square[0] < -20, "{square:?}: {glass} beside {direct}");
    // Within the ring.
    let in_ring = |p: &&CausticPhoton| (p.position - Vec3A::new(0.40, 0.0, 0.16)).length() < 0.3;
    let (_, ring) = peak(&mut photons.iter().filter(on_floor).filter(in_ring).filter(|p| !p.through_glass));
    assert!(ring > 0.8 * direct && ring < glass, "{ring} beside {direct}");
    let within = photons.iter().filter(on_floor).count();
    assert!(within > 5000, "{within}");
}
