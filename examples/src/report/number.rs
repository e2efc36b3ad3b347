//! Numbers for people: three digits, with a power of ten where there would be many zeros.

use maud::{Markup, html};

use super::Estimate;

/// Numbers that are written without a power of ten.
const PLAIN: std::ops::Range<f64> = 1e-3..1e5;

/// A number with three digits.
pub(super) fn number(value: f64) -> Markup {
    match Scale::of(value) {
        Scale { power: Some(power), .. } => html! { (Scale::of(value).digits(value)) (times(power)) },
        scale => html! { (scale.digits(value)) },
    }
}

/// A number and its interval, all three with the digits and the power of ten of the number itself.
pub(super) fn with_interval(estimate: &Estimate) -> Markup {
    let [low, high] = estimate.ci95;
    if low == high && estimate.value.fract() == 0.0 && PLAIN.contains(&estimate.value) {
        // A count, the same in all trials.
        return html! { span.value { (format!("{:.0}", estimate.value)) } };
    }
    let scale = Scale::of(estimate.value);
    html! {
        span.value { (scale.digits(estimate.value)) @if let Some(power) = scale.power { (times(power)) } }
        @if low.is_finite() && high.is_finite() {
            " " span.interval {
                "(" (scale.digits(low)) " – " (scale.digits(high)) ")"
                @if let Some(power) = scale.power { (times(power)) }
            }
        } @else if estimate.value.is_finite() {
            " " span.interval { "(unknown)" }
        }
    }
}

/// The same as plain text.
pub(super) fn text_with_interval(estimate: &Estimate) -> String {
    let [low, high] = estimate.ci95;
    let scale = Scale::of(estimate.value);
    let text = |value: f64| match scale.power {
        Some(power) if value.is_finite() => format!("{}e{power}", scale.digits(value)),
        _ => scale.digits(value),
    };
    if low == high || !(low.is_finite() && high.is_finite()) {
        return text(estimate.value);
    }
    format!("{} ({} – {})", text(estimate.value), text(low), text(high))
}

/// A name of an estimator, which may be broken before its options: it has no spaces.
pub(super) fn breakable(name: &str) -> Markup {
    let mut parts = name.split(':');
    html! {
        (parts.next().unwrap_or_default())
        @for part in parts {
            @if !part.starts_with(' ') { wbr; }
            ":" (part)
        }
    }
}

/// A label of an axis.
pub(super) fn tick(value: f64) -> String {
    let decade = value.log10().floor();
    if (1e-2..1e4).contains(&value) {
        let digits = (-decade).max(0.0) as usize;
        return format!("{value:.digits$}");
    }
    let mantissa = (value / 10f64.powf(decade)).round();
    let power: String = format!("{decade}").chars().map(superscript).collect();
    if mantissa == 1.0 { format!("10{power}") } else { format!("{mantissa}·10{power}") }
}

fn superscript(digit: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    digit.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])
}

fn times(power: i32) -> Markup {
    let sign = if power < 0 { "−" } else { "" };
    html! { "·10" sup { (sign) (power.abs()) } }
}

/// How many digits after the point, and which power of ten is taken out.
#[derive(Clone, Copy)]
struct Scale {
    digits: usize,
    power: Option<i32>,
}

impl Scale {
    fn of(value: f64) -> Self {
        let size = value.abs();
        if !size.is_finite() || size == 0.0 {
            return Self { digits: 0, power: None };
        }
        let power = size.log10().floor() as i32;
        if PLAIN.contains(&size) {
            return Self { digits: (2 - power).max(0) as usize, power: None };
        }
        Self { digits: 2, power: Some(power) }
    }

    fn digits(self, value: f64) -> String {
        if value.is_nan() {
            return "–".to_owned();
        }
        if value.is_infinite() {
            return if value > 0.0 { "∞" } else { "−∞" }.to_owned();
        }
        let scaled = value / 10f64.powi(self.power.unwrap_or(0));
        format!("{scaled:.*}", self.digits).replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (-12.345, "−12.3"),
            (0.012_345, "0.0123"),
            (64_000.0, "64000"),
            (1.234e-5, "1.23·10<sup>−5</sup>"),
            (1.5e9, "1.50·10<sup>9</sup>"),
            (f64::INFINITY, "∞"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(number(value).into_string(), text);
        }
        let text = with_interval(&Estimate { value: 2e-4, ci95: [9e-5, 3.14e-4] }).into_string();
        assert!(text.contains("(0.90 – 3.14)·10<sup>−4</sup>"), "{text}");
        assert_eq!(text_with_interval(&Estimate { value: 2e-4, ci95: [9e-5, 3.14e-4] }), "2.00e-4 (0.90e-4 – 3.14e-4)");
        assert_eq!(text_with_interval(&Estimate { value: 2.0, ci95: [1.5, 2.5] }), "2.00 (1.50 – 2.50)");
        assert_eq!(text_with_interval(&Estimate { value: 2.0, ci95: [2.0; 2] }), "2.00");
        assert_eq!(text_with_interval(&Estimate { value: f64::NAN, ci95: [f64::NAN; 2] }), "–");
        let count = with_interval(&Estimate::of_mean(&[16.0, 16.0])).into_string();
        assert_eq!(count, "<span class=\"value\">16</span>");
        assert!(with_interval(&Estimate::of_mean(&[1.0])).into_string().contains("unknown"));
    }

    #[test]
    fn names_break_before_options_and_are_escaped() {
        assert_eq!(breakable("a:b=<c>:d").into_string(), "a<wbr>:b=&lt;c&gt;<wbr>:d");
        assert_eq!(breakable("a: b").into_string(), "a: b");
        assert_eq!(breakable("").into_string(), "");
    }

    #[test]
    fn ticks_are_short() {
        for (value, text) in
            [(1.0, "1"), (0.02, "0.02"), (200.0, "200"), (1e-3, "10⁻³"), (5e-5, "5·10⁻⁵"), (1e4, "10⁴")]
        {
            assert_eq!(tick(value), text);
        }
    }
}
