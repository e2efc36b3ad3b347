//! Metrics against closed forms.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use lichtwerk::metrics::{ImagePair, MetricError, diff, flip_hdr, flip_ldr, mean_ratio, mrse, mse, relative_mse};
use scene_core::film::LayeredImage;

fn pair(size: [u32; 2], test: impl Fn(usize) -> [f32; 3], reference: impl Fn(usize) -> [f32; 3]) -> ImagePair {
    let count = size[0] as usize * size[1] as usize;
    ImagePair::new(size, (0..count).map(test).collect(), (0..count).map(reference).collect()).unwrap()
}

fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-6 * expected.abs(), "found {found}, expected {expected}");
}

#[test]
fn equal_images_do_not_differ() {
    let image = |i: usize| [i as f32, 0.5, 1.0 / (i + 1) as f32];
    let pair = pair([13, 7], image, image);
    assert_eq!([mse(&pair), relative_mse(&pair), mrse(&pair), flip_ldr(&pair), flip_hdr(&pair)], [0.0; 5]);
    assert_eq!(mean_ratio(&pair), [Some(1.0); 3]);
}

#[test]
fn a_constant_difference_has_a_closed_form() {
    let pair = pair([4, 4], |_| [1.5, 0.5, 0.25], |_| [1.0, 0.5, 0.0]);
    assert_close(mse(&pair), (0.25 + 0.0625) / 3.0);
    assert_close(relative_mse(&pair), (0.25 / 1.01 + 0.0625 / 0.01) / 3.0);
    let luminance: f64 = 0.2126 + 0.7152 * 0.5;
    assert_close(mrse(&pair), (0.25 + 0.0625) / 3.0 / (luminance * luminance + 0.01));
    assert_eq!(mean_ratio(&pair), [Some(1.5), Some(1.0), None]);
}

#[test]
fn only_the_trimmed_metric_ignores_a_firefly() {
    let firefly = |i: usize| if i == 1234 { [1e4; 3] } else { [1.1; 3] };
    let pair = pair([100, 100], firefly, |_| [1.0; 3]);
    assert_close(mrse(&pair), f64::from(1.1f32 - 1.0).powi(2) / 1.01);
    assert!(relative_mse(&pair) > 1e3);
}

#[test]
fn flip_grows_with_the_difference_and_stays_below_one() {
    let reference = |i: usize| [0.2 + 0.3 * ((i % 8) as f32 / 8.0); 3];
    let flip = |offset: f32| {
        let pair = pair([32, 32], |i| reference(i).map(|value| value + offset), reference);
        (flip_ldr(&pair), flip_hdr(&pair))
    };
    let (small, large) = (flip(0.02), flip(0.4));
    assert!(0.0 < small.0 && small.0 < large.0 && large.0 <= 1.0, "{small:?}, {large:?}");
    assert!(0.0 < small.1 && small.1 < large.1 && large.1 <= 1.0, "{small:?}, {large:?}");
    // Black against white is the largest difference there is.
    let extreme = pair([16, 16], |_| [0.0; 3], |_| [1.0; 3]);
    assert!(flip_ldr(&extreme) > 0.9, "{}", flip_ldr(&extreme));
}

#[test]
fn only_hdr_flip_sees_what_is_brighter_than_white() {
    let reference = |i: usize| if i.is_multiple_of(2) { [0.5; 3] } else { [8.0; 3] };
    let pair = pair([16, 16], |i| if i.is_multiple_of(2) { [0.5; 3] } else { [2.0; 3] }, reference);
    assert_eq!(flip_ldr(&pair), 0.0);
    assert!(flip_hdr(&pair) > 0.05, "{}", flip_hdr(&pair));
}

#[test]
fn tiny_and_black_images_are_fine() {
    for size in [[1, 1], [1, 5], [3, 1]] {
        let black = pair(size, |_| [0.0; 3], |_| [0.0; 3]);
        assert_eq!([mse(&black), flip_ldr(&black), flip_hdr(&black)], [0.0; 3]);
        assert_eq!(mean_ratio(&black), [None; 3]);
        assert!(flip_hdr(&pair(size, |_| [1.0; 3], |_| [0.0; 3])) > 0.0);
    }
}

#[test]
fn pixels_that_are_not_finite_are_left_out_and_counted() {
    let test = |i: usize| if i == 3 { [0.0, f32::NAN, 0.0] } else { [2.0; 3] };
    let reference = |i: usize| if i == 5 || i == 6 { [f32::INFINITY; 3] } else { [1.0; 3] };
    let pair = pair([4, 4], test, reference);
    assert_eq!(pair.non_finite(), [1, 2]);
    assert_eq!((mse(&pair), mean_ratio(&pair)), (1.0, [Some(2.0); 3]));
    assert!(flip_hdr(&pair).is_finite());
    let nothing = ImagePair::new([1, 1], vec![[f32::NAN; 3]], vec![[1.0; 3]]);
    assert!(matches!(nothing, Err(MetricError::NothingFinite)));
    assert!(matches!(ImagePair::new([0, 0], vec![], vec![]), Err(MetricError::NothingFinite)));
}

#[test]
fn diff_reads_files_and_prints_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, width: u32, value: f32| {
        let mut image = LayeredImage::new(width, 8).unwrap();
        image.set_rgb(&[[value; 3]; 4]).unwrap_err();
        let mut pixels = vec![[value; 3]; width as usize * 8];
        pixels[0] = [value, f32::NAN, value];
        image.set_rgb(&pixels).unwrap();
        let path = folder.path().join(name);
        image.write_exr(&path).unwrap();
        path
    };
    let (a, b, wide) = (write("a.exr", 8, 0.5), write("b.exr", 8, 0.25), write("wide.exr", 9, 0.5));

    let report = diff(&a, &b).unwrap();
    assert_close(report.mse, 0.0625);
    assert_eq!((report.mean_ratio, report.non_finite_test, report.non_finite_reference), ([Some(2.0); 3], 1, 1));
    let table = report.to_string();
    for expected in ["a.exr", "b.exr", "relative MSE", "MRSE", "FLIP (HDR)", "2.000000", "not finite: 1 pixels"] {
        assert!(table.contains(expected), "no '{expected}' in\n{table}");
    }
    let json = serde_json::to_string(&report).unwrap();
    assert_eq!(serde_json::from_str::<lichtwerk::metrics::DiffReport>(&json).unwrap(), report);

    let error = diff(&a, &wide).unwrap_err();
    assert!(error.to_string().contains("8x8 and 9x8"), "{error}");
    assert!(diff(&a, Path::new("missing.exr")).unwrap_err().to_string().contains("missing.exr"));
    let truncated = folder.path().join("truncated.exr");
    std::fs::write(&truncated, &std::fs::read(&a).unwrap()[..300]).unwrap();
    assert!(diff(&truncated, &a).unwrap_err().to_string().contains("truncated.exr"));
}
