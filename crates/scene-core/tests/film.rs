//! The film against closed forms, and its independence of how the work is split.

use scene_core::film::{
    Attribute, Film, FilmError, Filter, LayeredImage, LayeredImageError, MAX_PIXELS, SAMPLES_PER_PIXEL, SplatBuffer,
};

/// A fixed sequence of numbers in `[0, 1)`.
fn numbers(seed: u32) -> impl Iterator<Item = f32> {
    let mut state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        ((word >> 22) ^ word) as f32 / 4_294_967_296.0
    })
    .map(|u| u.min(1.0 - f32::EPSILON))
}

#[test]
fn mean_and_variance_match_their_definitions() {
    let mut film = Film::new(1, 1).unwrap();
    let samples: Vec<f32> = numbers(1).take(1000).map(|u| 1e3 + u).collect();
    samples.iter().for_each(|&x| film.pixel_mut(0, 0).add([x, 2.0 * x, 7.0]));

    let mean = samples.iter().map(|&x| f64::from(x)).sum::<f64>() / 1000.0;
    let squares = samples.iter().map(|&x| (f64::from(x) - mean).powi(2)).sum::<f64>();
    let variance = squares / 999.0 / 1000.0;
    let pixel = film.pixel(0, 0);
    assert!((pixel.mean()[0] - mean).abs() < 1e-9);
    let estimated = pixel.variance_of_mean().unwrap();
    assert!((estimated[0] / variance - 1.0).abs() < 1e-6, "{estimated:?}, {variance}");
    assert!((estimated[1] / (4.0 * variance) - 1.0).abs() < 1e-6);
    assert!(estimated[2] < 1e-12);
}

#[test]
fn samples_that_are_not_finite_count_as_black_and_are_reported() {
    let mut film = Film::new(2, 1).unwrap();
    let pixel = film.pixel_mut(0, 0);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        pixel.add([1.0, bad, 1.0]);
        pixel.add_aov([0.5; 3], [0.0, bad, 0.0], 1.0);
    }
    pixel.add([4.0, 8.0, -12.0]);
    pixel.add_aov([0.5; 3], [0.0, 0.0, 1.0], 3.0);
    assert_eq!(pixel.mean(), [1.0, 2.0, -3.0]);
    assert_eq!((pixel.albedo(), pixel.normal(), pixel.depth()), ([0.5; 3], [0.0, 0.0, 1.0], 3.0));

    let mut splats = SplatBuffer::new(2, 1, Filter::BOX);
    splats.add([f32::NAN, 0.5], [1.0; 3]);
    splats.add([0.5, 0.5], [1.0, f32::INFINITY, 1.0]);
    film.add_splats(&splats).unwrap();
    assert_eq!((film.samples(), film.rejected_samples()), (4, 8));
    let image = film.develop(1);
    assert!(image.rgb().unwrap().iter().flatten().all(|value| value.is_finite()));
}

#[test]
fn impossible_sizes_are_errors() {
    for (width, height) in [(0, 0), (0, 5), (5, 0)] {
        assert_eq!(Film::new(width, height).unwrap_err(), FilmError::Empty { width, height });
        assert!(LayeredImage::new(width, height).is_err());
    }
    for (width, height) in [(u32::MAX, u32::MAX), (1 << 16, 1 << 16), (MAX_PIXELS as u32 + 1, 1)] {
        assert_eq!(Film::new(width, height).unwrap_err(), FilmError::TooLarge { width, height });
    }
    assert!(Film::new(0, 7).unwrap_err().to_string().contains("0x7"));
}

#[test]
fn tiles_cover_the_film_exactly_once() {
    for (width, height, size) in [(7, 5, 3), (8, 8, 4), (1, 9, 16), (9, 1, 1), (5, 5, 0), (3, 3, u32::MAX)] {
        let mut film = Film::new(width, height).unwrap();
        for mut tile in film.tiles_mut(size) {
            let (left, top, right, bottom) = (tile.x(), tile.y(), tile.x() + tile.width(), tile.y() + tile.height());
            let mut count = 0;
            for ([x, y], pixel) in tile.pixels_mut() {
                assert!((left..right).contains(&x) && (top..bottom).contains(&y));
                pixel.add([x as f32, y as f32, 0.0]);
                count += 1;
            }
            assert_eq!(count, (right - left) * (bottom - top));
        }
        for y in 0..height {
            for x in 0..width {
                assert_eq!(film.pixel(x, y).samples(), 1);
                assert_eq!(film.pixel(x, y).mean(), [f64::from(x), f64::from(y), 0.0]);
            }
        }
    }
}

#[test]
fn the_result_does_not_depend_on_threads_or_tiles() {
    let sample = |x: u32, y: u32| numbers(y * 64 + x).take(30).collect::<Vec<_>>();
    let mut serial = Film::new(33, 17).unwrap();
    for (row, y) in serial.rows_mut().zip(0..) {
        for (pixel, x) in row.iter_mut().zip(0..) {
            sample(x, y).iter().for_each(|&u| pixel.add([u, 1.0 / (u + 0.1), u * u]));
        }
    }
    let mut parallel = Film::new(33, 17).unwrap();
    std::thread::scope(|scope| {
        for mut tile in parallel.tiles_mut(8) {
            scope.spawn(move || {
                for ([x, y], pixel) in tile.pixels_mut() {
                    sample(x, y).iter().for_each(|&u| pixel.add([u, 1.0 / (u + 0.1), u * u]));
                }
            });
        }
    });
    assert_eq!(serial, parallel);
}

#[test]
fn splats_have_the_weight_of_the_filter() {
    // Sum over a fine grid of splats of unit density: every inner pixel receives the filter's integral, one.
    for filter in [Filter::BOX, Filter::tent(1.0).unwrap(), Filter::tent(1.75).unwrap(), Filter::gaussian(0.5).unwrap()]
    {
        let (size, per_pixel) = (12u32, 20u32);
        let mut splats = SplatBuffer::new(size, size, filter);
        for i in 0..size * per_pixel {
            for j in 0..size * per_pixel {
                let raster = [i, j].map(|k| (k as f32 + 0.5) / per_pixel as f32);
                splats.add(raster, [1.0, 2.0, 0.0]);
            }
        }
        let mut film = Film::new(size, size).unwrap();
        film.add_splats(&splats).unwrap();
        let image = film.develop(u64::from(per_pixel * per_pixel));
        let margin = filter.radius().ceil() as u32;
        for y in margin..size - margin {
            for x in margin..size - margin {
                let [r, g, b] = image.rgb().unwrap()[(y * size + x) as usize];
                assert!((r - 1.0).abs() < 2e-3 && (g - 2.0 * r).abs() < 1e-6 && b == 0.0, "{filter:?} {x} {y}: {r}");
            }
        }
    }
}

#[test]
fn camera_samples_and_splats_see_the_same_pixel() {
    // The same picture L(x) = x^2 once through filter importance sampling, once through splats.
    let radiance = |x: f32| x * x;
    for filter in [Filter::BOX, Filter::tent(1.25).unwrap(), Filter::gaussian(0.6).unwrap()] {
        let steps = 4000;
        let strata = |i: u32| (i as f32 + 0.5) / steps as f32;
        let camera: f32 =
            (0..steps).map(|i| radiance(4.5 + filter.sample([strata(i), 0.5])[0])).sum::<f32>() / steps as f32;
        let mut splats = SplatBuffer::new(9, 9, filter);
        for i in 0..steps {
            for j in 0..9 * 8 {
                splats.add([9.0 * strata(i), (j as f32 + 0.5) / 8.0], [radiance(9.0 * strata(i)); 3]);
            }
        }
        let mut film = Film::new(9, 9).unwrap();
        film.add_splats(&splats).unwrap();
        // Each splat stands for 9/steps times 1/8 square pixels.
        let light = film.develop(1).channel("R").unwrap()[4 * 9 + 4] * 9.0 / steps as f32 / 8.0;
        assert!((camera / light - 1.0).abs() < 5e-3, "{filter:?}: {camera} and {light}");
    }
}

#[test]
fn splats_outside_of_the_film_are_harmless() {
    let mut splats = SplatBuffer::new(3, 2, Filter::gaussian(1.0).unwrap());
    for raster in [[-100.0, 1.0], [1e30, 1.0], [1.0, -1e30], [3.0, 2.0], [0.0, 0.0], [-0.0, 2.0]] {
        splats.add(raster, [1.0; 3]);
    }
    let mut exact = SplatBuffer::new(3, 2, Filter::BOX);
    for raster in [[3.0, 0.5], [0.5, 2.0], [-1e-9, 0.5], [f32::MAX, 0.5]] {
        exact.add(raster, [1.0; 3]);
    }
    let mut film = Film::new(3, 2).unwrap();
    film.add_splats(&exact).unwrap();
    assert_eq!(film, Film::new(3, 2).unwrap());
    film.add_splats(&splats).unwrap();
    assert!(film.develop(4).channel("Splat.R").is_some());
    assert!(film.develop(0).channel("Splat.R").is_none(), "without light paths there is nothing to divide by");
    assert!(film.add_splats(&SplatBuffer::new(2, 3, Filter::BOX)).is_err());
}

#[test]
fn unknown_variance_is_infinite() {
    let mut film = Film::new(3, 1).unwrap();
    film.pixel_mut(1, 0).add([1.0; 3]);
    film.pixel_mut(2, 0).add([1.0; 3]);
    film.pixel_mut(2, 0).add([3.0; 3]);
    assert_eq!(film.develop(0).channel("Variance.G").unwrap(), [f32::INFINITY, f32::INFINITY, 1.0]);

    let mut splats = SplatBuffer::new(3, 1, Filter::BOX);
    splats.add([0.5, 0.5], [4.0; 3]);
    film.add_splats(&splats).unwrap();
    // Two paths of values 4 and 0: mean 2, variance of the mean 4.
    assert_eq!(film.develop(2).channel("Variance.G").unwrap(), [4.0, f32::INFINITY, 1.0]);
    assert_eq!(film.develop(2).channel("G").unwrap(), [2.0, 1.0, 2.0]);
    assert_eq!(film.develop(2).channel("Camera.G").unwrap(), [0.0, 1.0, 2.0]);
}

#[test]
fn merged_films_equal_one_film() {
    let (mut whole, mut parts) = (Film::new(2, 2).unwrap(), [Film::new(2, 2).unwrap(), Film::new(2, 2).unwrap()]);
    for (i, u) in numbers(7).take(60).enumerate() {
        // Multiples of 1/1024 add without rounding, so that the order of the sums does not matter.
        let rgb = [(u * 1024.0).floor() / 1024.0; 3];
        let (x, y) = (i as u32 % 2, (i as u32 / 2) % 2);
        for film in [&mut whole, &mut parts[usize::from(i > 40)]] {
            film.pixel_mut(x, y).add(rgb);
            film.pixel_mut(x, y).add_aov(rgb, rgb, rgb[0]);
            let mut splats = SplatBuffer::new(2, 2, Filter::BOX);
            splats.add([x as f32 + 0.5, y as f32 + 0.5], rgb);
            film.add_splats(&splats).unwrap();
        }
    }
    let [mut first, second] = parts;
    first.merge(&second).unwrap();
    assert_eq!(first, whole);
    assert!(first.merge(&Film::new(2, 3).unwrap()).is_err());
}

#[test]
fn merged_images_weigh_by_their_sample_counts() {
    let image = |value: f32, variance: f32, samples: u32| {
        let mut image = LayeredImage::new(1, 1).unwrap();
        image.set_rgb(&[[value; 3]]).unwrap();
        image.set_channel("Variance.R", vec![variance]).unwrap();
        image.set_attribute(SAMPLES_PER_PIXEL, samples).unwrap();
        image.set_attribute("scene", "box").unwrap();
        image.set_attribute("seed", samples).unwrap();
        image
    };
    let merged = LayeredImage::merge(&[image(1.0, 0.1, 30), image(5.0, 0.3, 10)]).unwrap();
    assert_eq!(merged.channel("G").unwrap(), [2.0]);
    let variance = 0.1 * 0.75f64.powi(2) + 0.3 * 0.25f64.powi(2);
    assert!((f64::from(merged.channel("Variance.R").unwrap()[0]) - variance).abs() < 1e-8);
    assert_eq!(merged.attribute(SAMPLES_PER_PIXEL), Some(&Attribute::Number(40.0)));
    assert_eq!(merged.attribute("scene"), Some(&Attribute::Text("box".to_owned())));
    assert_eq!(merged.attribute("seed"), None);

    let mut uncounted = image(1.0, 1.0, 1);
    uncounted.set_attribute(SAMPLES_PER_PIXEL, "many").unwrap();
    assert_eq!(LayeredImage::merge(&[image(1.0, 1.0, 1), uncounted]).unwrap_err(), LayeredImageError::NoSampleCount(1));
    let mut deeper = image(1.0, 1.0, 1);
    deeper.set_channel("Z", vec![1.0]).unwrap();
    for pair in [[deeper.clone(), image(1.0, 1.0, 1)], [image(1.0, 1.0, 1), deeper.clone()]] {
        assert_eq!(LayeredImage::merge(&pair).unwrap_err(), LayeredImageError::ChannelMismatch("Z".to_owned()));
    }
    assert_eq!(LayeredImage::merge(&[]).unwrap_err(), LayeredImageError::NoImages);
    let mut other_size = LayeredImage::new(1, 2).unwrap();
    other_size.set_attribute(SAMPLES_PER_PIXEL, 1u32).unwrap();
    assert!(matches!(LayeredImage::merge(&[deeper, other_size]), Err(LayeredImageError::Size(_))));
}

#[test]
fn attributes_keep_whole_numbers() {
    for number in [0, 1, 1 << 53, (1 << 53) + 1, u64::MAX] {
        assert_eq!(Attribute::from(number).as_u64(), Some(number));
    }
    assert_eq!(Attribute::from(0.5).as_u64(), None);
    assert_eq!(Attribute::from(-1.0).as_u64(), None);
    assert_eq!(Attribute::from(f64::NAN).as_u64(), None);
    assert_eq!(Attribute::from("12.5").as_f64(), Some(12.5));
    assert_eq!(Attribute::from("box").as_f64(), None);
}

#[test]
fn images_are_checked() {
    let mut image = LayeredImage::new(2, 2).unwrap();
    assert!(matches!(image.rgb(), Err(LayeredImageError::NoColour(_))));
    for name in ["", "a\0b", "\u{4e16}", &"x".repeat(256)] {
        assert!(matches!(image.set_channel(name, vec![0.0; 4]), Err(LayeredImageError::Name(_))), "{name:?}");
        assert!(image.set_attribute(name, 1.0).is_err());
    }
    assert!(matches!(image.set_channel("R", vec![0.0; 3]), Err(LayeredImageError::ChannelLength { .. })));
    for name in ["Light.B", "Light.G", "Light.R", "Z"] {
        image.set_channel(name, vec![1.5; 4]).unwrap();
    }
    assert_eq!(image.rgb().unwrap(), [[1.5; 3]; 4], "the first layer with colours");
}
