//! Real scenes, where they have been downloaded. Skipped with a message where they have not.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;

use lichtwerk::program::{RenderSettings, estimate, load_description};
use lichtwerk::render::Budget;
use lichtwerk_tests::assets::asset;
use scene_core::ReferenceScene;
use scene_core::film::LayeredImage;

/// Renders a scene file; nothing where it is absent.
fn render(name: &str, size: [u32; 2], samples: u64, max_depth: u32) -> Option<LayeredImage> {
    let path = asset(name)?;
    let text = std::fs::read_to_string(&path).unwrap();
    // Two files name a private integrator as default.
    let parameters: &[_] =
        if text.contains("\"$integrator\"") { &[("integrator".to_owned(), "path".to_owned())] } else { &[] };
    let mut description = load_description(path.to_str().unwrap(), parameters).unwrap();
    (description.camera.width, description.camera.height) = (size[0], size[1]);
    let scene = ReferenceScene::new(description).unwrap();
    let settings = RenderSettings { max_depth, ..RenderSettings::new(Budget::Samples(samples)) };
    let rendering = estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(rendering.film.rejected_samples(), 0, "{name}: samples that are not finite");
    Some(rendering.film.develop(0))
}

/// The means of the channels over the rows from `first` on, a fraction of the height; pixels that are not finite, of which
/// the references have some, count as absent.
fn means(image: &LayeredImage, first: f64) -> [f64; 3] {
    let pixels = image.rgb().unwrap();
    let start = (first * f64::from(image.height())).round() as usize * image.width() as usize;
    let finite: Vec<_> = pixels[start..].iter().filter(|pixel| pixel.iter().all(|value| value.is_finite())).collect();
    std::array::from_fn(|c| finite.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>() / finite.len() as f64)
}

/// Four samples per pixel: at least this part of the pixels is lit.
fn renders_something(name: &str, size: [u32; 2], least_lit: f64) {
    let Some(image) = render(name, size, 4, 16) else { return };
    let pixels = image.rgb().unwrap();
    assert!(pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0), "{name}");
    let part = |count: usize| count as f64 / pixels.len() as f64;
    let lit = part(pixels.iter().filter(|pixel| pixel.iter().sum::<f32>() > 0.0).count());
    let hit = part(image.channel("Z").unwrap().iter().filter(|depth| **depth > 0.0).count());
    println!("{name}: {lit:.2} is lit, {hit:.2} is covered, means {:?}", means(&image, 0.0));
    assert!(lit > least_lit, "{name}: only {lit} of the pixels are lit");
    assert!(hit > 0.5, "{name}: the camera sees a surface in only {hit} of the pixels");
}

#[test]
fn the_scenes_render() {
    renders_something("cornell-box/scene.xml", [32, 32], 0.9);
    renders_something("veach-mis/scene.xml", [48, 27], 0.9);
    renders_something("living-room/scene_mi3.xml", [48, 27], 0.4);
    renders_something("modern-hall/scene_mi3.xml", [48, 27], 0.9);
    renders_something("many-lights/scene.scn", [48, 27], 0.9);
    // A small lamp below waves: few paths find it.
    renders_something("water-caustic/scene_mi3.xml", [32, 32], 0.2);
}

/// Compares the means with those of the renderer that the scenes were made for, over the rows from `first` on.
///
/// Its images were rendered at another size, with other filters, materials that were translated, and unknown noise:
/// this finds a wrong exposure, colour or light, and nothing subtle. Image blocks are compared with a peer under `benches`.
fn agrees_with_the_reference(name: &str, size: [u32; 2], max_depth: u32, first: f64, tolerance: f64) {
    let Some(image) = render(name, size, 64, max_depth) else { return };
    let file = asset(name).unwrap().parent().unwrap().join("TungstenRender.exr");
    let (ours, theirs) = (means(&image, first), means(&LayeredImage::read_exr(&file).unwrap(), first));
    let ratios: [f64; 3] = std::array::from_fn(|channel| ours[channel] / theirs[channel]);
    println!("{name}: ratios of the means {ratios:.4?}");
    assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < tolerance), "{name}: {ours:?} is not {theirs:?}");
}

#[test]
fn cornell_box_agrees_with_its_reference() {
    agrees_with_the_reference("cornell-box/scene.xml", [64, 64], u32::MAX, 0.0, 0.01);
}

/// Its reference shows direct light alone (with one more segment the floor is a fifth brighter). The upper part is left
/// out: there the smallest lamp and its image in the smoothest plate cover few samples and hold much of the light.
#[test]
fn veach_mis_agrees_with_its_reference() {
    agrees_with_the_reference("veach-mis/scene.xml", [80, 45], 2, 0.6, 0.03);
}

#[test]
fn living_room_agrees_with_its_reference() {
    agrees_with_the_reference("living-room/scene_mi3.xml", [64, 36], u32::MAX, 0.0, 0.03);
}

// The reference of `water-caustic` has pixels that are not finite, and many times the light: it shows the caustic of a
// small lamp, which path tracing does not find with few samples. `modern-hall` comes without a reference.
