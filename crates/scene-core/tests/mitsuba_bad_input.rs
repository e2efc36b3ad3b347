//! The importer: bad input of every kind is an error that says where, never a panic.
#![cfg(feature = "mitsuba")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod mitsuba_support;

use std::fmt::Write;

use mitsuba_support::{assets, error, folder, import, scene};
use scene_core::mitsuba::{self, ImportError};

fn load_text(text: &str) -> Result<(), ImportError> {
    mitsuba::load_str(text, ".".as_ref(), &[]).map(|_| ())
}

#[test]
fn unknown_plugins_are_named_with_file_and_line() {
    for (content, expected) in [
        (r#"<shape type="teapot"/>"#, ":3: unknown shape plugin `teapot`"),
        ("\n<bsdf type=\"cloth\"/>", ":4: unknown bsdf plugin `cloth`"),
        (r#"<emitter type="sunsky"/>"#, ":3: unknown emitter plugin `sunsky`"),
        (r#"<texture type="voronoi"/>"#, ":3: unknown texture plugin `voronoi`"),
        ("<shape type=\"cube\">\n<emitter type=\"glow\"/></shape>", ":4: unknown emitter plugin `glow`"),
        (
            "<shape type=\"cube\"><bsdf type=\"twosided\">\n\n<bsdf type=\"a\"/></bsdf></shape>",
            ":5: unknown bsdf plugin `a`",
        ),
    ] {
        assert_eq!(error(content, &[]), expected);
    }
    for (old, new) in [("perspective", "fisheye"), ("hdrfilm", "tape"), ("box", "round"), ("independent", "dependent")]
    {
        let text = r#"<scene version="3.0.0"><sensor type="perspective"><film type="hdrfilm"><rfilter type="box"/></film>
            <sampler type="independent"/></sensor></scene>"#;
        load_text(text).unwrap();
        let message = load_text(&text.replace(old, new)).unwrap_err().to_string();
        assert!(message.contains("unknown") && message.ends_with(&format!("plugin `{new}`")), "{message}");
    }
}

#[test]
fn nonsense_is_named_with_file_and_line() {
    for (content, expected) in [
        (r#"<shape type="cube"><float name="x" value="1,5"/></shape>"#, "`1,5` is not a finite number"),
        (r#"<shape type="cube"><float name="x" value="nan"/></shape>"#, "`nan` is not a finite number"),
        (r#"<shape type="cube"><integer name="x" value="1.5"/></shape>"#, "`1.5` is not an integer"),
        (r#"<shape type="cube"><boolean name="x" value="yes"/></shape>"#, "`yes` is neither true nor false"),
        (r#"<shape type="cube"><rgb name="x" value="1 2"/></shape>"#, "`1 2` is not one or three numbers"),
        (r#"<shape type="cube"><float name="x"/></shape>"#, "<float> needs the attribute `value`"),
        (r#"<shape type="cube"><float value="1"/></shape>"#, "the value has no `name`"),
        (r#"<shape type="cube"><sphere name="x"/></shape>"#, "unexpected element <sphere>"),
        (r#"<shape/>"#, "<shape> needs the attribute `type`"),
        (r#"<mode type="final"/>"#, "unexpected element <mode>"),
        (r#"<shape type="cube"><float name="x" value="1"/><float name="x" value="2"/></shape>"#, "`x` is given twice"),
        (r#"<shape type="cube"><string name="to_world" value="1"/></shape>"#, "`to_world` must be a transform"),
        (
            r#"<shape type="sphere"><float name="radius" value="1e300"/></shape>"#,
            "`radius` must be within single precision",
        ),
        (
            r#"<shape type="sphere"><float name="radius" value="0"/></shape>"#,
            "no sphere has the radius 0 and the centre [0.0, 0.0, 0.0]",
        ),
        (r#"<shape type="cube"><ref id="x"/></shape>"#, "nothing has the id `x`"),
        (r#"<alias id="x" as="y"/>"#, "nothing has the id `x`"),
        (r#"<shape type="$x"/>"#, "parameter `$x` has no value; give it one or add a <default>"),
        (r#"<shape type="cube"><bsdf type="diffuse"/><bsdf type="diffuse"/></shape>"#, "a shape has at most one bsdf"),
        (
            r#"<shape type="cube"><emitter type="area"/><emitter type="area"/></shape>"#,
            "a shape has at most one emitter",
        ),
        (r#"<emitter type="constant"/><emitter type="constant"/>"#, "there is more than one environment emitter"),
        (r#"<emitter type="area"/>"#, "the emitter `area` belongs inside a shape"),
        (r#"<emitter type="point"><float name="intensity" value="-1"/></emitter>"#, "`intensity` is negative"),
        (r#"<emitter type="directional"><vector name="direction" x="0"/></emitter>"#, "the direction has no length"),
        (r#"<bsdf type="twosided"/>"#, "the bsdf `twosided` needs one or two bsdfs inside"),
        (r#"<bsdf type="conductor"><string name="material" value="Mud"/></bsdf>"#, "no conductor is called `Mud`"),
        (
            r#"<bsdf type="dielectric"><string name="int_ior" value="mud"/></bsdf>"#,
            "the index of refraction of `mud` is not known",
        ),
        (
            r#"<bsdf type="diffuse"><ref name="reflectance" id="a"/></bsdf><bsdf type="diffuse" id="a"/>"#,
            "a bsdf stands where a texture is expected",
        ),
        (r#"<shape type="instance"/>"#, "an instance needs exactly one shapegroup"),
        (r#"<shape type="instance"><shape type="cube"/></shape>"#, "an instance needs a shapegroup, not another shape"),
        (r#"<shape type="shapegroup"><shape type="shapegroup"/></shape>"#, "groups of shapes must not be nested"),
        (r#"<shape type="obj"/>"#, "the shape needs a `filename`"),
        (
            r#"<integrator type="path"><integer name="max_depth" value="-2"/></integrator>"#,
            "`max_depth` is -2, not -1 or a count",
        ),
    ] {
        let message = error(content, &[]);
        assert_eq!(message.split_once(": ").map(|(_, text)| text), Some(expected), "{content}: {message}");
        assert!(message.starts_with(":3: "), "{message}");
    }
    let twice = "<shape type=\"cube\" id=\"a\"/>\n<shape type=\"cube\" id=\"a\"/>";
    let message = import(twice, &[]).unwrap_err().to_string();
    assert!(message.contains(":4: the id `a` is taken already, at ") && message.ends_with(":3"), "{message}");
}

#[test]
fn unsupported_features_are_errors() {
    for content in [
        r#"<shape type="sphere"><transform name="to_world"><scale x="2"/></transform></shape>"#,
        r#"<shape type="cube"><emitter type="area"><texture name="radiance" type="checkerboard"/></emitter></shape>"#,
        r#"<shape type="cube"><emitter type="point"/></shape>"#,
        r#"<bsdf type="roughconductor"><texture name="alpha" type="checkerboard"/></bsdf>"#,
        r#"<bsdf type="roughconductor"><string name="distribution" value="phong"/></bsdf>"#,
    ] {
        let failed = import(content, &[]).unwrap_err();
        assert!(matches!(failed, ImportError::Unsupported { .. }), "{content}: {failed}");
    }
}

#[test]
fn bad_transforms() {
    for (steps, expected) in [
        (r#"<scale value="0"/>"#, "`to_world` has no inverse"),
        (r#"<scale x="0"/>"#, "`to_world` has no inverse"),
        (r#"<scale value="1e30"/><scale value="1e30"/>"#, "`to_world` has no inverse"),
        (r#"<matrix value="1 2 3 2 4 6 0 0 1"/>"#, "`to_world` has no inverse"),
        (r#"<matrix value="1 2 3"/>"#, "a matrix has 9 or 16 numbers, not 3"),
        (
            r#"<matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"/>"#,
            "the last row of a matrix must be 0 0 0 1: projective transforms are not supported",
        ),
        (r#"<rotate angle="90"/>"#, "the axis of a rotation must not be zero"),
        (r#"<rotate x="1"/>"#, "<rotate> needs `angle`"),
        (r#"<lookat origin="1 1 1" target="1 1 1"/>"#, "`origin` and `target` of <lookat> are the same point"),
        (
            r#"<lookat origin="1 2 3" target="0" up="1 2 3"/>"#,
            "`up` of <lookat> is zero or parallel to the view direction",
        ),
        (r#"<bend x="1"/>"#, "unexpected <bend> inside <transform>"),
    ] {
        let content = format!("<shape type=\"cube\"><transform name=\"to_world\">{steps}</transform></shape>");
        assert_eq!(error(&content, &[]), format!(":3: {expected}"), "{steps}");
    }
    let sensor = |steps: &str| {
        load_text(&format!(
            r#"<scene version="3.0.0"><sensor type="perspective"><transform name="to_world">{steps}</transform></sensor></scene>"#
        ))
    };
    sensor(r#"<scale x="-1"/>"#).unwrap();
    assert!(
        sensor(r#"<scale value="2"/>"#).unwrap_err().to_string().ends_with("the `to_world` of a sensor must not scale")
    );
}

#[test]
fn bad_sensors() {
    let sensor = |plugin: &str, content: &str| {
        load_text(&format!("<scene version=\"3.0.0\"><sensor type=\"{plugin}\">{content}</sensor></scene>"))
            .unwrap_err()
            .to_string()
    };
    let film = |content: &str| sensor("perspective", &format!("<film type=\"hdrfilm\">{content}</film>"));
    for value in ["0", "-1", "4294967296", "65537"] {
        let message = film(&format!("<integer name=\"width\" value=\"{value}\"/>"));
        assert!(message.ends_with(&format!("`width` is {value}, not within 1 and 65536")), "{message}");
    }
    assert!(film(r#"<integer name="crop_width" value="5"/>"#).ends_with("a crop window is not supported"));
    for (filter, expected) in [
        (r#"<rfilter type="tent"><float name="radius" value="0"/></rfilter>"#, "radius of the tent filter is 0,"),
        (r#"<rfilter type="tent"><float name="radius" value="1e9"/></rfilter>"#, "at most 64 pixels"),
        (
            r#"<rfilter type="gaussian"><float name="stddev" value="-1"/></rfilter>"#,
            "standard deviation of the Gaussian",
        ),
    ] {
        assert!(film(filter).contains(expected), "{}", film(filter));
    }
    for value in ["0", "180", "-3"] {
        assert!(
            sensor("perspective", &format!("<float name=\"fov\" value=\"{value}\"/>")).contains("no angle of view")
        );
    }
    assert!(
        sensor("perspective", r#"<string name="focal_length" value="long"/>"#).contains("`long` is no focal length")
    );
    assert!(sensor("perspective", r#"<float name="principal_point_offset_x" value="0.1"/>"#).contains("not supported"));
    assert!(sensor("thinlens", "").contains("a thin lens needs `aperture_radius`"));
    for value in ["0", "-1", "99999999999"] {
        let sampler =
            format!("<sampler type=\"independent\"><integer name=\"sample_count\" value=\"{value}\"/></sampler>");
        assert!(sensor("perspective", &sampler).contains("which is no count of samples"), "{value}");
    }
    let none = load_text("<scene version=\"3.0.0\"/>").unwrap_err();
    assert!(matches!(none, ImportError::NoSensor { .. }), "{none}");
}

#[test]
fn malformed_xml() {
    let whole = scene("<shape type=\"cube\"/>");
    for length in 0..whole.len() {
        assert!(load_text(&whole[..length]).is_err(), "{length}");
    }
    let message = load_text("<scene version=\"3.0.0\">\n<shape type=\"cube\">\n</scene>").unwrap_err().to_string();
    assert!(message.contains("<text>:3: "), "{message}");
    assert!(load_text("<scene/>").unwrap_err().to_string().contains("no `version`"));
    assert!(load_text("<scene version=\"new\"/>").unwrap_err().to_string().contains("`new` is not a version"));
    let laughs = "<!DOCTYPE scene [<!ENTITY a \"b\">]><scene version=\"3.0.0\">&a;</scene>";
    assert!(load_text(laughs).is_err());
}

#[test]
fn deep_nesting() {
    let depth = 100_000;
    let nested = |open: &str, close: &str| scene(&(open.repeat(depth) + &close.repeat(depth)));
    let message = load_text(&nested("<bsdf type=\"twosided\">", "</bsdf>")).unwrap_err().to_string();
    assert!(message.ends_with("elements are nested more than 64 deep"), "{message}");
    load_text(&nested("<a>", "</a>")).unwrap_err();
    // A chain of references, and a tree that would double at every level.
    let mut chain = String::from(r#"<bsdf type="diffuse" id="b0"/>"#);
    for i in 0..100 {
        let _ = write!(chain, r#"<bsdf type="twosided" id="b{}"><ref id="b{i}"/><ref id="b{i}"/></bsdf>"#, i + 1);
    }
    assert!(error(&chain, &[]).ends_with("materials are nested more than 12 deep"));
}

#[test]
fn objects_that_contain_themselves() {
    let cycle = r#"<bsdf type="mask" id="a"><ref id="b"/></bsdf>
        <bsdf type="mask" id="b"><ref id="a"/></bsdf>"#;
    assert!(error(cycle, &[]).ends_with(": the object contains itself"));
    assert!(
        error(r#"<shape type="shapegroup" id="a"><ref id="a"/></shape>"#, &[])
            .ends_with(": the object contains itself")
    );
    // A long chain of references needs no deep stack to be checked.
    let mut chain = String::from(r#"<medium type="m" id="m0"/>"#);
    for i in 0..100_000 {
        let _ = write!(chain, r#"<medium type="m" id="m{}"><ref id="m{i}"/></medium>"#, i + 1);
    }
    load_text(&scene(&chain)).unwrap();
}

#[test]
fn cycles_of_includes() {
    let include = |name: &str| format!("<scene version=\"3.0.0\">\n<include filename=\"{name}\"/></scene>");
    let files = [("a.xml", include("b.xml")), ("b.xml", include("sub/c.xml")), ("sub/c.xml", include("../a.xml"))];
    let files: Vec<_> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    let directory = folder(&files);
    let message = mitsuba::load(&directory.path().join("a.xml"), &[]).unwrap_err().to_string();
    let names: Vec<_> = message.split(" -> ").map(|part| part.rsplit('/').next().unwrap()).collect();
    assert_eq!(names, ["a.xml", "b.xml", "c.xml", "a.xml"], "{message}");
    assert!(message.contains("c.xml:2: files include each other in a cycle"), "{message}");
}

#[test]
fn missing_and_damaged_files() {
    let message = mitsuba::load("no/such/scene.xml".as_ref(), &[]).unwrap_err().to_string();
    assert!(message.starts_with("cannot read no/such/scene.xml: "), "{message}");
    assert!(mitsuba::load(std::env::temp_dir().as_path(), &[]).is_err());

    let mesh = |name: &str| {
        let kind = name.rsplit('.').next().unwrap();
        format!("<shape type=\"{kind}\"><string name=\"filename\" value=\"{name}\"/></shape>")
    };
    let bitmap =
        |name: &str| format!("<texture type=\"bitmap\"><string name=\"filename\" value=\"{name}\"/></texture>");
    let envmap =
        |name: &str| format!("<emitter type=\"envmap\"><string name=\"filename\" value=\"{name}\"/></emitter>");
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (content, name, bytes, expected) in [
        (mesh("a.obj"), "b.obj", b"".as_slice(), "a.obj: No such file"),
        (mesh("a.obj"), "a.obj", b"v 1 2 3\nf 1 2 3", "a.obj: line 2: vertex 2 does not exist, there are 1"),
        (mesh("a.obj"), "a.obj", b"v 1 2", "a.obj: line 1: "),
        (mesh("a.ply"), "b.ply", b"", "a.ply: No such file"),
        (mesh("a.ply"), "a.ply", b"ply\nformat", "a.ply: "),
        (
            mesh("a.ply"),
            "a.ply",
            ply.as_bytes(),
            "a.ply: the header promises 4294967295 of the element `vertex`, but only 0",
        ),
        (mesh("a.serialized"), "a.serialized", b"", "a.serialized: this is not a serialized mesh"),
        (bitmap("a.jpg"), "b.jpg", b"", "a.jpg"),
        (bitmap("a.jpg"), "a.jpg", b"\xff\xd8\xff\xe0\x00\x10JFIF", "a.jpg"),
        (bitmap("a.png"), "a.png", b"\x89PNG\r\n\x1a\n\x00\x00", "a.png"),
        (envmap("a.exr"), "a.exr", b"\x76\x2f\x31\x01\x02\x00\x00\x00chan", "a.exr"),
        (envmap("a.hdr"), "a.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X", "a.hdr"),
    ] {
        let message = import(&content, &[(name, bytes)]).unwrap_err().to_string();
        assert!(message.contains(expected), "{message} does not contain {expected}");
        assert!(message.contains("<text>:3)"), "{message}");
    }
    let spectrum = r#"<bsdf type="diffuse"><spectrum name="reflectance" filename="a.spd"/></bsdf>"#;
    let good = b"# wavelength value\n400 0.5\n700 0.5 # red\n";
    import(spectrum, &[("a.spd", good)]).unwrap();
    assert!(import(spectrum, &[("a.spd", b"400 0.5 3")]).unwrap_err().to_string().contains("a.spd: "));
    assert!(import(spectrum, &[]).unwrap_err().to_string().contains("a.spd: No such file"));
}

/// Every text of the downloaded scenes, damaged in many places, is a scene or an error.
#[test]
fn damaged_scenes_do_not_panic() {
    let Some(assets) = assets() else { return println!("skipped: there is no ../shared/assets") };
    let text = std::fs::read_to_string(assets.join("cornell-box/scene.xml")).unwrap();
    let bytes = text.as_bytes();
    for position in (0..bytes.len()).step_by(7) {
        for damage in [b'"', b'<', b'9', b'-', b'$'] {
            let mut damaged = bytes.to_vec();
            damaged[position] = damage;
            drop(load_text(std::str::from_utf8(&damaged).unwrap()));
        }
    }
}
