//! Convergence plots as inline SVG.
//!
//! Written by hand rather than by a plotting crate: those fix their colours, while text here has the colour of the page's
//! (`currentColor`) and lines have colours of the style sheet, which differ between light and dark.

use maud::{Markup, html};

use super::axis::LogAxis;
use super::number::{breakable, tick, with_interval};
use super::{Estimate, PowerLaw};

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 380.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 546.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 326.0;
/// Styles that the style sheet has.
const STYLES: usize = 8;

/// A line of a plot.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// The means of all budgets, from left to right: `x`, and `y` with its interval.
    pub points: Vec<(f64, Estimate)>,
    /// What the slope is fitted to: all trials.
    pub trials: Vec<[f64; 2]>,
}

/// A plot with two logarithmic axes.
#[derive(Clone, Debug)]
pub struct Plot {
    /// What it shows, for those who cannot see it too.
    pub title: String,
    /// The horizontal axis.
    pub x: String,
    /// The vertical axis.
    pub y: String,
    /// The lines.
    pub series: Vec<Series>,
}

impl Plot {
    /// A figure with the drawing, and a legend that tells the slopes.
    pub fn html(&self) -> Markup {
        html! {
            figure.plot {
                figcaption { (self.title) }
                (self.svg())
                ul.legend {
                    @for (index, series) in self.series.iter().enumerate() {
                        li {
                            svg.swatch viewBox="0 0 34 12" aria-hidden="true" {
                                g class=(style(index)) {
                                    path.line d="M1 6H33" {}
                                    path.marker d=(marker(index, 17.0, 6.0)) {}
                                }
                            }
                            span.name { (breakable(&series.name)) }
                            span.slope {
                                @match PowerLaw::fit(&series.trials) {
                                    Some(law) => { "slope " (with_interval(&law.exponent)) }
                                    None => { "no slope: too few budgets" }
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    fn svg(&self) -> Markup {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x = LogAxis::around(points().map(|(x, _)| *x), LEFT, RIGHT);
        let bounds = points().filter(|(_, y)| y.value > 0.0 && y.value.is_finite()).flat_map(|(_, y)| {
            // An interval without bounds would leave no room for the means.
            let [low, high] = y.ci95.map(|bound| bound.clamp(0.1 * y.value, 10.0 * y.value));
            [low, y.value, high]
        });
        let y = LogAxis::around(bounds, BOTTOM, TOP);
        html! {
            svg viewBox={ "0 0 " (WIDTH) " " (HEIGHT) } role="img" aria-label=(self.description()) {
                (self.frame(&x, &y))
                @for (index, series) in self.series.iter().enumerate() {
                    g class=(style(index)) { (draw(index, series, &x, &y)) }
                }
            }
        }
    }

    fn frame(&self, x: &LogAxis, y: &LogAxis) -> Markup {
        html! {
            @for value in x.ticks() {
                path.grid d={ "M" (places(x.place(value))) " " (TOP) "V" (BOTTOM) } {}
                text x=(places(x.place(value))) y=(BOTTOM + 20.0) text-anchor="middle" { (tick(value)) }
            }
            @for value in y.ticks() {
                path.grid d={ "M" (LEFT) " " (places(y.place(value))) "H" (RIGHT) } {}
                text x=(LEFT - 8.0) y=(places(y.place(value) + 4.5)) text-anchor="end" { (tick(value)) }
            }
            path.frame d={ "M" (LEFT) " " (TOP) "V" (BOTTOM) "H" (RIGHT) } {}
            text x=(0.5 * (LEFT + RIGHT)) y=(HEIGHT - 10.0) text-anchor="middle" { (self.x) }
            text transform={ "translate(16 " (0.5 * (TOP + BOTTOM)) ") rotate(-90)" } text-anchor="middle" { (self.y) }
        }
    }

    /// The numbers, for those who cannot see the lines.
    fn description(&self) -> String {
        let lines = self.series.iter().map(|series| {
            let known = series.points.iter().filter(|(_, y)| y.value.is_finite());
            let points = known.map(|(x, y)| format!("{:.3e} at {x:.3e}", y.value));
            format!("{}: {}", series.name, points.collect::<Vec<_>>().join(", "))
        });
        format!("{}. {}", self.title, lines.collect::<Vec<_>>().join("; "))
    }
}

/// Error bars, the line through the means, and their markers.
fn draw(index: usize, series: &Series, x: &LogAxis, y: &LogAxis) -> Markup {
    let finite = || series.points.iter().filter(|(x, y)| *x > 0.0 && y.value > 0.0 && y.value.is_finite());
    let line: Vec<String> =
        finite().map(|(at, value)| format!("{} {}", places(x.place(*at)), places(y.place(value.value)))).collect();
    html! {
        @for (at, value) in finite() {
            @let column = x.place(*at);
            @let [low, high] = value.ci95.map(|bound| places(y.place(bound)));
            path.bar d={
                "M" (places(column)) " " (low) "V" (high)
                "M" (places(column - 4.0)) " " (low) "h8M" (places(column - 4.0)) " " (high) "h8"
            } {}
        }
        @if line.len() > 1 { path.line d={ "M" (line.join("L")) } {} }
        @for (at, value) in finite() {
            path.marker d=(marker(index, x.place(*at), y.place(value.value))) {
                title { (series.name) ": " (format!("{:.3e} at {at:.3e}", value.value)) }
            }
        }
    }
}

/// Colour and dashes by the style sheet.
fn style(index: usize) -> String {
    format!("series-{}", index % STYLES)
}

/// Circle, square, triangle, diamond: lines are told apart without colours.
fn marker(index: usize, x: f64, y: f64) -> String {
    let at = |x: f64, y: f64| format!("M{} {}", places(x), places(y));
    match index % 4 {
        0 => at(x - 4.0, y) + "a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z",
        1 => at(x - 3.6, y - 3.6) + "h7.2v7.2h-7.2z",
        2 => at(x, y - 4.8) + "l4.6 8.2h-9.2z",
        _ => at(x, y - 5.0) + "l5 5l-5 5l-5 -5z",
    }
}

/// A tenth of a pixel is enough.
fn places(coordinate: f64) -> String {
    format!("{coordinate:.1}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(series: Vec<Series>) -> String {
        Plot { title: "error & time".into(), x: "seconds".into(), y: "error".into(), series }.html().into_string()
    }

    #[test]
    fn plots_have_lines_bars_slopes_and_escape_names() {
        let trials: Vec<[f64; 2]> = (0..6).map(|i| f64::from(1 << i)).map(|x| [x, 1.0 / x]).collect();
        let points = trials.iter().map(|[x, y]| (*x, Estimate { value: *y, ci95: [0.9 * y, 1.1 * y] })).collect();
        let text = plot(vec![Series { name: "<b>".into(), points, trials }]);
        assert_eq!(text.matches("class=\"bar\"").count(), 6);
        assert_eq!(text.matches("class=\"line\"").count(), 2, "one in the plot, one in the legend");
        assert!(text.contains("−1.00") && text.contains("&lt;b&gt;") && !text.contains("<b>"), "{text}");
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn plots_without_any_numbers_are_still_drawings() {
        let nothing = Series { name: "none".into(), points: vec![], trials: vec![] };
        let nan = Series { points: vec![(1.0, Estimate::of_mean(&[]))], ..nothing.clone() };
        let single = Series { points: vec![(1.0, Estimate::of_mean(&[1.0]))], ..nothing.clone() };
        for series in [vec![], vec![nothing], vec![nan], vec![single]] {
            let text = plot(series);
            assert!(text.contains("<svg") && !text.contains("NaN") && !text.contains("inf"), "{text}");
        }
    }
}
