//! The camera.

use glam::{Affine3A, DMat3, DVec3, Mat3A};

use super::error::{ImportError, Result, invalid, unsupported};
use super::importer::Importer;
use super::properties::{Group, Property};
use crate::reference::CameraDescription;

/// Width of the image in pixels: scene files do not say it.
const WIDTH: f64 = 640.0;
/// Largest height.
const LARGEST_HEIGHT: f64 = 65_536.0;

impl Importer<'_> {
    pub(super) fn camera(&mut self, group: &Group) -> Result<CameraDescription> {
        if let Some(kind) = group.get("type").filter(|kind| kind.text() != "perspective") {
            let (place, name) = (kind.place.clone(), kind.text().to_owned());
            return Err(ImportError::UnknownType { place, kind: "camera", name });
        }
        let to_world = to_world(group)?;
        let field_of_view = group.number("fieldofview", 45.0)?;
        if !(field_of_view > 0.0 && field_of_view < 180.0) {
            return Err(invalid(&group.place, format!("a `fieldofview` of {field_of_view} degrees")));
        }
        let [width, height] = window(group)?;
        let aperture_radius = group.number("lensradius", 0.0)?;
        let focus_distance = group.number("focaldistance", 10.0)?;
        if aperture_radius < 0.0 || focus_distance <= 0.0 {
            let message = format!("a `lensradius` of {aperture_radius} and a `focaldistance` of {focus_distance}");
            return Err(invalid(&group.place, message + " make no lens"));
        }
        if aperture_radius > 0.0 && group.flag("autofocus.enable", false)? {
            self.warn_at(&group.place, "ignored: `autofocus`; the file's `focaldistance` is taken");
        }
        for feature in ["oculusrift.barrelpostpro.enable", "clippingplane.enable"] {
            if group.flag(feature, false)? {
                return Err(unsupported(&group.place, format!("`{feature}`")));
            }
        }
        group.ignore(&[
            "cliphither",
            "clipyon",
            "shutteropen",
            "shutterclose",
            "autovolume.enable",
            "autofocus.enable",
        ]);
        group.ignore(&["bokeh.blades", "bokeh.power", "bokeh.distribution.type", "bokeh.scale.x", "bokeh.scale.y"]);
        self.warn_unused(group);
        Ok(CameraDescription {
            to_world,
            fov_x: (2.0 * ((0.5 * field_of_view.to_radians()).tan() * width).atan()) as f32,
            aperture_radius: aperture_radius as f32,
            focus_distance: focus_distance as f32,
            width: WIDTH as u32,
            height: (WIDTH * height / width).round().clamp(1.0, LARGEST_HEIGHT) as u32,
        })
    }
}

/// From the camera's coordinates, +x to the left, +y up, +z forwards.
fn to_world(group: &Group) -> Result<Affine3A> {
    let vector = |property: &Property| Ok(DVec3::from(property.numbers::<3>()?));
    let origin = vector(group.require("lookat.orig")?)?;
    let target = vector(group.require("lookat.target")?)?;
    let up = group.get("up").map_or(Ok(DVec3::Z), vector)?;
    let forwards = (target - origin).try_normalize();
    let left = forwards.and_then(|z| up.cross(z).try_normalize());
    let (Some(z), Some(x)) = (forwards, left) else {
        let message = format!("the camera looks from {origin} to {target} with {up} up");
        return Err(invalid(&group.place, message + ", which gives no direction"));
    };
    let matrix3 = DMat3::from_cols(x, z.cross(x), z).as_mat3();
    Ok(Affine3A { matrix3: Mat3A::from(matrix3), translation: origin.as_vec3a() })
}

/// Half of the width and height of the screen window.
fn window(group: &Group) -> Result<[f64; 2]> {
    let Some(property) = group.get("screenwindow") else { return Ok([1.0, 0.75]) };
    let [left, right, bottom, top] = property.numbers::<4>()?;
    if !(right > left && top > bottom) {
        return Err(invalid(&property.place, "the `screenwindow` is empty"));
    }
    let shift = ((left + right) / (right - left)).abs().max(((bottom + top) / (top - bottom)).abs());
    if shift > 1e-4 {
        return Err(unsupported(&property.place, "a `screenwindow` that is not around the middle"));
    }
    Ok([0.5 * (right - left), 0.5 * (top - bottom)])
}
