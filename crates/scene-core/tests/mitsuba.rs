//! The importer: what each plugin and parameter becomes. The numbers are those of Mitsuba 3.9.1.
#![cfg(feature = "mitsuba")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod mitsuba_support;

use mitsuba_support::{folder, import, load};
use scene_core::Rgb;
use scene_core::film::Filter;
use scene_core::glam::{Affine3A, Vec3A};
use scene_core::material::{Distribution, Material};
use scene_core::mitsuba;
use scene_core::reference::{Light, SceneDescription, Shape};
use scene_core::texture::{Interpolation, Texture, Wrap};

const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.75\nf 1/1 2/1 3/1\n";

fn sensor(content: &str) -> SceneDescription {
    let text = format!("<scene version=\"3.0.0\"><sensor type=\"perspective\">{content}</sensor></scene>");
    mitsuba::load_str(&text, ".".as_ref(), &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn material(content: &str) -> Material {
    load(&format!("<shape type=\"rectangle\">{content}</shape>")).materials.remove(0)
}

fn constant(texture: &Texture) -> [f32; 3] {
    texture.constant().unwrap().to_array()
}

fn light(content: &str) -> Light {
    load(content).lights.remove(0)
}

fn close(a: Vec3A, b: [f32; 3]) {
    assert!((a - Vec3A::from(b)).length() < 1e-5, "{a} is not {b:?}");
}

fn fov_x(content: &str) -> f32 {
    sensor(content).camera.fov_x.to_degrees()
}

#[test]
fn cameras() {
    let scene = sensor("");
    assert_eq!((scene.camera.width, scene.camera.height, scene.camera.aperture_radius), (768, 576, 0.0));
    assert_eq!(scene.filter, Filter::GAUSSIAN);
    let film = r#"<film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/></film>"#;
    for (content, expected) in [
        (String::new(), 38.1848),
        (r#"<string name="focal_length" value="35mm"/>"#.into(), 52.6225),
        (r#"<string name="focal_length" value="35"/>"#.into(), 52.6225),
        (format!(r#"<float name="fov" value="60"/>{film}"#), 60.0),
        (format!(r#"<float name="fov" value="60"/><string name="fov_axis" value="larger"/>{film}"#), 60.0),
        (format!(r#"<float name="fov" value="60"/><string name="fov_axis" value="y"/>{film}"#), 98.2132),
        (format!(r#"<float name="fov" value="60"/><string name="fov_axis" value="smaller"/>{film}"#), 98.2132),
        (format!(r#"<integer name="fov" value="60"/><string name="fov_axis" value="diagonal"/>{film}"#), 54.62),
    ] {
        assert!((fov_x(&content) - expected).abs() < 1e-2, "{content}: {}", fov_x(&content));
    }
    let text = r#"<scene version="3.0.0"><sensor type="thinlens"><float name="aperture_radius" value="0.1"/>
        <float name="focus_distance" value="3"/></sensor></scene>"#;
    let camera = mitsuba::load_str(text, ".".as_ref(), &[]).unwrap().camera;
    assert_eq!((camera.aperture_radius, camera.focus_distance), (0.1, 3.0));
}

#[test]
fn films_filters_samplers_and_integrators() {
    for (rfilter, expected) in [
        (r#"<rfilter type="box"/>"#, Filter::BOX),
        (r#"<rfilter type="tent"/>"#, Filter::TENT),
        (r#"<rfilter type="gaussian"><float name="stddev" value="0.8"/></rfilter>"#, Filter::gaussian(0.8).unwrap()),
    ] {
        assert_eq!(sensor(&format!("<film type=\"hdrfilm\">{rfilter}</film>")).filter, expected);
    }
    let scene = sensor(r#"<sampler type="multijitter"><integer name="sample_count" value="17"/></sampler>"#);
    assert_eq!((scene.samples_per_pixel, scene.max_depth), (Some(17), None));
    for (depth, expected) in [("-1", None), ("7", Some(7))] {
        let integrator = format!(r#"<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>"#);
        assert_eq!(load(&integrator).max_depth, expected);
    }
    let private =
        r#"<integrator type="mine"><integer name="max_depth" value="7"/><float name="x" value="1"/></integrator>"#;
    let scene = import(private, &[]).unwrap();
    assert_eq!(scene.max_depth, Some(7));
    assert!(
        scene.warnings[0].ends_with(":3: of the integrator `mine` only `max_depth` is taken"),
        "{:?}",
        scene.warnings
    );
    assert_eq!(scene.warnings.len(), 1);
    let nested = r#"<integrator type="aov"><integrator type="path"><integer name="max_depth" value="4"/></integrator></integrator>"#;
    assert_eq!(import(nested, &[]).unwrap().max_depth, Some(4));
}

#[test]
fn transforms_multiply_from_the_left() {
    let to_world = |steps: &str| {
        let shape = format!(r#"<shape type="rectangle"><transform name="to_world">{steps}</transform></shape>"#);
        load(&shape).instances[0].to_world
    };
    let at = |transform: &Affine3A, p: [f32; 3]| transform.transform_point3a(p.into());
    let m = to_world(r#"<rotate y="1" angle="90"/><translate x="5" z="2"/>"#);
    close(at(&m, [0.0, 0.0, 1.0]), [6.0, 0.0, 2.0]);
    let m = to_world(r#"<translate value="1 2 3"/><scale value="2"/><scale x="-1"/>"#);
    close(at(&m, [1.0, 0.0, 0.0]), [-4.0, 4.0, 6.0]);
    let m = to_world(r#"<matrix value="1 2 3 4, 0 1 0 5 0 0 1 6 0 0 0 1"/>"#);
    close(at(&m, [1.0, 1.0, 1.0]), [10.0, 6.0, 7.0]);
    let m = to_world(r#"<matrix value="1 2 3 0 1 0 0 0 1"/>"#);
    close(at(&m, [0.0, 1.0, 0.0]), [2.0, 1.0, 0.0]);
    let m = to_world(r#"<lookat origin="1,2,3" target="0,0,0" up="0,1,0"/>"#);
    close(m.matrix3.x_axis, [-0.948_683, 0.0, 0.316_228]);
    close(m.matrix3.y_axis, [-0.169_031, 0.845_154, -0.507_093]);
    close(m.matrix3.z_axis, [-0.267_261, -0.534_522, -0.801_784]);
    close(m.translation, [1.0, 2.0, 3.0]);
    let m = to_world(r#"<lookat origin="1,2,3" target="0,0,0"/>"#);
    close(m.matrix3.x_axis, [-0.079_286_5, 0.841_427, -0.534_522]);
}

#[test]
fn shapes() {
    let scene = load(
        r#"<shape type="rectangle"/><shape type="rectangle"/><shape type="rectangle"><boolean name="flip_normals" value="true"/></shape>
        <shape type="cube"/><shape type="disk"/>
        <shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="0.5"/></shape>"#,
    );
    let counts: Vec<_> = scene
        .shapes
        .iter()
        .map(|shape| match shape {
            Shape::Mesh(mesh) => mesh.len(),
            Shape::Sphere { center, radius, flip_normals } => {
                assert_eq!((center.to_array(), *radius, *flip_normals), ([1.0, 2.0, 3.0], 0.5, false));
                1
            }
            Shape::Disk => 0,
        })
        .collect();
    assert_eq!(counts, [2, 2, 12, 0, 1], "equal rectangles share their mesh");
    assert_eq!(scene.instances.len(), 6);
    assert_eq!(scene.materials.len(), 1, "and the default material");
    assert!(matches!(&scene.materials[0], Material::Diffuse { reflectance } if constant(reflectance) == [0.5; 3]));

    let flipped = load(r#"<shape type="disk"><boolean name="flip_normals" value="true"/></shape>"#);
    close(flipped.instances[0].to_world.transform_vector3a(Vec3A::Z), [0.0, 0.0, -1.0]);
    for (content, expected) in [
        (r#"<transform name="to_world"><scale x="-1"/></transform>"#, true),
        (r#"<float name="radius" value="-1"/>"#, true),
        (r#"<float name="radius" value="-1"/><boolean name="flip_normals" value="true"/>"#, false),
    ] {
        let scene = load(&format!("<shape type=\"sphere\">{content}</shape>"));
        assert!(matches!(scene.shapes[0], Shape::Sphere { flip_normals, .. } if flip_normals == expected), "{content}");
    }
}

#[test]
fn mesh_files() {
    let one = |extra: &str| {
        let shape = format!(r#"<shape type="obj"><string name="filename" value="a.obj"/>{extra}</shape>"#);
        let mut scene = import(&(shape.clone() + &shape), &[("a.obj", TRIANGLE)]).unwrap();
        assert_eq!((scene.shapes.len(), scene.instances.len()), (1, 2), "read once");
        let Shape::Mesh(mesh) = scene.shapes.remove(0) else { panic!("a mesh") };
        mesh
    };
    let mesh = one("");
    assert_eq!(mesh.uvs()[0], [0.25, 0.25], "v is flipped");
    assert_eq!(mesh.normals()[0], [0.0, 0.0, 1.0], "missing normals are computed");
    assert_eq!(one(r#"<boolean name="flip_tex_coords" value="false"/>"#).uvs()[0], [0.25, 0.75]);
    assert!(one(r#"<boolean name="face_normals" value="true"/>"#).normals().is_empty());
    assert_eq!(one(r#"<boolean name="flip_normals" value="true"/>"#).normals()[0], [0.0, 0.0, -1.0]);
}

#[test]
fn groups_are_converted_once_and_placed_often() {
    let scene = load(
        r#"<shape type="shapegroup" id="group">
            <shape type="cube"><transform name="to_world"><translate x="1"/></transform></shape>
            <shape type="sphere"><bsdf type="dielectric"/></shape>
        </shape>
        <shape type="instance"><ref id="group"/><transform name="to_world"><scale value="2"/></transform></shape>
        <shape type="instance"><ref id="group"/></shape>"#,
    );
    assert_eq!((scene.shapes.len(), scene.instances.len(), scene.materials.len()), (2, 4, 2));
    assert_eq!(scene.instances[0].shape, scene.instances[2].shape);
    close(scene.instances[0].to_world.translation, [2.0, 0.0, 0.0]);
    close(scene.instances[2].to_world.translation, [1.0, 0.0, 0.0]);
}

#[test]
fn emitters() {
    let shape = r#"<shape type="sphere"><emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter></shape>"#;
    assert_eq!(load(shape).instances[0].radiance, Some(Rgb::new(1.0, 2.0, 3.0)));
    let default = r#"<shape type="sphere"><emitter type="area"/></shape>"#;
    assert_eq!(load(default).instances[0].radiance, Some(Rgb::ONE));
    let Light::Point { position, intensity } =
        light(r#"<emitter type="point"><point name="position" value="1 2 3"/></emitter>"#)
    else {
        panic!("a point light");
    };
    assert_eq!((position.to_array(), intensity), ([1.0, 2.0, 3.0], Rgb::ONE));
    let spot = r#"<emitter type="spot"><transform name="to_world"><scale value="2"/><rotate y="1" angle="90"/><translate y="3"/></transform></emitter>"#;
    let Light::Spot { position, direction, beam_width, cutoff, .. } = light(spot) else { panic!("a spot light") };
    close(position, [0.0, 3.0, 0.0]);
    close(direction, [1.0, 0.0, 0.0]);
    assert!((cutoff.to_degrees() - 20.0).abs() < 1e-4 && (beam_width.to_degrees() - 15.0).abs() < 1e-4);
    let sun = r#"<emitter type="directional"><vector name="direction" x="2"/><spectrum name="irradiance" value="2"/></emitter>"#;
    let Light::Directional { direction, irradiance } = light(sun) else { panic!("a directional light") };
    assert_eq!(direction, Vec3A::X);
    assert!((irradiance.0 - Vec3A::new(2.409_59, 1.896_58, 1.817_83)).length() < 0.02, "{irradiance:?}");
    let Light::Constant { radiance } =
        light(r#"<emitter type="constant"><float name="radiance" value="0.25"/></emitter>"#)
    else {
        panic!("a constant light");
    };
    assert_eq!(radiance, Rgb::splat(0.25));
}

/// A PNG of 2 x 1 pixels with values 0 and 188.
fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::GrayImage::from_raw(2, 1, vec![0, 188]).unwrap().write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[test]
fn environment_maps() {
    let text = r#"<emitter type="envmap"><string name="filename" value="sky.png"/><float name="scale" value="2"/>
        <transform name="to_world"><rotate y="1" angle="90"/></transform></emitter>"#;
    let mut scene = import(text, &[("sky.png", &png())]).unwrap();
    let Light::Environment { image, scale, to_world } = scene.lights.remove(0) else { panic!("an environment") };
    assert_eq!((image.width(), scale), (2, 2.0));
    close(to_world.transform_vector3a(Vec3A::Z), [1.0, 0.0, 0.0]);
}

#[test]
fn textures() {
    let texture = |content: &str| {
        let text = format!(
            r#"<shape type="cube"><bsdf type="diffuse"><texture name="reflectance" {content}</texture></bsdf></shape>"#
        );
        let mut scene = import(&text, &[("a.png", &png())]).unwrap();
        assert_eq!(scene.warnings, Vec::<String>::new());
        let Material::Diffuse { reflectance } = scene.materials.remove(0) else { panic!("diffuse") };
        reflectance
    };
    let Texture::Image(image) = texture(r#"type="bitmap"><string name="filename" value="a.png"/>"#) else {
        panic!("image")
    };
    assert_eq!((image.wrap, image.interpolation), (Wrap::Repeat, Interpolation::Bilinear));
    assert!((image.image.pixel(1, 0)[0] - 0.5029).abs() < 1e-3);
    let raw = r#"type="bitmap"><string name="filename" value="a.png"/><boolean name="raw" value="true"/>
        <string name="wrap_mode" value="mirror"/><string name="filter_type" value="nearest"/>
        <transform name="to_uv"><scale x="2" y="3"/><translate x="0.5" y="0.25" z="7"/></transform>"#;
    let Texture::Image(image) = texture(raw) else { panic!("image") };
    assert_eq!((image.wrap, image.interpolation), (Wrap::Mirror, Interpolation::Nearest));
    assert!((image.image.pixel(1, 0)[0] - 188.0 / 255.0).abs() < 1e-5);
    assert_eq!(image.uv_transform, [2.0, 0.0, 0.5, 0.0, 3.0, 0.25]);
    let Texture::Checkerboard { color0, color1, .. } =
        texture(r#"type="checkerboard"><float name="color1" value="0"/>"#)
    else {
        panic!("checkerboard");
    };
    assert_eq!((color0, color1), (Rgb::splat(0.4), Rgb::ZERO));
    assert_eq!(constant(&texture(r#"type="uniform"><float name="value" value="0.3"/>"#)), [0.3; 3]);
}

#[test]
fn colours() {
    let colour = |value: &str| match material(&format!("<bsdf type=\"diffuse\">{value}</bsdf>")) {
        Material::Diffuse { reflectance } => constant(&reflectance),
        other => panic!("{other:?}"),
    };
    assert_eq!(colour(r#"<rgb name="reflectance" value="0.1, 0.2, 0.3"/>"#), [0.1, 0.2, 0.3]);
    assert_eq!(colour(r#"<rgb name="reflectance" value="0.5"/>"#), [0.5; 3]);
    assert_eq!(colour(r#"<float name="reflectance" value="0.3"/>"#), [0.3; 3]);
    assert_eq!(colour(r#"<integer name="reflectance" value="1"/>"#), [1.0; 3]);
    assert_eq!(colour(r#"<spectrum name="reflectance" value="0.5"/>"#), [0.5; 3]);
    assert!((colour(r#"<srgb name="reflectance" value="0.5"/>"#)[0] - 0.214_041).abs() < 1e-5);
    assert!((colour(r##"<rgb name="reflectance" value="#ff8000"/>"##)[1] - 0.215_86).abs() < 1e-5);
    let srgb = r#"<spectrum name="reflectance" type="srgb"><rgb name="color" value="0.3 .2 .1"/></spectrum>"#;
    assert_eq!(colour(srgb), [0.3, 0.2, 0.1]);
    let pairs = r#"<spectrum name="reflectance" value="400:0.5, 700:0.5"/>"#;
    let scene = import(&format!("<bsdf type=\"diffuse\">{pairs}</bsdf>"), &[]).unwrap();
    assert!(scene.warnings[0].ends_with("the spectrum `reflectance` is reduced to RGB"), "{:?}", scene.warnings);
}

#[test]
fn materials() {
    let Material::RoughConductor { eta, k, distribution, alpha, .. } = material(
        r#"<bsdf type="roughconductor"><rgb name="eta" value="1 2 3"/><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.2"/>
        <string name="distribution" value="ggx"/></bsdf>"#,
    ) else {
        panic!("roughconductor");
    };
    assert_eq!((eta, k, distribution, alpha), (Rgb::new(1.0, 2.0, 3.0), Rgb::ONE, Distribution::Ggx, [0.1, 0.2]));
    let mirror = material(r#"<bsdf type="conductor"/>"#);
    assert!(matches!(mirror, Material::Conductor { eta, k, .. } if eta == Rgb::ZERO && k == Rgb::ONE));
    let Material::Conductor { eta, .. } =
        material(r#"<bsdf type="conductor"><string name="material" value="Au"/></bsdf>"#)
    else {
        panic!("conductor");
    };
    assert!((eta[2] - 1.442).abs() < 0.01, "{eta:?}");
    let Material::Dielectric { int_ior, ext_ior, .. } =
        material(r#"<bsdf type="dielectric"><string name="int_ior" value="water"/></bsdf>"#)
    else {
        panic!("dielectric");
    };
    assert_eq!((int_ior, ext_ior), (1.333, 1.000_277));
    let Material::ThinDielectric { int_ior, .. } = material(r#"<bsdf type="thindielectric"/>"#) else { panic!("thin") };
    assert_eq!(int_ior, 1.5046);
    let Material::RoughDielectric { distribution, alpha, .. } = material(r#"<bsdf type="roughdielectric"/>"#) else {
        panic!("roughdielectric");
    };
    assert_eq!((distribution, alpha), (Distribution::Beckmann, [0.1; 2]));
    let Material::Plastic { int_ior, nonlinear, .. } = material(r#"<bsdf type="plastic"/>"#) else { panic!("plastic") };
    assert_eq!((int_ior, nonlinear), (1.49, false));
    let rough =
        r#"<bsdf type="roughplastic"><boolean name="nonlinear" value="true"/><float name="alpha" value="0.3"/></bsdf>"#;
    assert!(matches!(material(rough), Material::RoughPlastic { nonlinear: true, alpha: 0.3, .. }));
    assert!(matches!(material(r#"<bsdf type="phong"/>"#), Material::Phong { exponent: 30.0, .. }));
    let Material::Mask { opacity, .. } = material(r#"<bsdf type="mask"><bsdf type="diffuse"/></bsdf>"#) else {
        panic!("mask")
    };
    assert_eq!(constant(&opacity), [0.5; 3]);
    let Material::Mask { opacity, .. } = material(r#"<bsdf type="null"/>"#) else { panic!("mask") };
    assert_eq!(constant(&opacity), [0.0; 3]);
    let two = r#"<bsdf type="twosided"><bsdf type="diffuse"/><bsdf type="plastic"/></bsdf>"#;
    assert!(matches!(material(two), Material::TwoSided { back: Some(_), .. }));
    let bump = r#"<bsdf type="bumpmap"><float name="scale" value="2"/><texture type="checkerboard"/><bsdf type="diffuse"/></bsdf>"#;
    assert!(matches!(material(bump), Material::BumpMap { scale: 2.0, .. }));
    let normal =
        r#"<bsdf type="normalmap"><texture name="normalmap" type="checkerboard"/><bsdf type="diffuse"/></bsdf>"#;
    assert!(matches!(material(normal), Material::NormalMap { .. }));
}

#[test]
fn references_and_aliases() {
    let scene = load(
        r#"<shape type="cube"><ref id="other"/></shape>
        <texture type="checkerboard" id="board"/>
        <bsdf type="diffuse" id="one"><ref name="reflectance" id="board"/></bsdf>
        <alias id="one" as="other"/>
        <shape type="cube"><ref id="one"/></shape>"#,
    );
    assert_eq!(scene.materials.len(), 1);
    assert!(matches!(&scene.materials[0], Material::Diffuse { reflectance: Texture::Checkerboard { .. } }));
}

#[test]
fn old_files_are_upgraded() {
    let text = r#"<scene version="0.5.0"><sensor type="perspective"><sampler type="independent"><integer name="sampleCount" value="3"/></sampler></sensor>
        <shape type="sphere"><transform name="toWorld"><translate x="1"/></transform>
            <bsdf type="dielectric"><float name="intIOR" value="1.8"/></bsdf></shape>
        <shape type="cube"><bsdf type="diffuse"><rgb name="diffuseReflectance" value="0.25"/></bsdf></shape>
        <shape type="cube"><bsdf type="diffuse"><texture name="reflectance" type="checkerboard"><float name="uscale" value="4"/></texture></bsdf></shape>
        </scene>"#;
    let scene = mitsuba::load_str(text, ".".as_ref(), &[]).unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    assert_eq!(scene.samples_per_pixel, Some(3));
    assert_eq!(scene.instances[0].to_world.translation.x, 1.0);
    assert!(matches!(scene.materials[0], Material::Dielectric { int_ior: 1.8, .. }));
    assert!(matches!(&scene.materials[1], Material::Diffuse { reflectance } if constant(reflectance) == [0.25; 3]));
    let Material::Diffuse { reflectance: Texture::Checkerboard { uv_transform, .. } } = &scene.materials[2] else {
        panic!("checkerboard");
    };
    assert_eq!(uv_transform[0], 4.0);
    let current = text.replace("0.5.0", "3.0.0");
    let scene = mitsuba::load_str(&current, ".".as_ref(), &[]).unwrap();
    assert!(
        scene.warnings.iter().any(|w| w.ends_with("unknown parameter `toWorld` of the shape `sphere`")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn parameters_and_includes() {
    let directory = folder(&[
        (
            "scene.xml",
            br#"<scene version="3.0.0"><default name="size" value="64"/><default name="kind" value="box"/>
            <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="$size"/><rfilter type="$kind"/></film></sensor>
            <path value="models"/><include filename="sub/more.xml"/><shape type="cube"><ref id="$name"/></shape></scene>"#,
        ),
        (
            "sub/more.xml",
            br#"<scene version="0.6.0"><default name="name" value="grey"/><include filename="most.xml"/>
            <shape type="obj"><string name="filename" value="a.obj"/><boolean name="faceNormals" value="true"/></shape></scene>"#,
        ),
        ("sub/most.xml", br#"<bsdf version="3.0.0" type="diffuse" id="$name"/>"#),
        ("models/a.obj", TRIANGLE),
    ]);
    let path = directory.path().join("scene.xml");
    let scene = mitsuba::load(&path, &[("size".into(), "32".into()), ("typo".into(), "1".into())]).unwrap();
    assert_eq!((scene.camera.width, scene.filter, scene.instances.len()), (32, Filter::BOX, 2));
    assert_eq!(scene.source.as_deref(), Some(path.as_path()));
    assert_eq!(scene.warnings.len(), 1);
    assert!(scene.warnings[0].ends_with("the scene has no parameter `$typo`"), "{:?}", scene.warnings);
}

#[test]
fn what_is_passed_over_is_said() {
    let content = r#"<shape type="cube">
        <medium type="homogeneous" name="interior"/>
        <float name="colour" value="1"/>
        </shape>
        <sensor type="perspective"/>
        <bsdf type="diffuse"><bsdf type="diffuse"/></bsdf>"#;
    let scene = import(content, &[]).unwrap();
    let messages: Vec<_> = scene.warnings.iter().map(|w| w.rsplit_once("<text>").unwrap().1).collect();
    assert_eq!(
        messages,
        [
            ":4: ignored: the interior medium `homogeneous`",
            ":5: ignored: unknown parameter `colour` of the shape `cube`",
            ":7: ignored: all sensors after the first",
            ":8: ignored: an object inside the bsdf `diffuse`",
        ]
    );
    let nan = b"v nan 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 2 3 4\n";
    let scene =
        import(r#"<shape type="obj"><string name="filename" value="a.obj"/></shape>"#, &[("a.obj", nan)]).unwrap();
    assert!(
        scene.warnings[0].contains("a.obj: dropped 1 triangles with vertices that are not finite"),
        "{:?}",
        scene.warnings
    );
    let empty =
        import(r#"<shape type="obj"><string name="filename" value="a.obj"/></shape>"#, &[("a.obj", b"# nothing\n")])
            .unwrap();
    assert_eq!((empty.instances.len(), empty.shapes.len(), empty.warnings.len()), (0, 0, 1));
    assert!(scene.source.is_none());
}
