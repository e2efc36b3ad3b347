//! All metrics of two files.

use std::fmt;
use std::path::{Path, PathBuf};

use scene_core::film::LayeredImage;
use serde::{Deserialize, Serialize};

use super::squared_error::means;
use super::{ImagePair, MetricError, flip_hdr, flip_ldr, mean_ratio, mrse, mse, relative_mse};

/// What [`diff`] found. Displays as a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiffReport {
    /// The image under test.
    pub test: PathBuf,
    /// The reference.
    pub reference: PathBuf,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// See [`mse`].
    pub mse: f64,
    /// See [`relative_mse`].
    pub relative_mse: f64,
    /// See [`mrse`].
    pub mrse: f64,
    /// See [`flip_ldr`].
    pub flip_ldr: f64,
    /// See [`flip_hdr`].
    pub flip_hdr: f64,
    /// Means per channel of the image under test.
    pub mean_test: [f64; 3],
    /// Means per channel of the reference.
    pub mean_reference: [f64; 3],
    /// Their ratios; nothing where the reference is black.
    pub mean_ratio: [Option<f64>; 3],
    /// Number of pixels of the image under test that are not finite, and not compared.
    pub non_finite_test: usize,
    /// Number of pixels of the reference that are not finite, and not compared.
    pub non_finite_reference: usize,
}

/// Compares the OpenEXR file `test` with the file `reference`.
///
/// # Errors
/// [`MetricError`] if one of them cannot be read (the message names it) or has no colours, if the sizes differ, or if
/// no pixel is finite in both.
pub fn diff(test: &Path, reference: &Path) -> Result<DiffReport, MetricError> {
    let pair = ImagePair::of_images(&LayeredImage::read_exr(test)?, &LayeredImage::read_exr(reference)?)?;
    let [mean_test, mean_reference] = means(&pair);
    let [non_finite_test, non_finite_reference] = pair.non_finite();
    let [width, height] = pair.size();
    Ok(DiffReport {
        test: test.to_owned(),
        reference: reference.to_owned(),
        width,
        height,
        mse: mse(&pair),
        relative_mse: relative_mse(&pair),
        mrse: mrse(&pair),
        flip_ldr: flip_ldr(&pair),
        flip_hdr: flip_hdr(&pair),
        mean_test,
        mean_reference,
        mean_ratio: mean_ratio(&pair),
        non_finite_test,
        non_finite_reference,
    })
}

impl fmt::Display for DiffReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "test       {} ({}x{})", self.test.display(), self.width, self.height)?;
        writeln!(f, "reference  {}", self.reference.display())?;
        writeln!(f)?;
        for (name, value) in [
            ("MSE", self.mse),
            ("relative MSE", self.relative_mse),
            ("MRSE (trimmed)", self.mrse),
            ("FLIP (LDR)", self.flip_ldr),
            ("FLIP (HDR)", self.flip_hdr),
        ] {
            writeln!(f, "{name:<16} {value:>14.6e}")?;
        }
        writeln!(f)?;
        writeln!(f, "{:<10} {:>14} {:>14} {:>10}", "channel", "mean of test", "of reference", "ratio")?;
        for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
            let ratio = self.mean_ratio[channel].map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.6}"));
            let (test, reference) = (self.mean_test[channel], self.mean_reference[channel]);
            writeln!(f, "{name:<10} {test:>14.6e} {reference:>14.6e} {ratio:>10}")?;
        }
        if self.non_finite_test + self.non_finite_reference > 0 {
            let (test, reference) = (self.non_finite_test, self.non_finite_reference);
            writeln!(f)?;
            writeln!(f, "left out, as they are not finite: {test} pixels of test, {reference} of reference")?;
        }
        Ok(())
    }
}
