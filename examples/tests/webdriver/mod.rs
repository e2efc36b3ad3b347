//! As much of WebDriver as the tests need: <https://www.w3.org/TR/webdriver2/>.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use ureq::Agent;

/// How WebDriver calls the reference of an element.
const ELEMENT: &str = "element-6066-11e4-a52e-4f735466cecf";

/// The tool that is not installed, if there is one.
pub(crate) fn missing_tools() -> Option<&'static str> {
    ["chromium", "chromedriver"].into_iter().find(|tool| {
        let found = Command::new(tool).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        !found.is_ok_and(|status| status.success())
    })
}

/// A browser of its own, which ends with this.
pub(crate) struct Browser {
    driver: Child,
    agent: Agent,
    session: String,
}

/// An element of the page.
pub(crate) struct Element(String);

impl Browser {
    /// Starts the driver on a free port, and a browser without a window whose files are in `folder`.
    pub(crate) fn start(folder: &Path) -> Self {
        let mut driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // "ChromeDriver was started successfully on port 12345."
        let mut output = BufReader::new(driver.stdout.take().unwrap());
        let mut line = String::new();
        let port: u16 = loop {
            line.clear();
            assert_ne!(output.read_line(&mut line).unwrap(), 0, "chromedriver ended");
            if let Some((_, rest)) = line.split_once("successfully on port ") {
                break rest.trim().trim_end_matches('.').parse().unwrap();
            }
        };
        // The driver must not fill a pipe that nobody reads.
        std::thread::spawn(move || std::io::copy(&mut output, &mut std::io::sink()));
        let config = Agent::config_builder()
            .timeout_global(Some(Duration::from_secs(120)))
            .http_status_as_error(false)
            .proxy(None)
            .build();
        let agent = Agent::new_with_config(config);
        let mut browser = Self { driver, agent, session: format!("http://127.0.0.1:{port}") };
        let profile = folder.join("profile");
        let arguments = [
            "--headless=new",
            // Chromium's sandbox refuses to run as root, which is who runs in containers.
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--disable-gpu",
            "--no-first-run",
            "--disable-background-networking",
            "--window-size=1280,900",
            // Nothing can leave the machine, whatever a page asks for.
            "--host-resolver-rules=MAP * ~NOTFOUND",
            &format!("--user-data-dir={}", profile.display()),
        ];
        let capabilities = json!({ "capabilities": { "alwaysMatch": {
            "browserName": "chrome",
            "goog:chromeOptions": { "args": arguments },
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
        }}});
        let started = browser.call("POST", "/session", &capabilities);
        let id = started["sessionId"].as_str().unwrap_or_else(|| panic!("no session: {started}"));
        browser.session = format!("{}/session/{id}", browser.session);
        browser
    }

    fn call(&self, method: &str, path: &str, body: &Value) -> Value {
        let address = format!("{}{path}", self.session);
        let response = match method {
            "GET" => self.agent.get(&address).call(),
            "DELETE" => self.agent.delete(&address).call(),
            _ => self.agent.post(&address).content_type("application/json").send(&body.to_string()),
        };
        let text = response.unwrap().body_mut().read_to_string().unwrap();
        let mut answer: Value = serde_json::from_str(&text).unwrap();
        assert!(answer["value"]["error"].is_null(), "{method} {path}: {}", answer["value"]);
        answer["value"].take()
    }

    /// Opens a file.
    pub(crate) fn open(&self, file: &Path) {
        self.call("POST", "/url", &json!({ "url": format!("file://{}", file.display()) }));
    }

    /// The page's title.
    pub(crate) fn title(&self) -> String {
        self.call("GET", "/title", &Value::Null).as_str().unwrap().to_owned()
    }

    /// The first element of this selector.
    pub(crate) fn find(&self, selector: &str) -> Element {
        let found = self.call("POST", "/element", &json!({ "using": "css selector", "value": selector }));
        Element(found[ELEMENT].as_str().unwrap().to_owned())
    }

    /// Clicks into the middle of an element.
    pub(crate) fn click(&self, element: &Element) {
        self.call("POST", &format!("/element/{}/click", element.0), &json!({}));
    }

    /// Gives an element the focus, and types.
    pub(crate) fn send_keys(&self, element: &Element, keys: &str) {
        self.call("POST", &format!("/element/{}/value", element.0), &json!({ "text": keys }));
    }

    /// Presses the button over an element and moves it, by offsets from the element's middle.
    pub(crate) fn drag(&self, element: &Element, from: [i32; 2], to: [i32; 2]) {
        let origin = json!({ ELEMENT: element.0 });
        let go = |[x, y]: [i32; 2]| json!({ "type": "pointerMove", "duration": 20, "origin": origin, "x": x, "y": y });
        let button = |kind: &str| json!({ "type": kind, "button": 0 });
        let actions = json!([go(from), button("pointerDown"), go(to), button("pointerUp")]);
        let pointer =
            json!({ "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": actions });
        self.call("POST", "/actions", &json!({ "actions": [pointer] }));
    }

    /// What a script returns.
    pub(crate) fn execute(&self, script: &str) -> Value {
        self.call("POST", "/execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// What a script hands to its last argument.
    pub(crate) fn execute_async(&self, script: &str) -> Value {
        self.call("POST", "/execute/async", &json!({ "script": script, "args": [] }))
    }

    /// Makes the window as large as this.
    pub(crate) fn resize(&self, width: u32, height: u32) {
        self.call("POST", "/window/rect", &json!({ "width": width, "height": height }));
    }

    fn log(&self, kind: &str) -> Vec<Value> {
        let entries = self.call("POST", "/se/log", &json!({ "type": kind }));
        entries.as_array().unwrap().clone()
    }

    /// Warnings and errors of the console since the last call.
    pub(crate) fn complaints(&self) -> Vec<String> {
        // The browser also tells the test that reading pixels back is slow.
        let loud = |entry: &Value| {
            matches!(entry["level"].as_str(), Some("SEVERE" | "WARNING")) && entry["source"] != "rendering"
        };
        self.log("browser").iter().filter(|entry| loud(entry)).map(|entry| entry["message"].to_string()).collect()
    }

    /// Addresses beyond files, data and the browser's own pages that were asked for since the last call.
    pub(crate) fn requests_to_the_network(&self) -> Vec<String> {
        let address = |entry: &Value| {
            let event: Value = serde_json::from_str(entry["message"].as_str()?).ok()?;
            let message = &event["message"];
            (message["method"] == "Network.requestWillBeSent")
                .then(|| message["params"]["request"]["url"].as_str().map(str::to_owned))?
        };
        let local =
            |address: &String| ["file:", "data:", "about:", "chrome:"].iter().any(|scheme| address.starts_with(scheme));
        self.log("performance").iter().filter_map(address).filter(|address| !local(address)).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Also after a failed check, where the driver may be gone: the browser ends with its session.
        let _ = self.agent.delete(&self.session).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
