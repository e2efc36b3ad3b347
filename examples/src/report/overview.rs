//! The page of experiments.

use std::path::Path;

use maud::{Markup, html};

use super::Page;
use super::claims::{claims, rows};
use super::markdown::markdown;
use super::thumbnails::{Thumbnail, pictures_in};
use crate::experiments::Report;
use crate::output::{OutputError, write_atomically};

/// No picture is wider.
const PICTURE_WIDTH: u32 = 320;
/// Bytes that the pictures of a page take together at most.
const PICTURE_BYTES: usize = 12 << 20;
/// Pictures that an experiment shows at most.
const PICTURES: usize = 12;

/// What experiments found, one section each: their claims, measurements and pictures.
#[derive(Clone, Debug, Default)]
pub struct Overview {
    sections: Vec<Section>,
    picture_bytes: usize,
}

#[derive(Clone, Debug)]
struct Section {
    about: String,
    report: Report,
    pictures: Vec<Thumbnail>,
    /// Pictures of the folder that are not shown.
    left_out: usize,
}

impl Overview {
    /// No experiments yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an experiment, and the PNG files of its folder as small copies: the first 12, and as long as there is room in the page.
    /// Those that cannot be read are passed over.
    pub fn push(&mut self, about: &str, report: Report, folder: &Path) {
        let files = pictures_in(folder);
        let mut pictures = Vec::new();
        for thumbnail in files.iter().filter_map(|file| Thumbnail::of(file, PICTURE_WIDTH).ok()).take(PICTURES) {
            if self.picture_bytes + thumbnail.data.len() <= PICTURE_BYTES {
                self.picture_bytes += thumbnail.data.len();
                pictures.push(thumbnail);
            }
        }
        let left_out = files.len() - pictures.len();
        self.sections.push(Section { about: about.to_owned(), report, pictures, left_out });
    }

    /// Writes the page as `report.html`, and all claims as the table `claims.md`, into a folder that exists.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let page = self.page().html();
        write_atomically(&folder.join("report.html"), |file| file.write_all(page.as_bytes()))?;
        let tables = markdown(self.sections.iter().map(|section| (&*section.about, &section.report)));
        write_atomically(&folder.join("claims.md"), |file| file.write_all(tables.as_bytes()))
    }

    /// The page.
    pub fn page(&self) -> Page {
        let title = match &self.sections[..] {
            [one] => format!("Experiment {}", one.report.experiment),
            _ => "Experiments".to_owned(),
        };
        let quick = self.sections.iter().any(|section| section.report.quick);
        let all = self.sections.iter().flat_map(|section| &section.report.claims).filter(|c| c.is_claimed());
        let (held, count) = all.fold((0, 0), |(held, count), claim| (held + u32::from(claim.holds), count + 1));
        let lead = html! {
            p {
                (held) " of " (count) " claims hold. Intervals contain the true value with a probability of 95 %."
                @if quick { " This is the quick form: small images and few trials." }
            }
        };
        let body = html! {
            @if self.sections.len() > 1 { (self.contents()) }
            @for section in &self.sections { (section.html()) }
        };
        Page { title, lead, body }
    }

    fn contents(&self) -> Markup {
        html! {
            nav aria-label="Experiments" {
                div.scroll tabindex="0" role="region" aria-label="All experiments" {
                    table.contents {
                        thead { tr { th scope="col" { "experiment" } th scope="col" { "what it shows" } th.number scope="col" { "claims that hold" } } }
                        tbody {
                            @for section in &self.sections {
                                @let claims: Vec<_> = section.report.claims.iter().filter(|claim| claim.is_claimed()).collect();
                                @let held = claims.iter().filter(|claim| claim.holds).count();
                                tr.fails[held < claims.len()] {
                                    th scope="row" { a href={ "#" (section.report.experiment) } { (section.report.experiment) } }
                                    td { (section.about) }
                                    td.number { (held) " of " (claims.len()) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

impl Section {
    fn html(&self) -> Markup {
        let report = &self.report;
        html! {
            section.experiment id=(report.experiment) {
                h2 { (report.experiment) }
                p { (self.about) ". Seed " (report.seed) "." }
                (claims(&report.claims))
                @if !self.pictures.is_empty() {
                    div.pictures {
                        @for picture in &self.pictures {
                            figure {
                                img src=(picture.data) width=(picture.size[0]) height=(picture.size[1]) alt={ "Picture " (picture.name) };
                                figcaption { (picture.name) }
                            }
                        }
                    }
                    @if self.left_out > 0 { p.small { (self.left_out) " more pictures are in the folder." } }
                }
                @if !report.rows.is_empty() {
                    details { summary { "All " (report.rows.len()) " measurements" } (rows(report)) }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiments::{Claim, Row};

    fn report(experiment: &str, holds: bool) -> Report {
        let claim =
            Claim { id: "c".into(), paper: "> 1".into(), measured: 2.0, ci95: [1.5, 2.5], holds, ..Claim::default() };
        let rows = vec![Row { rel_mse: 0.5, ..Row::new("<scene>", "path", [("spp", 64.into())]) }];
        Report { experiment: experiment.into(), claims: vec![claim], rows, ..Report::default() }
    }

    #[test]
    fn the_page_has_every_experiment_with_its_pictures() {
        let folder = tempfile::tempdir().unwrap();
        for index in 0..PICTURES + 3 {
            image::RgbImage::new(4, 4).save(folder.path().join(format!("{index:02}.png"))).unwrap();
        }
        let mut overview = Overview::new();
        overview.push("first", report("one", true), folder.path());
        assert_eq!(overview.page().title, "Experiment one");
        overview.push("second & last", report("two", false), &folder.path().join("nowhere"));
        let text = overview.page().html();
        assert!(
            text.contains("1 of 2 claims hold") && text.contains("href=\"#two\"") && text.contains("second &amp; last")
        );
        assert!(text.contains("&lt;scene&gt;") && text.contains("spp 64") && text.contains("3 more pictures"));
        assert_eq!(text.matches("data:image/png").count(), PICTURES);
    }
}
