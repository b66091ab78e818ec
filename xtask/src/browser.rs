//! A headless Chromium, spoken to by its DevTools protocol over two pipes: JSON, each message with a zero byte behind it.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use tiny_skia::Pixmap;

/// Names that a Chromium goes by.
const NAMES: [&str; 5] = ["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "chrome"];
/// Nothing that is asked of it takes longer.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub(crate) struct Browser {
    child: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    session: Option<String>,
    next: u64,
    /// What it told unasked: errors, and what was asked of a network.
    pub(crate) complaints: Vec<String>,
}

impl Browser {
    /// Starts one, with a page of this size; `options` beside those that a machine without a screen or a graphics card needs.
    pub(crate) fn start(profile: &Path, width: u32, height: u32, options: &[&str]) -> Result<Self, String> {
        let name = NAMES.iter().find(|name| Command::new(name).arg("--version").output().is_ok());
        let name = name.ok_or("there is no Chromium; in Debian: apt-get install chromium-headless-shell")?;
        // Its ends of the pipes are those of numbers 3 and 4, which only a shell gives without unsafe code.
        let mut command = Command::new("sh");
        command.args(["-c", "exec \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1", "sh", name]);
        // Without a sandbox of its own, which root has not.
        command.args([
            "--headless",
            "--remote-debugging-pipe",
            "--no-sandbox",
            "--no-first-run",
            "--disable-dev-shm-usage",
        ]);
        command.arg(format!("--user-data-dir={}", profile.display())).args(options).arg("about:blank");
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(|e| format!("sh: {e}"))?;
        let input = child.stdin.take().ok_or("the browser has no input")?;
        let output = child.stdout.take().ok_or("the browser has no output")?;
        let (send, messages) = mpsc::channel();
        thread::spawn(move || {
            let mut reader = BufReader::new(output);
            let mut bytes = Vec::new();
            while reader.read_until(0, &mut bytes).is_ok_and(|length| length > 0) {
                bytes.pop();
                if serde_json::from_slice(&bytes).is_ok_and(|message: Value| send.send(message).is_err()) {
                    return;
                }
                bytes.clear();
            }
        });
        let complaints = Vec::new();
        let mut browser = Self { child, input, messages, session: None, next: 1, complaints };
        let target = browser.ask("Target.createTarget", &json!({ "url": "about:blank" }))?["targetId"].clone();
        let attached = browser.ask("Target.attachToTarget", &json!({ "targetId": target, "flatten": true }))?;
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.ask(&format!("{domain}.enable"), &json!({}))?;
        }
        let screen = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 700 });
        browser.ask("Emulation.setDeviceMetricsOverride", &screen)?;
        Ok(browser)
    }

    /// Asks for something, and waits for the answer.
    fn ask(&mut self, method: &str, parameters: &Value) -> Result<Value, String> {
        let id = self.next;
        self.next += 1;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = session.as_str().into();
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.input.write_all(&bytes).map_err(|e| format!("the browser hears nothing: {e}"))?;
        let until = Instant::now() + PATIENCE;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let message =
                self.messages.recv_timeout(left).map_err(|_| format!("{method}: the browser has not answered"))?;
            if message["id"] != id {
                self.hear(&message);
            } else if message["error"].is_object() {
                return Err(format!("{method}: {}", message["error"]["message"]));
            } else {
                return Ok(message["result"].clone());
            }
        }
    }

    fn hear(&mut self, message: &Value) {
        let (method, told) = (message["method"].as_str().unwrap_or_default(), &message["params"]);
        let complaint = match method {
            "Runtime.exceptionThrown" => Some(told["exceptionDetails"].to_string()),
            "Runtime.consoleAPICalled" => Some(format!("console.{}: {}", told["type"], told["args"])),
            // That reading a pixel waits for the picture is what it is for.
            "Log.entryAdded" if !told["entry"]["text"].to_string().contains("Performance") => {
                Some(told["entry"].to_string())
            }
            "Network.requestWillBeSent" => {
                let address = told["request"]["url"].as_str().unwrap_or_default();
                let is_own = ["file:", "data:", "blob:", "about:"].iter().any(|scheme| address.starts_with(scheme));
                (!is_own).then(|| format!("asks for {address}"))
            }
            _ => None,
        };
        self.complaints.extend(complaint);
    }

    /// Opens a file; the page may still be at work.
    pub(crate) fn open(&mut self, path: &Path) -> Result<(), String> {
        self.ask("Page.navigate", &json!({ "url": format!("file://{}", path.display()) })).map(drop)
    }

    /// What an expression of JavaScript is; a promise is waited for.
    pub(crate) fn value(&mut self, expression: &str) -> Result<Value, String> {
        let asked = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.ask("Runtime.evaluate", &asked)?;
        match &answer["exceptionDetails"] {
            Value::Null => Ok(answer["result"]["value"].clone()),
            details => Err(format!("{expression}: {details}")),
        }
    }

    /// Waits until an expression is true.
    pub(crate) fn until(&mut self, expression: &str) -> Result<(), String> {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            // While a page is on its way to another there is nothing to ask.
            if self.value(&format!("Boolean({expression})")).is_ok_and(|value| value == true) {
                return Ok(());
            }
            thread::sleep(Duration::from_millis(20));
        }
        Err(format!("never came: {expression}; complaints: {:?}", self.complaints))
    }

    /// A click at a point of the page.
    pub(crate) fn click(&mut self, x: f64, y: f64) -> Result<(), String> {
        self.mouse("mousePressed", x, y, 1)?;
        self.mouse("mouseReleased", x, y, 1)
    }

    /// A drag from a point to another.
    pub(crate) fn drag(&mut self, from: [f64; 2], to: [f64; 2]) -> Result<(), String> {
        self.mouse("mousePressed", from[0], from[1], 1)?;
        self.mouse("mouseMoved", to[0], to[1], 1)?;
        self.mouse("mouseReleased", to[0], to[1], 1)
    }

    fn mouse(&mut self, kind: &str, x: f64, y: f64, clicks: u32) -> Result<(), String> {
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": clicks });
        self.ask("Input.dispatchMouseEvent", &event).map(drop)
    }

    /// A key, pressed and let go.
    pub(crate) fn key(&mut self, key: &str) -> Result<(), String> {
        for kind in ["keyDown", "keyUp"] {
            self.ask("Input.dispatchKeyEvent", &json!({ "type": kind, "key": key }))?;
        }
        Ok(())
    }

    /// What is seen.
    pub(crate) fn picture(&mut self) -> Result<Pixmap, String> {
        let answer = self.ask("Page.captureScreenshot", &json!({ "format": "png" }))?;
        let text = answer["data"].as_str().unwrap_or_default();
        let bytes = STANDARD.decode(text).map_err(|e| format!("the picture: {e}"))?;
        Pixmap::decode_png(&bytes).map_err(|e| format!("the picture: {e}"))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.ask("Browser.close", &json!({}));
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
