//! The page of `lichtwerk compare` in a browser: Chromium without a window, driven by real input through WebDriver.
//!
//! Where there is no `chromium` or no `chromedriver`, the test says so and passes, unless the environment variable `CI` is `true`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod webdriver;

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use serde_json::{Value, json};
use webdriver::{Browser, missing_tools};

/// A page of a few pixels with three estimators.
fn make_page(folder: &Path) {
    let arguments = [
        "compare",
        "cornell-box",
        "--estimators",
        "path,light,bdpt:heuristic=balance",
        "--size",
        "32x32",
        "--spp",
        "4",
    ];
    let output = Command::new(env!("CARGO_BIN_EXE_lichtwerk"))
        .args(arguments)
        .args(["--trials", "2", "--max-depth", "4", "--reference-spp", "64", "--out", "out"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Waits for a picture to be drawn, and returns the sum of all bytes of the left and of the right half of the screen.
const HALVES: &str = r#"
    const done = arguments[arguments.length - 1];
    requestAnimationFrame(() => requestAnimationFrame(() => {
        const screen = document.querySelector(".screen");
        const half = (start) => {
            const width = Math.floor(screen.width / 2);
            const data = screen.getContext("2d").getImageData(start, 0, width, screen.height).data;
            return data.reduce((sum, byte, i) => sum + byte * (1 + i % 97), 0);
        };
        done([half(0), half(Math.ceil(screen.width / 2))]);
    }));
"#;

fn halves(browser: &Browser) -> [u64; 2] {
    let sums = browser.execute_async(HALVES);
    [0, 1].map(|index| sums[index].as_u64().unwrap())
}

fn property(browser: &Browser, selector: &str, name: &str) -> Value {
    browser.execute(&format!("return document.querySelector({}).{name}", json!(selector)))
}

fn value(browser: &Browser, selector: &str) -> f64 {
    property(browser, selector, "value").as_str().unwrap().parse().unwrap()
}

/// Keys as WebDriver writes those without a character.
const LEFT: &str = "\u{E012}";
const RIGHT: &str = "\u{E014}";
const HOME: &str = "\u{E011}";
const END: &str = "\u{E010}";
const SHIFT: &str = "\u{E008}";
const ENTER: &str = "\u{E007}";

#[test]
fn the_page_works_in_a_browser() {
    if let Some(missing) = missing_tools() {
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "{missing} is not installed");
        println!("skipped: {missing} is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    make_page(folder.path());
    let browser = Browser::start(folder.path());
    browser.open(&folder.path().join("out/report.html"));
    assert_eq!(browser.title(), "cornell-box: path, light and bdpt:heuristic=balance");
    assert!(property(&browser, ".gallery", "children.length").as_u64().unwrap() >= 10);

    the_wipe_divides_two_images(&browser);
    exposure_and_curve_change_the_pixels(&browser);
    keys_choose_images_and_zoom(&browser);
    the_pointer_reads_pixels_and_drags(&browser);
    the_theme_changes_the_colours(&browser);
    a_narrow_window_is_not_scrolled_sideways(&browser);

    // Nothing was fetched, and nothing went wrong.
    let fetched = browser.execute("return performance.getEntriesByType('resource').map(entry => entry.name)");
    let beyond: Vec<&Value> =
        fetched.as_array().unwrap().iter().filter(|name| !name.as_str().unwrap().starts_with("data:")).collect();
    assert!(beyond.is_empty(), "{beyond:?}");
    assert_eq!(browser.requests_to_the_network(), Vec::<String>::new());
    assert_eq!(browser.complaints(), Vec::<String>::new());
    // Silence means something: a planted error and a planted request are found.
    browser.execute("setTimeout(() => { throw new Error('planted'); })");
    browser.execute_async("setTimeout(arguments[arguments.length - 1], 200)");
    let complaints = browser.complaints();
    assert!(complaints.iter().any(|message| message.contains("planted")), "{complaints:?}");
    browser.execute("setTimeout(() => location.assign('http://127.0.0.1:9/planted'))");
    let asked = |_| {
        std::thread::sleep(Duration::from_millis(100));
        browser.requests_to_the_network().iter().any(|address| address.ends_with("/planted"))
    };
    assert!((0..100).any(asked), "the planted request was not seen");
}

fn the_wipe_divides_two_images(browser: &Browser) {
    let wipe = browser.find("input.wipe");
    let middle = halves(browser);
    browser.send_keys(&wipe, HOME);
    assert_eq!(value(browser, "input.wipe"), 0.0);
    let right_only = halves(browser);
    assert_ne!(middle[0], right_only[0], "the left half is the right image now");
    browser.send_keys(&wipe, END);
    let left_only = halves(browser);
    assert_eq!(value(browser, "input.wipe"), 100.0);
    assert_ne!(left_only[1], right_only[1], "the right half is the left image now");
    // By a click in the middle of the slider.
    browser.click(&wipe);
    assert!((value(browser, "input.wipe") - 50.0).abs() <= 2.0);
    // The arrows of the image itself.
    let screen = browser.find(".screen");
    let before = value(browser, "input.wipe");
    let pixels = halves(browser);
    browser.send_keys(&screen, &RIGHT.repeat(5));
    assert_eq!(value(browser, "input.wipe"), before + 10.0);
    assert_ne!(halves(browser), pixels);
    browser.send_keys(&screen, &LEFT.repeat(5));
    assert_eq!((value(browser, "input.wipe"), halves(browser)), (before, pixels));
}

fn exposure_and_curve_change_the_pixels(browser: &Browser) {
    let before = halves(browser);
    browser.send_keys(&browser.find("input.exposure"), &RIGHT.repeat(8));
    assert_eq!(value(browser, "input.exposure"), 2.0);
    let brighter = halves(browser);
    assert!(brighter[0] > before[0] && brighter[1] > before[1], "{before:?} {brighter:?}");
    browser.send_keys(&browser.find(".screen"), "----");
    assert_eq!(value(browser, "input.exposure"), 0.0);
    assert_eq!(halves(browser), before);
    browser.send_keys(&browser.find(".screen"), "+");
    assert_eq!(value(browser, "input.exposure"), 0.5);
    browser.click(&browser.find("button.reset"));
    assert_eq!(halves(browser), before);
    browser.send_keys(&browser.find("select.curve"), "linear");
    assert_eq!(property(browser, "select.curve", "value"), "linear");
    let linear = halves(browser);
    assert!(linear[0] < before[0] && linear[1] < before[1], "{before:?} {linear:?}");
    browser.send_keys(&browser.find("select.curve"), HOME);
    assert_eq!(halves(browser), before);
}

fn keys_choose_images_and_zoom(browser: &Browser) {
    let screen = browser.find(".screen");
    let before = halves(browser);
    browser.send_keys(&screen, "1");
    assert_eq!(value(browser, "select.left"), 0.0);
    let reference = halves(browser);
    assert_ne!(reference[0], before[0]);
    browser.send_keys(&screen, &format!("{SHIFT}5"));
    assert_eq!(value(browser, "select.right"), 4.0, "a map of errors");
    assert_ne!(halves(browser)[1], reference[1]);
    browser.send_keys(&screen, "x");
    assert_eq!((value(browser, "select.left"), value(browser, "select.right")), (4.0, 0.0));
    let fitted = halves(browser);
    browser.send_keys(&screen, "]]");
    assert_ne!(halves(browser), fitted);
    browser.send_keys(&screen, "0");
    assert_eq!(halves(browser), fitted);
    browser.click(&browser.find("button.zoom-in"));
    assert_ne!(halves(browser), fitted);
    browser.click(&browser.find("button.fit"));
    assert_eq!(halves(browser), fitted);
    // A small picture is a button: by keyboard for the left side.
    browser.send_keys(&browser.find(".thumb:nth-child(2)"), ENTER);
    assert_eq!(value(browser, "select.left"), 1.0);
    assert_eq!(property(browser, ".thumb:nth-child(2)", "ariaPressed"), "true");
    // What has the focus is outlined.
    browser.send_keys(&browser.find(".thumb:nth-child(2)"), "\u{E004}");
    let outline = browser.execute("return getComputedStyle(document.activeElement).outlineStyle");
    assert_eq!(outline, "solid");
}

fn the_pointer_reads_pixels_and_drags(browser: &Browser) {
    let screen = browser.find(".screen");
    browser.drag(&screen, [0, 0], [40, 3]);
    let text = property(browser, ".left-value", "textContent");
    assert!(
        text.as_str().unwrap().starts_with("left ") && text.as_str().unwrap().split_whitespace().count() == 4,
        "{text}"
    );
    let width = property(browser, ".screen", "clientWidth").as_f64().unwrap();
    let expected = 50.0 + 100.0 * 40.0 / width;
    assert!((value(browser, "input.wipe") - expected).abs() <= 2.0);
    // Enlarged, what is away from the line is moved.
    browser.send_keys(&screen, "]]");
    let before = (value(browser, "input.wipe"), halves(browser));
    browser.drag(&screen, [-200, 0], [-150, 30]);
    assert_eq!(value(browser, "input.wipe"), before.0);
    assert_ne!(halves(browser), before.1);
    browser.send_keys(&screen, "0");
}

fn the_theme_changes_the_colours(browser: &Browser) {
    let paper = || browser.execute("return getComputedStyle(document.body).backgroundColor");
    let button = browser.find("button.theme");
    browser.click(&button);
    let light = paper();
    browser.click(&button);
    assert_ne!(paper(), light);
    // Text in plots is as dark or bright as that of the page.
    let same = "return getComputedStyle(document.querySelector('.plot svg text')).fill === getComputedStyle(document.body).color";
    assert_eq!(browser.execute(same), true);
    browser.click(&button);
}

fn a_narrow_window_is_not_scrolled_sideways(browser: &Browser) {
    for width in [1280, 700] {
        browser.resize(width, 900);
        let sideways =
            browser.execute("return document.documentElement.scrollWidth - document.documentElement.clientWidth");
        assert_eq!(sideways, 0, "at {width} pixels");
    }
}
