//! One look at a page: load it at a width, collect what the browser and the page itself have to complain about.

use std::fmt;
use std::path::Path;

use anyhow::{Context, Result};
use data_encoding::BASE64;
use serde_json::{Value, json};

use super::chromium::Chromium;

/// How the page is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// Of the window, in pixels.
    pub(super) width: u32,
    pub(super) scheme: Scheme,
}

/// What the reader's system prefers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scheme {
    Light,
    Dark,
}

const HEIGHT: u32 = 900;
const CHECKS: &str = include_str!("checks.js");

/// Loads the page; returns its faults in words.
pub(super) fn visit(browser: &mut Chromium, page: &Path, look: &Look) -> Result<Vec<String>> {
    let metrics = json!({ "width": look.width, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": false });
    browser.ask("Emulation.setDeviceMetricsOverride", &metrics)?;
    let scheme = json!({ "features": [{ "name": "prefers-color-scheme", "value": look.scheme.name() }] });
    browser.ask("Emulation.setEmulatedMedia", &scheme)?;
    browser.drain();
    let url = format!("file://{}", page.display());
    let answer = browser.ask("Page.navigate", &json!({ "url": url }))?;
    if let Some(error) = answer["errorText"].as_str() {
        return Ok(vec![format!("the page can't be loaded: {error}")]);
    }
    let mut events = browser.wait_for("Page.loadEventFired")?;
    let found = browser.ask("Runtime.evaluate", &json!({ "expression": CHECKS, "returnByValue": true }))?;
    events.extend(browser.drain());
    let mut faults: Vec<String> = events.iter().filter_map(|e| complaint(e, &url)).collect();
    let found = found["result"]["value"].as_array().with_context(|| format!("the checks failed: {found}"))?;
    faults.extend(found.iter().filter_map(|f| f.as_str().map(str::to_owned)));
    Ok(faults)
}

/// The whole page as PNG, as it was last looked at.
pub(super) fn screenshot(browser: &mut Chromium) -> Result<Vec<u8>> {
    let answer = browser.ask("Page.captureScreenshot", &json!({ "format": "png", "captureBeyondViewport": true }))?;
    bytes(&answer)
}

/// The page as PDF, as it is printed.
pub(super) fn print(browser: &mut Chromium) -> Result<Vec<u8>> {
    browser.ask("Emulation.setEmulatedMedia", &json!({ "media": "", "features": [] }))?;
    let answer = browser.ask("Page.printToPDF", &json!({ "preferCSSPageSize": true, "printBackground": false }))?;
    bytes(&answer)
}

fn bytes(answer: &Value) -> Result<Vec<u8>> {
    let text = answer["data"].as_str().context("no data")?;
    BASE64.decode(text.as_bytes()).context("data that are not base64")
}

/// What an event complains about: errors, and requests to anywhere but the page itself.
fn complaint(event: &Value, page: &str) -> Option<String> {
    let params = &event["params"];
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    match event["method"].as_str()? {
        "Runtime.exceptionThrown" => {
            Some(format!("exception: {}", text(&params["exceptionDetails"]["exception"]["description"])))
        }
        "Runtime.consoleAPICalled" if ["error", "warning", "assert"].contains(&params["type"].as_str()?) => {
            Some(format!("console: {}", params["args"]))
        }
        "Log.entryAdded" if params["entry"]["level"] != json!("verbose") => {
            Some(format!("log: {}", text(&params["entry"]["text"])))
        }
        "Network.loadingFailed" => Some(format!("a request failed: {}", text(&params["errorText"]))),
        "Network.requestWillBeSent" => {
            let url = text(&params["request"]["url"]);
            (url != page && !url.starts_with("data:"))
                .then(|| format!("the page is not self-contained: it asks for {url}"))
        }
        _ => None,
    }
}

impl Scheme {
    fn name(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }
}

impl fmt::Display for Look {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.width, self.scheme.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAULTY: &str = r##"<!doctype html><title>x</title><h1>a</h1><h3>b</h3><a href="#nowhere">c</a>
        <div style="width:2000px">wide</div><img src="missing.png">
        <svg class="plot" viewBox="0 0 100 50" width="100" height="50">
        <text x="0" y="20">hello</text><text x="5" y="22">there</text><text x="90" y="40">too far out</text></svg>
        <script>console.error("bad"); throw new Error("boom")</script>"##;

    #[test]
    fn a_faulty_page_is_complained_about_and_a_good_one_is_not() {
        let mut browser = match Chromium::start(None) {
            Ok(browser) => browser,
            Err(error) => return eprintln!("skipped: {error:#}"),
        };
        let folder = tempfile::tempdir().unwrap();
        let mut faults = |text: &str| {
            let page = folder.path().join("page.html");
            std::fs::write(&page, text).unwrap();
            visit(&mut browser, &page, &Look { width: 360, scheme: Scheme::Light }).unwrap().join("\n")
        };
        let said = faults(FAULTY);
        let expected = [
            "not self-contained: it asks for",
            "missing.png",
            "console: ",
            "exception: Error: boom",
            "pixels wide in a window of 360",
            "too wide: div",
            "cut off: text",
            "words on words: text",
            "a picture is broken",
            "doesn't say what it shows",
            "a heading of level 3 below one of level 1",
            "a link leads nowhere: #nowhere",
        ];
        for words in expected {
            assert!(said.contains(words), "no '{words}' in:\n{said}");
        }
        assert_eq!(faults("<!doctype html><title>x</title><link rel=icon href='data:,'><h1>a</h1><p>b</p>"), "");
    }
}
