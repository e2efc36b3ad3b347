//! The viewer of images: the data, and the controls that `viewer.js` brings to life.

use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use super::pixels::encode;

/// How the numbers of a picture become colours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shown {
    /// Linear RGB, exposed and through the tone curve.
    Radiance,
    /// Linear RGB between 0 and 1, as sRGB at any exposure.
    Albedo,
    /// Unit vectors: -1 to 1 as 0 to 1.
    Normal,
    /// One number, coloured from dark to bright between two others.
    Map {
        /// The number that is darkest.
        low: f32,
        /// The number that is brightest.
        high: f32,
        /// Whether the scale is logarithmic.
        log: bool,
        /// The colours.
        colours: Colours,
    },
}

/// Perceptually even sequences of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Colours {
    /// Black, purple, orange, white: for errors.
    Magma,
    /// Purple, green, yellow: for anything else.
    Viridis,
}

impl Shown {
    fn channels(self) -> usize {
        if matches!(self, Self::Map { .. }) { 1 } else { 3 }
    }
}

/// A picture as numbers, row by row from the top.
#[derive(Clone, Debug)]
pub struct Picture {
    name: String,
    shown: Shown,
    size: [u32; 2],
    values: Vec<f32>,
}

/// The numbers of a picture do not fit its size.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{name}' has {found} numbers instead of {expected}")]
pub struct PictureError {
    /// The picture.
    pub name: String,
    /// How many numbers it should have.
    pub expected: usize,
    /// How many it has.
    pub found: usize,
}

impl Picture {
    /// A picture of `size`, width and height, with the channels of a pixel next to each other: one for maps, three for all others.
    ///
    /// # Errors
    /// [`PictureError`] if there are not as many numbers as that makes.
    pub fn new(name: &str, shown: Shown, size: [u32; 2], values: Vec<f32>) -> Result<Self, PictureError> {
        let expected = size[0] as usize * size[1] as usize * shown.channels();
        if values.len() != expected {
            return Err(PictureError { name: name.to_owned(), expected, found: values.len() });
        }
        Ok(Self { name: name.to_owned(), shown, size, values })
    }
}

/// Pictures to be compared, two at a time.
#[derive(Clone, Debug)]
pub struct Viewer {
    /// All pictures.
    pub pictures: Vec<Picture>,
    /// The one on the left side at first.
    pub left: usize,
    /// The one on the right side at first.
    pub right: usize,
    /// The exposure at first, in stops.
    pub exposure: f32,
}

#[derive(Serialize)]
struct Description<'a> {
    name: &'a str,
    width: u32,
    height: u32,
    channels: usize,
    #[serde(flatten)]
    shown: Shown,
}

impl Viewer {
    /// The viewer in HTML. The page has the style and the script.
    pub fn html(&self) -> Markup {
        html! {
            section.viewer data-left=(self.left) data-right=(self.right) data-exposure=(self.exposure) aria-label="Image viewer" {
                noscript { p.notice { "The images are data that a script draws, and scripts are off." } }
                div.stage {
                    canvas.screen tabindex="0" role="img"
                        aria-label="The left and the right image, divided by the wipe" aria-describedby="viewer-keys" {}
                    span.side.left-name aria-hidden="true" {}
                    span.side.right-name aria-hidden="true" {}
                }
                label.wipe-row {
                    span.visually-hidden { "Wipe" }
                    input.wipe type="range" min="0" max="100" step="1" value="50" aria-label="Wipe between left and right, in percent";
                }
                (self.controls())
                div.readout aria-hidden="true" { span.at { "Move over the image to read pixels." } span.left-value {} span.right-value {} }
                p.status.visually-hidden role="status" {}
                (keys())
                div.gallery role="group" aria-label="Images: choose one for the left side, with Shift for the right" {}
                (self.data())
            }
        }
    }

    fn controls(&self) -> Markup {
        html! {
            div.controls {
                label { "Left " select.left { (self.options(self.left)) } }
                button.swap type="button" title="Swap left and right (x)" { "⇄ Swap" }
                label { "Right " select.right { (self.options(self.right)) } }
                span.group {
                    label { "Exposure "
                        input.exposure type="range" min="-10" max="10" step="0.25" value=(self.exposure) aria-label="Exposure in stops";
                    }
                    output.stops { "0" }
                    button.reset type="button" title="Exposure as it was" { "Reset" }
                }
                label { "Tone curve "
                    select.curve { option value="srgb" { "sRGB" } option value="aces" { "ACES, sRGB" } option value="linear" { "linear" } }
                }
                span.group role="group" aria-label="Zoom" {
                    button.zoom-out type="button" aria-label="Zoom out" title="Zoom out ([)" { "−" }
                    output.zoom { "100 %" }
                    button.zoom-in type="button" aria-label="Zoom in" title="Zoom in (])" { "+" }
                    button.fit type="button" title="Show everything (0)" { "Fit" }
                    button.whole type="button" title="One pixel of the image is one of the screen" { "1:1" }
                }
            }
        }
    }

    fn options(&self, chosen: usize) -> Markup {
        html! {
            @for (index, picture) in self.pictures.iter().enumerate() {
                option value=(index) selected[index == chosen] { (index + 1) " " (picture.name) }
            }
        }
    }

    fn data(&self) -> Markup {
        let describe = |picture: &'_ Picture| {
            let [width, height] = picture.size;
            let (name, shown) = (picture.name.clone(), picture.shown);
            serde_json::to_value(Description { name: &name, width, height, channels: shown.channels(), shown })
        };
        let all: Result<Vec<_>, _> = self.pictures.iter().map(describe).collect();
        let json = all.map_or_else(|_| "[]".to_owned(), |all| serde_json::Value::from(all).to_string());
        html! {
            script.picture-data type="application/json" { (PreEscaped(for_script(&json))) }
            @for picture in &self.pictures {
                // Letters, digits, +, / and =: nothing that would end the element.
                script.pixels type="text/plain" { (PreEscaped(encode(&picture.values))) }
            }
        }
    }
}

/// JSON that cannot end the script element that it stands in.
fn for_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

fn keys() -> Markup {
    let key = |key: &str, what: &str| html! { span { kbd { (key) } " " (what) } };
    html! {
        p.keys #viewer-keys {
            (key("← →", "wipe")) (key("+ −", "exposure")) (key("1 … 9", "left image")) (key("Shift 1 … 9", "right image"))
            (key("x", "swap")) (key("[ ]", "zoom")) (key("0", "fit")) (key("Shift ← ↑ ↓ →", "pan"))
            span { "drag to wipe or pan, wheel to zoom once the image has the focus" }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(name: &str) -> Picture {
        Picture::new(name, Shown::Radiance, [2, 1], vec![0.5; 6]).unwrap()
    }

    #[test]
    fn pictures_have_as_many_numbers_as_their_size_says() {
        let map = Shown::Map { low: 0.0, high: 1.0, log: false, colours: Colours::Magma };
        assert!(Picture::new("map", map, [2, 1], vec![0.0; 2]).is_ok());
        let error = Picture::new("map", map, [2, 1], vec![0.0; 6]).unwrap_err();
        assert_eq!(error.to_string(), "'map' has 6 numbers instead of 2");
        assert!(Picture::new("normal", Shown::Normal, [2, 1], vec![0.0; 2]).is_err());
    }

    #[test]
    fn names_are_escaped_in_markup_and_in_data() {
        let name = "</script><script>alert(\"1\")</script>&";
        let viewer = Viewer { pictures: vec![picture(name)], left: 0, right: 0, exposure: 0.0 };
        let text = viewer.html().into_string();
        assert!(!text.contains("<script>alert"), "{text}");
        // What a browser hands to the script.
        let start = text.find("application/json\">").unwrap() + "application/json\">".len();
        let json = &text[start..start + text[start..].find("</script>").unwrap()];
        let data: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(data[0]["name"], name);
        assert_eq!((&data[0]["kind"], &data[0]["width"]), (&"radiance".into(), &2.into()));
    }
}
