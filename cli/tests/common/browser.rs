//! Chromium without a window, driven over pipes by the Chrome DevTools Protocol.
#![allow(dead_code)] // Each suite uses a part of it.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Longest wait for what a page shows.
const PATIENCE: Duration = Duration::from_secs(60);

/// The name of an installed browser.
pub fn installed() -> Option<&'static str> {
    ["chromium", "chromium-browser"].into_iter().find(|name| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|run| run.status.success())
    })
}

pub struct Browser {
    child: Child,
    to: File,
    from: BufReader<File>,
    calls: u64,
}

#[derive(Clone)]
pub struct Tab {
    target: String,
    session: String,
}

impl Browser {
    /// Starts a browser; `folder` holds its profile and its pipes.
    pub fn start(name: &str, folder: &Path) -> Self {
        std::fs::create_dir_all(folder).unwrap();
        let (to, from) = (folder.join("to"), folder.join("from"));
        let made = Command::new("mkfifo").arg(&to).arg(&from).status();
        assert!(made.unwrap().success());
        let flags = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-background-networking",
            "--disable-background-timer-throttling",
            "--disable-renderer-backgrounding",
            "--mute-audio",
            "--remote-debugging-pipe",
        ];
        // The browser reads from descriptor 3 and writes to 4.
        let script = "exec \"$0\" \"$@\" 3<\"$HTEX_TO\" 4>\"$HTEX_FROM\"";
        let child = Command::new("sh")
            .args(["-c", script, name])
            .args(flags)
            .arg(format!("--user-data-dir={}", folder.join("profile").display()))
            .env("HTEX_TO", &to)
            .env("HTEX_FROM", &from)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let to = File::options().write(true).open(to).unwrap();
        let from = BufReader::new(File::open(from).unwrap());
        let calls = 0;
        Self { child, to, from, calls }
    }

    /// Calls a method, in a tab or in the browser.
    pub fn call(&mut self, tab: Option<&Tab>, method: &str, params: Value) -> Value {
        self.calls += 1;
        let mut message = json!({ "id": self.calls, "method": method, "params": params });
        if let Some(tab) = tab {
            message["sessionId"] = json!(tab.session);
        }
        self.to.write_all(message.to_string().as_bytes()).unwrap();
        self.to.write_all(&[0]).unwrap();
        loop {
            let mut reply = Vec::new();
            self.from.read_until(0, &mut reply).unwrap();
            assert_eq!(reply.pop(), Some(0), "{method}: the browser has ended");
            let reply: Value = serde_json::from_slice(&reply).unwrap();
            if reply["id"] == self.calls {
                assert_eq!(reply.get("error"), None, "{method}");
                return reply["result"].clone();
            }
        }
    }

    /// Opens a tab of the size of a tablet.
    pub fn open(&mut self, url: &str) -> Tab {
        let made = self.call(None, "Target.createTarget", json!({ "url": url }));
        let target = made["targetId"].as_str().unwrap().to_owned();
        let attach = json!({ "targetId": target, "flatten": true });
        let attached = self.call(None, "Target.attachToTarget", attach);
        let session = attached["sessionId"].as_str().unwrap().to_owned();
        let tab = Tab { target, session };
        self.resize(&tab, 1024, 768);
        let focus = json!({ "enabled": true });
        self.call(Some(&tab), "Emulation.setFocusEmulationEnabled", focus);
        tab
    }

    /// Gives a tab another size, pixels.
    pub fn resize(&mut self, tab: &Tab, width: u32, height: u32) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call(Some(tab), "Emulation.setDeviceMetricsOverride", size);
    }

    pub fn close(&mut self, tab: &Tab) {
        let target = json!({ "targetId": tab.target });
        self.call(None, "Target.closeTarget", target);
    }

    pub fn reload(&mut self, tab: &Tab) {
        self.call(Some(tab), "Page.reload", json!({}));
    }

    pub fn value(&mut self, tab: &Tab, expression: &str) -> Value {
        let params = json!({ "expression": expression, "returnByValue": true });
        self.call(Some(tab), "Runtime.evaluate", params)["result"]["value"].clone()
    }

    /// The value that a promise of a tab is resolved to.
    pub fn promised(&mut self, tab: &Tab, expression: &str) -> Value {
        let params =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        self.call(Some(tab), "Runtime.evaluate", params)["result"]["value"].clone()
    }

    /// Presses the middle of the first element of a selector.
    pub fn click(&mut self, tab: &Tab, selector: &str) {
        let place = format!(
            "(() => {{ const r = document.querySelector('{selector}').getBoundingClientRect(); return [(r.left + r.right) / 2, (r.top + r.bottom) / 2]; }})()"
        );
        let place = self.value(tab, &place);
        for kind in ["mousePressed", "mouseReleased"] {
            let at = json!({ "type": kind, "x": place[0], "y": place[1], "button": "left", "buttons": 1, "clickCount": 1 });
            self.call(Some(tab), "Input.dispatchMouseEvent", at);
        }
    }

    /// Waits until a tab shows a text.
    pub fn shows(&mut self, tab: &Tab, text: &str) {
        let start = Instant::now();
        let mut body = Value::Null;
        while start.elapsed() < PATIENCE {
            body = self.value(tab, "document.body && document.body.innerText");
            if body.as_str().is_some_and(|body| body.contains(text)) {
                return;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        unreachable!("{text:?} is not shown: {body}");
    }

    /// Presses and releases a key; `repeats` are presses of a key that is held.
    pub fn press(&mut self, tab: &Tab, key: &str, repeats: usize) {
        let text = match key {
            "Enter" => "\r",
            named if named.len() > 1 => "",
            key => key,
        };
        for i in 0..=repeats {
            let down = json!({ "type": "keyDown", "key": key, "text": text, "autoRepeat": i > 0 });
            self.call(Some(tab), "Input.dispatchKeyEvent", down);
        }
        let up = json!({ "type": "keyUp", "key": key });
        self.call(Some(tab), "Input.dispatchKeyEvent", up);
    }

    /// Slides to and fro over the middle of a tab for half a second.
    pub fn slide(&mut self, tab: &Tab) {
        let mut mouse = |kind: &str, x: f64| {
            let at = json!({ "type": kind, "x": x, "y": 300, "button": "left", "buttons": 1, "clickCount": 1 });
            self.call(Some(tab), "Input.dispatchMouseEvent", at);
        };
        mouse("mousePressed", 300.0);
        for i in 0..50 {
            mouse("mouseMoved", 300.0 + 8.0 * f64::from(if i < 25 { i } else { 50 - i }));
            std::thread::sleep(Duration::from_millis(10));
        }
        mouse("mouseReleased", 300.0);
    }

    /// A picture of a tab as PNG, base64.
    pub fn picture(&mut self, tab: &Tab) -> String {
        let taken = self.call(Some(tab), "Page.captureScreenshot", json!({}));
        taken["data"].as_str().unwrap().to_owned()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The address of the page that a command serves, which it prints.
pub fn address(child: &mut Child) -> String {
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("http://") {
        line.clear();
        assert!(errors.read_line(&mut line).unwrap() > 0, "no address");
    }
    // What else it says must not fill the pipe.
    std::thread::spawn(move || std::io::copy(&mut errors, &mut std::io::sink()));
    let url = line.split(' ').find(|word| word.starts_with("http://"));
    url.unwrap().trim().to_owned()
}

/// The same address by the number of this machine, for programs: the system need not know names
/// under `localhost`, as browsers do.
pub fn by_number(url: &str) -> String {
    let rest = url.strip_prefix("http://").unwrap();
    let (name, rest) = rest.split_once(".localhost:").unwrap();
    assert_eq!(name.len(), 32, "{url}");
    format!("http://127.0.0.1:{rest}")
}

/// Nothing is scrolled or cut on a tablet, upright or on its side, of which it keeps pictures; the
/// tab is left on its side.
pub fn fits_tablets(browser: &mut Browser, tab: &Tab, name: &str) {
    let all = "[innerWidth >= document.documentElement.scrollWidth, innerHeight >= document.documentElement.scrollHeight, \
        [...document.querySelectorAll('body *:not(svg *)')].every((e) => { const r = e.getBoundingClientRect(); \
        return r.right <= innerWidth + 1 && r.bottom <= innerHeight + 1 && r.top >= 0 && r.left >= 0; }), \
        [...document.querySelectorAll('button')].every((b) => b.scrollWidth <= b.clientWidth && b.scrollHeight <= b.clientHeight)]";
    for (width, height) in [(768, 1024), (1024, 768)] {
        browser.resize(tab, width, height);
        assert_eq!(
            browser.value(tab, all),
            json!([true, true, true, true]),
            "{name}, {width} x {height}"
        );
        pictured(browser, tab, &format!("{name}-{width}"));
    }
}

/// Keeps a picture where `HTEX_PICTURES` names a folder, to look at.
pub fn pictured(browser: &mut Browser, tab: &Tab, name: &str) {
    if let Some(folder) = std::env::var_os("HTEX_PICTURES") {
        let picture = browser.picture(tab);
        let file = Path::new(&folder).join(format!("{name}.png.base64"));
        std::fs::write(file, picture).unwrap();
    }
}

/// The status of a request to a port of this machine.
pub fn status(port: &str, request: &str) -> String {
    let mut stream = TcpStream::connect(format!("127.0.0.1:{port}")).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut reply = String::new();
    let mut reader = BufReader::new(&mut stream);
    reader.read_line(&mut reply).unwrap();
    reply.split(' ').nth(1).unwrap().to_owned()
}
