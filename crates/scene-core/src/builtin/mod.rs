//! Scenes that need no file: generated here, so that everything runs with no download.

mod blob;
mod caustics;
mod conference;
mod cornell_box;
mod door_slit;
mod fence;
mod finish;
mod foliage;
mod form;
mod furnace;
mod furniture;
mod interior;
mod lantern_field;
mod noise;
mod office;
mod plane;
mod rooms;
mod shapes;
mod sky;
mod solids;
mod sphere_row;
mod translucent;
mod variety;

use crate::reference::SceneDescription;

pub use blob::{blob, blob_environment, blob_under};
pub use caustics::{caustic_room, glass_ball};
pub use conference::conference;
pub use cornell_box::cornell_box;
pub use door_slit::door_slit;
pub use fence::fence;
pub use foliage::foliage;
pub use furnace::{furnace, furnace_box};
pub use interior::interior;
pub use lantern_field::lantern_field;
pub use office::office;
pub use plane::{plane_light, plane_point};
pub use rooms::rooms;
pub use shapes::SceneBuilder;
pub use sky::sky_image;
pub use sphere_row::sphere_row;
pub use translucent::translucent_blob;

/// A builtin scene.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Builtin {
    /// The name by which it is asked for.
    pub name: &'static str,
    /// What it shows, in a line.
    pub about: &'static str,
    make: fn() -> SceneDescription,
}

impl Builtin {
    /// All builtin scenes.
    pub const ALL: &'static [Self] = &[
        Self { name: "cornell-box", about: "the Cornell box, as measured", make: cornell_box },
        Self {
            name: "furnace",
            about: "a sphere of albedo 0.8 in uniform light: every pixel on it is 0.8",
            make: furnace_sphere,
        },
        Self {
            name: "furnace-box",
            about: "a closed box of albedo 0.5 that emits 1 everywhere: every pixel is 2",
            make: furnace_box_half,
        },
        Self {
            name: "interior",
            about: "a furnished room in the evening, lit by a ceiling panel and a lamp",
            make: interior,
        },
        Self {
            name: "office",
            about: "a furnished office whose lamps shine at the ceiling and the walls",
            make: office,
        },
        Self {
            name: "conference",
            about: "a conference room with twelve chairs under eight ceiling panels",
            make: conference,
        },
        Self { name: "plane-light", about: "a light that stands upright on a plane", make: plane_light },
        Self { name: "plane-point", about: "a point light closely over a plane", make: plane_point },
        Self {
            name: "blob",
            about: "a rugged object of 150 thousand triangles, glossy and diffuse, under two area lights",
            make: blob,
        },
        Self {
            name: "blob-environment",
            about: "the same under two area lights and a sky with a small sun",
            make: blob_environment,
        },
        Self {
            name: "sphere-row",
            about: "four spheres (diffuse, Cook-Torrance, rough gold, Phong) in uniform light",
            make: sphere_row,
        },
        Self { name: "rooms", about: "10 x 10 rooms with a lamp each; the camera is in one of them", make: rooms_100 },
        Self { name: "rooms-1000", about: "40 x 25 rooms with a lamp each", make: rooms_1000 },
        Self { name: "rooms-10000", about: "100 x 100 rooms with a lamp each", make: rooms_10000 },
        Self {
            name: "door-slit",
            about: "two rooms and a door that is ajar: the lamp in the one, the camera in the other",
            make: door_slit,
        },
        Self {
            name: "caustic-room",
            about: "glass and metal on a table, lit via a bright wall only",
            make: caustic_room,
        },
        Self {
            name: "lantern-field",
            about: "a thousand lamps of very different power over a field with walls and pillars",
            make: lantern_field,
        },
        Self { name: "glass-ball", about: "caustics of a glass ball and a golden ring on a floor", make: glass_ball },
        Self {
            name: "fence",
            about: "a chain-link fence with wires thinner than a pixel, before a chequered yard in the sun",
            make: fence,
        },
        Self {
            name: "foliage",
            about: "a shrub of 3240 leaves in the corner of two walls, under an area light",
            make: foliage,
        },
        Self {
            name: "translucent-blob",
            about: "the blob of a milky material, lit from behind (participating medium)",
            make: translucent_blob,
        },
    ];

    /// The builtin scene of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|builtin| builtin.name == name)
    }

    /// Its description.
    pub fn description(&self) -> SceneDescription {
        (self.make)()
    }
}

fn furnace_sphere() -> SceneDescription {
    furnace(crate::material::Material::Diffuse { reflectance: crate::traits::Rgb::splat(0.8).into() })
}

fn furnace_box_half() -> SceneDescription {
    furnace_box(0.5, 1.0)
}

fn rooms_100() -> SceneDescription {
    rooms(10, 10)
}

fn rooms_1000() -> SceneDescription {
    SceneDescription { name: "rooms-1000".to_owned(), ..rooms(40, 25) }
}

fn rooms_10000() -> SceneDescription {
    SceneDescription { name: "rooms-10000".to_owned(), ..rooms(100, 100) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::ReferenceScene;
    use crate::traits::Scene;

    #[test]
    fn all_build_without_warnings_and_have_light() {
        for builtin in Builtin::ALL {
            let scene = ReferenceScene::new(builtin.description()).unwrap();
            assert_eq!(scene.warnings(), &[] as &[String], "{}", builtin.name);
            assert!(!scene.emitters().is_empty(), "{}", builtin.name);
            assert_eq!(scene.name(), builtin.name);
        }
        assert!(Builtin::named("nowhere").is_none());
    }
}
